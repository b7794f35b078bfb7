#include "sansmesh/volume/grid/delaunay.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include "sansmesh/box.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {
namespace {

/// Uniform in −1 .. 1, derived from a number.
double hashed(std::uint64_t n) { return static_cast<double>(scrambled(n) >> 11) / 4503599627370496.0 - 1; }

/// Whether the points extend in three directions: farthest point from the first, from the line, from the plane.
bool spans_space(std::span<const Vec3> points, double size) {
  const Vec3 a = points[0];
  const auto farthest = [&](const auto& distance) {
    return *std::max_element(points.begin(), points.end(),
                             [&](const Vec3& p, const Vec3& q) { return distance(p) < distance(q); });
  };
  const Vec3 line = normalized(farthest([&](const Vec3& p) { return squared_norm(p - a); }) - a);
  const auto off_line = [&](const Vec3& p) { return squared_norm(p - a - line * dot(line, p - a)); };
  const Vec3 side = farthest(off_line);
  const Vec3 normal = normalized(cross(line, side - a));
  if (!(off_line(side) > 1e-18 * size * size)) return false;
  const auto off_plane = [&](const Vec3& p) { return std::abs(dot(normal, p - a)); };
  return off_plane(farthest(off_plane)) > 1e-9 * size;
}

/// Owns Qhull's state; its messages go into a buffer.
class QhullRun {
 public:
  QhullRun() : errors_(::open_memstream(&text_, &length_)) { qh_zero(&state_, errors_); }
  ~QhullRun() {
    qh_freeqhull(&state_, !qh_ALL);
    int current = 0, total = 0;
    qh_memfreeshort(&state_, &current, &total);
    if (errors_) std::fclose(errors_);
    std::free(text_);
  }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;

  qhT& state() { return state_; }
  FILE* errors() { return errors_; }
  std::string first_line() {
    std::fflush(errors_);
    const std::string all(text_ ? text_ : "", length_);
    return all.substr(0, all.find('\n'));
  }

 private:
  qhT state_{};
  char* text_ = nullptr;
  std::size_t length_ = 0;
  FILE* errors_;
};

}  // namespace

CellList delaunay_tetrahedra(std::span<const Vec3> points) {
  if (points.size() < 4) throw DataError(fmt::format("{} points: a volume needs at least 4", points.size()));
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  const Vec3 middle = box.center(), size = box.size();
  const double largest = std::max({size.x, size.y, size.z});
  if (!spans_space(points, largest)) throw DataError("all points lie in a plane or on a line");
  const double spacing =
      std::cbrt(size.x / largest * (size.y / largest) * (size.z / largest) / static_cast<double>(points.size()));
  const double shift = 1e-7 * spacing;
  std::vector<coordT> x;
  x.reserve(3 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) x.push_back((points[i][k] - middle[k]) / largest + shift * hashed(3 * i + k));

  QhullRun run;
  qhT* const qh = &run.state();
  char command[] = "qhull d Qt Qbb Q12";
  const int failed =
      qh_new_qhull(qh, 3, static_cast<int>(points.size()), x.data(), False, command, nullptr, run.errors());
  if (failed) throw DataError("the points cannot be tetrahedralised: " + printable(run.first_line(), 200));

  std::vector<std::array<std::uint32_t, 4>> found;
  facetT* facet;
  vertexT *vertex, **vertexp;
  FORALLfacets {
    if (facet->upperdelaunay) continue;
    std::array<std::uint32_t, 4> corners{};
    std::size_t count = 0;
    FOREACHvertex_(facet->vertices) {
      const int id = qh_pointid(qh, vertex->point);
      if (count < 4 && id >= 0) corners[count] = static_cast<std::uint32_t>(id);
      ++count;
    }
    if (count != 4) continue;
    std::array<Vec3, 4> at;
    for (std::size_t k = 0; k < 4; ++k) at[k] = points[corners[k]] - points[corners[0]];
    const double volume = cell_volume(CellShape::tetrahedron, at);
    const double edge = std::sqrt(squared_edges(CellShape::tetrahedron, at).longest);
    if (!(std::abs(volume) > 1e-7 * edge * edge * edge)) continue;
    if (volume < 0) std::swap(corners[0], corners[1]);
    found.push_back(corners);
  }
  // Cells are sorted by point index, so that they inherit the spatial order of the points.
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    const auto least = [](const auto& c) { return *std::min_element(c.begin(), c.end()); };
    return least(a) != least(b) ? least(a) < least(b) : a < b;
  });
  CellList cells;
  cells.shapes.reserve(found.size()), cells.first.reserve(found.size() + 1), cells.corners.reserve(4 * found.size());
  for (const auto& corners : found) cells.add(CellShape::tetrahedron, corners);
  if (cells.empty()) throw DataError("all points lie in a plane or on a line");
  return cells;
}

}  // namespace sansmesh::inline v1
