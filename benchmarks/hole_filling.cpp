// Cuts single holes of 8 to 12 % of the diagonal out of closed meshes, fills them, and lists how many stay open, how
// many fillings intersect the mesh or themselves, and how far fillings are from the original surface.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh/repair/fill_holes.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh_measures.h"
#include "timing.h"

namespace {

using namespace sansmesh;

constexpr int kPlaces = 18;
constexpr double kLeastShare = 0.08, kMostShare = 0.12;

/// Triangles whose corners are on average within a distance of a vertex along the edges: with jagged borders.
std::vector<std::uint8_t> region_at(const TriangleMesh& mesh, const std::vector<std::vector<std::uint32_t>>& near,
                                    std::uint32_t seed, double radius) {
  std::vector<double> far(mesh.vertices.size(), HUGE_VAL);
  std::priority_queue<std::pair<double, std::uint32_t>> open;
  open.emplace(0, seed), far[seed] = 0;
  while (!open.empty()) {
    const auto [negative, v] = open.top();
    open.pop();
    if (-negative > far[v]) continue;
    for (const std::uint32_t w : near[v]) {
      const double there = far[v] + static_cast<double>(norm(mesh.vertices[v] - mesh.vertices[w]));
      if (there < far[w] && there <= 2 * radius) far[w] = there, open.emplace(-there, w);
    }
  }
  std::vector<std::uint8_t> inside(mesh.triangles.size());
  for (std::size_t i = 0; i < inside.size(); ++i)
    inside[i] = far[mesh.triangles[i][0]] + far[mesh.triangles[i][1]] + far[mesh.triangles[i][2]] <= 3 * radius;
  return inside;
}

struct Outcome {
  int places = 0, open = 0, crossing = 0;
  double there = 0, back = 0, farthest = 0, cpu = 0;  ///< sums of distances in % of the diagonal
};

TriangleMesh part_of(const TriangleMesh& mesh, auto take) {
  TriangleMesh part = mesh;
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = take(i);
  keep_triangles(part, keep);
  return part;
}

void cut_and_fill(const TriangleMesh& mesh, const std::vector<std::uint8_t>& inside, Outcome& outcome, bool list) {
  TriangleMesh holed = part_of(mesh, [&](std::size_t i) { return !inside[i]; });
  const std::size_t kept = holed.triangles.size();
  const HoleLoops loops = find_holes(holed);
  if (loops.loops.size() != 1) return;
  const double share = loops.loops[0].diameter / bounds(mesh).diagonal();
  if (share < kLeastShare || share > kMostShare) return;
  ++outcome.places;
  Progress silent;
  FillReport report;
  outcome.cpu += time_of([&] { report = fill_holes(holed, FillOptions{.all = true}, silent); }).cpu;
  if (report.filled != 1) {
    ++outcome.open;
    if (list) fmt::print("  open: {} edges\n", loops.loops[0].vertices.size());
    return;
  }
  // Around the hole only: large meshes would take minutes.
  const Vec3f middle(loops.loops[0].middle - mesh.origin);
  const auto near = [&](const TriangleMesh& of, std::size_t i) {
    return norm(of.vertices[of.triangles[i][0]] - middle) < static_cast<float>(2 * loops.loops[0].diameter);
  };
  std::vector<std::uint8_t> is_new;
  for (std::size_t i = 0; i < holed.triangles.size(); ++i)
    if (near(holed, i)) is_new.push_back(i >= kept);
  holed = part_of(holed, [&](std::size_t i) { return near(holed, i); });
  const TriangleMesh original = part_of(mesh, [&](std::size_t i) { return near(mesh, i); });
  std::size_t crossing = 0;
  for (const auto& [a, b] : self_intersections(holed, 1e-6 * bounds(mesh).diagonal()))
    crossing += is_new[a] || is_new[b];
  outcome.crossing += crossing > 0;
  if (list && crossing > 0) fmt::print("  crossing: {} pairs, {} edges\n", crossing, loops.loops[0].vertices.size());
  const TriangleMesh filling = part_of(holed, [&](std::size_t i) { return is_new[i] != 0; });
  const TriangleMesh removed = part_of(mesh, [&](std::size_t i) { return inside[i] != 0; });
  const SurfaceDistance there = measure_distance(filling, original, {.samples = 5000}, silent);
  const SurfaceDistance back = measure_distance(removed, holed, {.samples = 5000}, silent);
  const double percent = 100 / bounds(mesh).diagonal();
  outcome.there += there.to_reference.mean * percent, outcome.back += back.to_reference.mean * percent;
  outcome.farthest += std::max(there.to_reference.max, back.to_reference.max) * percent;
}

Outcome outcome_of(const TriangleMesh& mesh, bool list) {
  std::vector<std::vector<std::uint32_t>> near(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) near[t[k]].push_back(t[(k + 1) % 3]);
  Outcome outcome;
  const double diagonal = bounds(mesh).diagonal();
  for (int i = 0; outcome.places < kPlaces && i < 40 * kPlaces; ++i) {
    const auto seed = static_cast<std::uint32_t>((static_cast<std::uint64_t>(i) * 2654435761u) % mesh.vertices.size());
    const double diameter = kLeastShare + (kMostShare - kLeastShare) * (0.15 + 0.7 * (i % 5) / 4);
    cut_and_fill(mesh, region_at(mesh, near, seed, 0.53 * diameter * diagonal), outcome, list);
  }
  return outcome;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    fmt::print(stderr, "usage: benchmark_hole_filling [--list] MESH…\n");
    return 2;
  }
  fmt::print("{:<24} {:>6} {:>5} {:>8} {:>18} {:>18} {:>10} {:>6}\n", "mesh", "places", "open", "crossing",
             "fill→original %", "original→fill %", "farthest %", "CPU s");
  Outcome all;
  bool list = false;
  for (const char* file : std::span(arguments + 1, arguments + count)) {
    if (std::string_view(file) == "--list") {
      list = true;
      continue;
    }
    Progress silent;
    TriangleMesh mesh = read_mesh(file);
    join_equal_vertices(mesh);
    const Outcome o = outcome_of(mesh, list);
    const std::string_view name = file;
    const int done = std::max(1, o.places - o.open);
    fmt::print("{:<24} {:>6} {:>5} {:>8} {:>18.4f} {:>18.4f} {:>10.3f} {:>6.2f}\n", name.substr(name.rfind('/') + 1),
               o.places, o.open, o.crossing, o.there / done, o.back / done, o.farthest / done, o.cpu);
    all.places += o.places, all.open += o.open, all.crossing += o.crossing, all.cpu += o.cpu;
    all.there += o.there, all.back += o.back, all.farthest += o.farthest;
  }
  const int done = std::max(1, all.places - all.open);
  fmt::print("{:<24} {:>6} {:>5} {:>8} {:>18.4f} {:>18.4f} {:>10.3f} {:>6.2f}\n", "all", all.places, all.open,
             all.crossing, all.there / done, all.back / done, all.farthest / done, all.cpu);
}
