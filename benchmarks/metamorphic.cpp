// Reconstructs clouds again after changes that must not change the result, and lists what changed.
#include <fmt/core.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/reconstruct.h"
#include "support/perturbed_cloud.h"
#include "timing.h"

namespace {

using namespace sansmesh;

struct Outcome {
  std::size_t parts = 0, boundary = 0, warnings = 0;
  std::optional<long> genus;
  double lost = 0, error = 0, cpu = 0;
  std::string words;  ///< message of a failure, or the warnings
};

struct Subject {
  std::string name;
  PointSet cloud;
  std::optional<TriangleMesh> truth;
};

Outcome outcome_of(const Subject& subject, test::CloudChange change, double spacing, unsigned seed,
                   const TriangleMesh* reference, const std::string& write, TriangleMesh* kept) {
  Outcome outcome;
  const test::PerturbedCloud perturbed(subject.cloud, change, spacing, seed);
  try {
    Progress silent;
    ReconstructResult made;
    outcome.cpu = time_of([&] { made = reconstruct(perturbed.points, {}, silent); }).cpu;
    const MeshTopology topology = measure_topology(made.mesh);
    outcome.parts = topology.components - std::min(topology.components, perturbed.parts());
    outcome.boundary = topology.boundary_edges;
    outcome.genus = topology.genus();
    outcome.lost = made.report.lost;
    outcome.warnings = made.notes.size();
    for (const Note& note : made.notes) outcome.words += "\n      " + note.text;
    perturbed.undo(made.mesh);
    if (const TriangleMesh* other = subject.truth ? &*subject.truth : reference) {
      const SurfaceDistance d = measure_distance(made.mesh, *other, {.samples = 50000}, silent);
      // The way from the truth only: a second object is farther away.
      outcome.error =
          d.percent(perturbed.parts() ? d.from_reference.mean : std::max(d.from_reference.mean, d.to_reference.mean));
    }
    if (!write.empty()) {
      write_mesh(write + ".ply", made.mesh);
      write_points(write + "_samples.ply", perturbed.points);
    }
    if (kept) *kept = std::move(made.mesh);
  } catch (const Error& error) {
    outcome.words = std::string("\n      fails: ") + error.what();
    outcome.parts = 0, outcome.boundary = 1;
  }
  return outcome;
}

bool differs(const Outcome& a, const Outcome& b, bool with_truth) {
  return a.parts != b.parts || a.genus != b.genus || (a.boundary == 0) != (b.boundary == 0) ||
         b.lost > a.lost + 0.001 || (with_truth && b.error > 1.1 * a.error + 1e-4);
}

/// Options of the program; names of files and of changes.
struct Request {
  std::vector<std::string> files, changes;
  std::size_t samples = 20000;  ///< number on the faces of a mesh; 0: the mesh itself
  bool strip = false, talk = false;
  double noise = 0;    ///< share of the diagonal
  std::string folder;  ///< for all clouds and meshes; empty: none are written
  int seeds = 1;
};

Subject read_subject(const std::string& file, const Request& request) {
  Subject subject{std::filesystem::path(file).filename().string(), read_points(file), {}};
  PointSet& cloud = subject.cloud;
  if (!cloud.triangles.empty()) {
    TriangleMesh truth = read_mesh(file);
    if (request.samples > 0) cloud = sample_faces(cloud, request.samples), cloud.triangles.clear();
    if (measure_topology(truth).boundary_edges == 0) subject.truth = std::move(truth);
  }
  // Positions and normals only: every change applies to them.
  PointSet plain;
  plain.origin = cloud.origin, plain.positions = std::move(cloud.positions);
  if (!request.strip) plain.normals = std::move(cloud.normals);
  if (request.samples == 0) plain.triangles = std::move(cloud.triangles);
  cloud = std::move(plain);
  if (request.noise > 0) {
    std::mt19937 random(7);
    std::normal_distribution<float> gauss(0, static_cast<float>(request.noise * bounds(cloud).diagonal()));
    for (Vec3f& p : cloud.positions) p += Vec3f{gauss(random), gauss(random), gauss(random)};
  }
  return subject;
}

int run(const Request& request) {
  std::size_t changed = 0, cases = 0;
  for (const std::string& file : request.files) {
    const Subject subject = read_subject(file, request);
    const double spacing = estimate_spacing(subject.cloud);
    TriangleMesh reference;
    const auto written = [&](std::string_view name, int seed) {
      return request.folder.empty() ? std::string()
                                    : fmt::format("{}/{} {} {}", request.folder, subject.name, name, seed);
    };
    const Outcome plain =
        outcome_of(subject, test::CloudChange::none, spacing, 1, nullptr, written("as it is", 1), &reference);
    fmt::print("{} ({} samples)\n", subject.name, subject.cloud.size());
    const auto line = [&](std::string_view name, const Outcome& o, bool other) {
      fmt::print(
          "  {} {:14} parts {:3}  genus {:>4}  boundary {:5}  lost {:6.2f} %  error {:.4f} %  warnings {}  {:.1f} "
          "s{}\n",
          other ? "!" : " ", name, o.parts, o.genus ? std::to_string(*o.genus) : "-", o.boundary, 100 * o.lost, o.error,
          o.warnings, o.cpu, request.talk || other || name == "as it is" ? o.words : "");
      std::fflush(stdout);
    };
    line("as it is", plain, false);
    for (const test::NamedChange& change : test::kCloudChanges) {
      if (change.change == test::CloudChange::none) continue;
      if (!request.changes.empty() &&
          std::find(request.changes.begin(), request.changes.end(), change.name) == request.changes.end())
        continue;
      for (int seed = 1; seed <= request.seeds; ++seed) {
        const Outcome o = outcome_of(subject, change.change, spacing, static_cast<unsigned>(seed), &reference,
                                     written(change.name, seed), nullptr);
        const bool other = differs(plain, o, subject.truth.has_value());
        line(change.name, o, other);
        changed += other, ++cases;
      }
    }
  }
  fmt::print("{} of {} changes changed the result\n", changed, cases);
  return 0;
}

}  // namespace

// benchmark_metamorphic [--samples N] [--noise SHARE] [--strip] [--change NAME]… [--seeds N] [--talk] FILE…
int main(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto value = [&] { return i + 1 < argc ? argv[++i] : ""; };
    if (word == "--samples")
      request.samples = std::strtoull(value(), nullptr, 10);
    else if (word == "--write")
      request.folder = value();
    else if (word == "--noise")
      request.noise = std::strtod(value(), nullptr);
    else if (word == "--seeds")
      request.seeds = std::atoi(value());
    else if (word == "--change")
      request.changes.emplace_back(value());
    else if (word == "--strip")
      request.strip = true;
    else if (word == "--talk")
      request.talk = true;
    else
      request.files.emplace_back(word);
  }
  try {
    return run(request);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
