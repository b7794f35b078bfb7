#include <cstdint>
#include <unordered_map>
#include <vector>

#include "sansmesh/core/parallel_collect.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/measure/section_curves.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSectionChunk = 1 << 15;

/// Triangles with corners on both sides, in ascending order.
std::vector<std::uint32_t> cut_triangles(const TriangleMesh& mesh, const Vec3& normal, double offset) {
  const std::size_t n = mesh.vertices.size();
  const auto height = [&](std::uint32_t i) { return dot(normal, Vec3(mesh.vertices[i])) - offset; };
  const auto collect = [&](std::size_t first, std::size_t last, std::vector<std::uint32_t>& found) {
    for (std::size_t i = first; i < last; ++i) {
      const Triangle& t = mesh.triangles[i];
      if (t[0] >= n || t[1] >= n || t[2] >= n) continue;
      const double a = height(t[0]), b = height(t[1]), c2 = height(t[2]);
      if (!std::isfinite(a + b + c2)) continue;
      const int above = (a >= 0) + (b >= 0) + (c2 >= 0);
      if (above == 1 || above == 2) found.push_back(static_cast<std::uint32_t>(i));
    }
  };
  return parallel_collect<std::uint32_t>(mesh.triangles.size(), kSectionChunk, collect);
}

}  // namespace

Section section_mesh(const TriangleMesh& mesh, const CutPlane& plane) {
  const double offset = plane.offset - dot(plane.normal, mesh.origin);
  std::vector<SectionPiece> pieces;
  std::vector<std::array<double, 2>> points;
  const std::vector<std::uint32_t> cut = cut_triangles(mesh, plane.normal, offset);
  std::vector<Vec3f> corners;
  corners.reserve(3 * cut.size());
  for (const std::uint32_t i : cut)
    for (const std::uint32_t v : mesh.triangles[i]) corners.push_back(mesh.vertices[v] + Vec3f{});  // turns -0 into 0
  const std::vector<std::uint32_t> first = first_equal_positions(corners);
  std::unordered_map<std::uint64_t, std::uint32_t> crossings;  // by the pair of corners
  for (std::size_t c = 0; c < cut.size(); ++c) {
    const Vec3f* const at = corners.data() + 3 * c;
    const std::uint32_t* const corner = first.data() + 3 * c;
    double height[3];
    for (std::size_t k = 0; k < 3; ++k) height[k] = dot(plane.normal, Vec3(at[k])) - offset;
    SectionPiece piece{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t a = k, b = (k + 1) % 3;
      const bool falls = height[a] >= 0 && height[b] < 0, rises = height[a] < 0 && height[b] >= 0;
      if (!falls && !rises) continue;
      // Interpolate from the same end for both triangles at the edge.
      if (corner[a] > corner[b]) std::swap(a, b);
      const std::uint64_t key = std::uint64_t{corner[a]} << 32 | corner[b];
      const auto [found, fresh] = crossings.try_emplace(key, static_cast<std::uint32_t>(points.size()));
      if (fresh) {
        // Exact at the ends: a vertex in the plane keeps its position.
        const Vec3 p(at[a]), q(at[b]);
        const double t = height[a] / (height[a] - height[b]);
        const Vec3 x = mesh.origin + (height[b] == 0 ? q : p + (q - p) * t);
        points.push_back({dot(plane.u, x), dot(plane.v, x)});
      }
      (falls ? piece.from : piece.to) = found->second;
    }
    pieces.push_back(piece);
  }
  return make_section(plane, chain_pieces(pieces, points.size()), points);
}

std::vector<Section> section_mesh(const TriangleMesh& mesh, std::span<const CutPlane> planes, Progress& progress) {
  progress.begin("sections", planes.size());
  std::vector<Section> sections;
  sections.reserve(planes.size());
  for (const CutPlane& plane : planes) {
    sections.push_back(section_mesh(mesh, plane));
    progress.advance();
  }
  return sections;
}

namespace {

std::size_t points_of(const Section& section) {
  std::size_t points = 0;
  for (const SectionCurve& c : section.curves) points += c.points.size();
  return points;
}

constexpr ReportRow kSectionRows[] = {
    reported<[](const Section& r) { return equation(r.plane); }>({.name = "equation", .text = "Equation of the plane"}),
    reported<[](const Section& r) { return r.plane.normal; }>({.name = "normal", .text = "Normal of the plane"}),
    reported<[](const Section& r) { return r.plane.offset; }>(
        {.name = "offset", .text = "Distance of the plane from the origin, along its normal", .unit = "length"}),
    reported<[](const Section& r) { return r.curves.size(); }>({.name = "curves", .text = "Curves"}),
    reported<&Section::open_curves>({.text = "Curves that are not closed"}),
    reported<[](const Section& r) { return points_of(r); }>({.name = "vertices", .text = "Vertices of all curves"}),
    reported<&Section::length>({.text = "Length of all curves", .unit = "length"}),
    reported<&Section::area>({.text = "Area within them, holes subtracted", .unit = "length²"})};

}  // namespace

const ReportSchema& Section::schema() {
  static constexpr ReportSchema schema{kSectionRows};
  return schema;
}

}  // namespace sansmesh::inline v1
