#include "sansmesh/function/mesh_solid.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/function/mesh_field.h"
#include "sansmesh/function/mesh_patches.h"
#include "sansmesh/mesh/face_box_tree.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/repair/self_intersections.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kCreaseDegrees = 20;
/// A mesh with larger shares of open edges, or of edges with three faces, is no solid.
constexpr double kOpenEdges = 0.01, kTangledEdges = 0.002;
/// Faces beside which the check for inside faces looks.
constexpr std::size_t kMostChecked = 200;
/// Largest share of the checked points that may be inside.
constexpr double kMostInside = 0.02;
/// Least depth of an intersection of faces, as a share of the diagonal.
constexpr double kCrossingFaces = 1e-7;

const char* const kRemedy = "a reconstruction makes a closed mesh of it, a fit a function";

/// Winding number of the faces about a point beside them, counted along x.
int winding_number(const TriangleMesh& mesh, const FaceBoxTree& tree, const Vec3& from) {
  Box3f ray;
  ray.extend(Vec3f(from));
  ray.upper.x = std::numeric_limits<float>::infinity();
  int winding = 0;
  tree.visit(ray, [&](std::uint32_t f) {
    const auto& t = mesh.triangles[f];
    const Vec3 a = Vec3(mesh.vertices[t[0]]) - from, b = Vec3(mesh.vertices[t[1]]) - from,
               c = Vec3(mesh.vertices[t[2]]) - from;
    const auto side = [](const Vec3& p, const Vec3& q) { return p.y * q.z - p.z * q.y >= 0; };
    const bool first = side(a, b);
    if (side(b, c) != first || side(c, a) != first) return true;
    if ((dot(a, cross(b - a, c - a)) > 0) == first) winding += first ? 1 : -1;
    return true;
  });
  return winding;
}

/// Shares of faces, estimated at some of them.
struct InsideShares {
  double overlapping = 0;  ///< faces of the right orientation inside of others
  double wrong = 0;        ///< other faces beside which the winding number is not that of the surface of a solid
};

InsideShares inside_shares(const TriangleMesh& mesh) {
  const std::size_t n = mesh.triangles.size(), tests = std::min(n, kMostChecked);
  const double step = 1e-4 * static_cast<double>(bounds(mesh).diagonal());
  std::vector<Box3f> boxes(n);
  parallel_for(0, n, 8192, [&](std::size_t t) {
    for (const std::uint32_t v : mesh.triangles[t]) boxes[t].extend(mesh.vertices[v]);
  });
  const FaceBoxTree tree(boxes);
  enum Side : std::uint8_t { kRight, kOverlapping, kWrong };
  std::vector<std::uint8_t> side(tests, kRight);
  parallel_for(0, tests, 1, [&](std::size_t i) {
    const Triangle& t = mesh.triangles[i * n / tests];
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    const Vec3 normal = normalized(cross(b - a, c - a)), middle = (a + b + c) / 3;
    if (normal == Vec3{}) return;
    const int above = winding_number(mesh, tree, middle + normal * step),
              below = winding_number(mesh, tree, middle - normal * step);
    if (above != 0 || below != 1) side[i] = above > 0 && below > above ? kOverlapping : kWrong;
  });
  const auto share = [&](Side s) {
    return static_cast<double>(std::count(side.begin(), side.end(), s)) / static_cast<double>(tests);
  };
  return {share(kOverlapping), share(kWrong)};
}

[[noreturn]] void refuse_inside(double share) {
  throw DataError(
      fmt::format("about {:.0f} % of its faces lie inside of others or face the wrong way; {}", 100 * share, kRemedy));
}

/// Where faces cross each other the inside is ambiguous.
void warn_of_crossings(const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  const double diagonal = static_cast<double>(bounds(mesh).diagonal());
  const auto crossing = self_intersections(mesh, kCrossingFaces * diagonal);
  if (crossing.empty()) return;
  const Vec3 at = mesh.origin + Vec3(mesh.vertices[mesh.triangles[crossing[0][0]][0]]);
  warnings.push_back(
      fmt::format("its faces intersect in {}, for example at ({:.4g}, {:.4g}, {:.4g}): the inside is ambiguous there, "
                  "and the result may have faults and stray parts (`components = auto` leaves those out; {})",
                  counted(crossing.size(), "place"), at.x, at.y, at.z, kRemedy));
}

