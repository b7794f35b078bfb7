// A project outside sansmesh that uses only find_package(sansmesh): reconstructs a ball, probes a volume and traces a
// flow.
#include <sansmesh/flow.h>
#include <sansmesh/io.h>
#include <sansmesh/reconstruct.h>
#include <sansmesh/version.h>
#include <sansmesh/volumes.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

int failures = 0;

void expect(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "%s\n", what);
  ++failures;
}

sansmesh::PointSet ball() {
  sansmesh::PointSet points;
  const int n = 3000;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
    points.positions.push_back(sansmesh::Vec3f(sansmesh::Vec3{r * std::cos(angle), r * std::sin(angle), z}));
  }
  return points;
}

}  // namespace

int main() {
  try {
    sansmesh::Progress progress;
    const auto [mesh, report, notes] = sansmesh::reconstruct(ball(), {}, progress);
    expect(!mesh.triangles.empty() && !report.open, "the ball is not closed");
    for (const sansmesh::Vec3f& v : mesh.vertices) expect(std::abs(sansmesh::norm(v) - 1) < 0.01, "a vertex is off");
    sansmesh::write_mesh("ball.ply", mesh);

    std::string samples = "x,y,z,height\n";
    for (int i = 0; i < 125; ++i)
      samples += std::to_string(i % 5) + "," + std::to_string(i / 5 % 5) + "," + std::to_string(i / 25) + "," +
                 std::to_string(i / 25) + "\n";
    sansmesh::write_text("samples.csv", samples);
    sansmesh::VolumeModel volume = sansmesh::open_volume({"samples.csv"}, {.array = "height"}, progress);
    const std::vector<sansmesh::Vec3> places{{2, 2, 1.5}};
    const sansmesh::ProbeResult probed = sansmesh::probe_volume(volume, places, progress);
    expect(std::abs(probed.values.at(0) - 1.5) < 0.05, "the height is another");
    expect(probed.report.reconstruction.options.method && !probed.report.reconstruction.why.empty(),
           "nobody says which method was chosen, and why");

    const sansmesh::FlowModel flow = sansmesh::open_flow({"rotation"}, {}, {}, progress);
    const auto traced = sansmesh::trace_lines_of(flow, {.seeds = "point(0.5,0,0)", .lines = {.duration = 1}}, progress);
    expect(traced.lines.size() == 1, "there is no line");
    for (const sansmesh::Vec3f& p : traced.lines.positions)
      expect(std::abs(std::hypot(p.x + traced.lines.origin.x, p.y + traced.lines.origin.y) - 0.5) < 1e-3,
             "the line leaves its circle");
    std::printf("sansmesh %s: %zu triangles\n", sansmesh::version().data(), mesh.triangles.size());
  } catch (const sansmesh::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return failures == 0 ? 0 : 1;
}