void reverse_orientation(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

/// Closes holes by fans around their means; returns their number.
std::size_t close_holes(TriangleMesh& mesh) {
  const MeshPatches patches(mesh, kCreaseDegrees);
  std::vector<std::uint32_t> open = patches.open;
  const auto from = [&](std::uint32_t h) { return patches.triangles[h / 3][h % 3]; };
  const auto to = [&](std::uint32_t h) { return patches.triangles[h / 3][(h % 3 + 1) % 3]; };
  std::sort(open.begin(), open.end(),
            [&](std::uint32_t a, std::uint32_t b) { return from(a) != from(b) ? from(a) < from(b) : a < b; });
  std::vector<std::uint8_t> used(open.size(), 0);
  std::size_t holes = 0;
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (used[first]) continue;
    std::vector<std::uint32_t> loop;
    for (std::size_t i = first; i < open.size() && !used[i];) {
      used[i] = 1;
      loop.push_back(open[i]);
      const std::uint32_t end = to(open[i]);
      i = static_cast<std::size_t>(std::lower_bound(open.begin(), open.end(), end,
                                                    [&](std::uint32_t h, std::uint32_t v) { return from(h) < v; }) -
                                   open.begin());
      while (i < open.size() && from(open[i]) == end && used[i]) ++i;
      if (i < open.size() && from(open[i]) != end) break;
    }
    Vec3 middle;
    for (const std::uint32_t h : loop) middle += Vec3(mesh.vertices[from(h)]) / static_cast<double>(loop.size());
    const auto center = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(Vec3f(middle));
    for (const std::uint32_t h : loop) mesh.triangles.push_back({to(h), from(h), center});
    ++holes;
  }
  return holes;
}

}  // namespace

TriangleMesh checked_solid(TriangleMesh given, std::vector<std::string>& warnings, bool* overlaps) {
  TriangleMesh mesh;  // other vertex data is not needed
  mesh.origin = given.origin;
  mesh.reference = given.reference;
  mesh.vertices = std::move(given.vertices);
  mesh.triangles = std::move(given.triangles);
  const MeshEdges e = MeshPatches(mesh, kCreaseDegrees).edges;
  if (static_cast<double>(e.tangled) > kTangledEdges * static_cast<double>(e.edges))
    throw DataError(fmt::format(
        "its faces bound no solid: {} of {} edges have three faces or more, or two that face opposite ways; {}",
        grouped(e.tangled), grouped(e.edges), kRemedy));
  if (static_cast<double>(e.open) > kOpenEdges * static_cast<double>(e.edges))
    throw DataError(fmt::format("its faces bound no solid: {} of {} edges are open; {}", grouped(e.open),
                                grouped(e.edges), kRemedy));
  if (e.open > 0) {
    const std::size_t holes = close_holes(mesh);
    warnings.push_back(fmt::format("{} open: {} closed by flat fans",
                                   e.open == 1 ? "1 edge is" : grouped(e.open) + " edges are", counted(holes, "hole")));
  }
  if (measure_size(mesh).volume < 0) {
    reverse_orientation(mesh);
    warnings.push_back("its faces point inward: reversed");
  }
  const InsideShares sides = inside_shares(mesh);
  const double inside = sides.overlapping + sides.wrong;
  const bool unites = overlaps != nullptr && sides.wrong <= kMostInside && sides.overlapping > kMostInside;
  if (inside > kMostInside && !unites) refuse_inside(inside);
  if (overlaps != nullptr) *overlaps = unites;
  if (!unites) warn_of_crossings(mesh, warnings);
  return mesh;
}

void require_no_overlaps(const TriangleMesh& mesh) {
  const InsideShares sides = inside_shares(mesh);
  if (sides.overlapping + sides.wrong > kMostInside) refuse_inside(sides.overlapping + sides.wrong);
}

Solid solid_of_checked(TriangleMesh mesh, bool rounded) {
  return csg::distance_leaf(std::make_shared<const MeshField>(std::move(mesh), MeshField::Options{.rounded = rounded}));
}

Solid mesh_solid(TriangleMesh mesh, bool rounded, std::vector<std::string>& warnings) {
  return solid_of_checked(checked_solid(std::move(mesh), warnings), rounded);
}

}  // namespace sansmesh::inline v1
