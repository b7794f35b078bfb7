#include "sansmesh/io/points/frame_view.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::io {
namespace {

/// Least number of cells for a decision.
constexpr std::size_t kFewestCells = 64;
/// Share of neighbouring cells with the same orientation in a frame, and of cells with the same orientation from the
/// viewpoint: nearly all, except for noise across the rays.
constexpr double kOrdered = 0.8, kSeen = 0.85;
/// Cosine below which a cell is seen edge-on.
constexpr double kEdgewise = 0.02;

struct FrameCount {
  std::size_t one = 0, other = 0;

  std::size_t all() const { return one + other; }
  FrameCount operator+(const FrameCount& o) const { return {one + o.one, other + o.other}; }
};

/// Cells of a grid: the corner (row, column) with its neighbours below and to the right.
class FrameCells {
 public:
  FrameCells(std::span<const Vec3f> points, std::size_t width)
      : points_(points), width_(width), rows_(points.size() / width) {}

  std::size_t rows() const { return rows_ - 1; }
  std::size_t columns() const { return width_ - 1; }
  const Vec3f& at(std::size_t row, std::size_t column) const { return points_[row * width_ + column]; }

  /// Normal (not unit) on the side from which rows run down and columns to the right; zero if a corner is missing.
  Vec3 normal(std::size_t row, std::size_t column) const {
    const Vec3f &p = at(row, column), &down = at(row + 1, column), &right = at(row, column + 1);
    if (!is_finite(p) || !is_finite(down) || !is_finite(right)) return {};
    return cross(Vec3(down) - Vec3(p), Vec3(right) - Vec3(p));
  }

  template <class Count>
  FrameCount count(Count&& of_cell) const {
    return parallel_reduce(
        rows(), 16, FrameCount{},
        [&](std::size_t first, std::size_t last) {
          FrameCount sum;
          for (std::size_t r = first; r < last; ++r)
            for (std::size_t c = 0; c < columns(); ++c) {
              const int side = of_cell(r, c);
              sum.one += side > 0, sum.other += side < 0;
            }
          return sum;
        },
        [](const FrameCount& a, const FrameCount& b) { return a + b; });
  }

 private:
  std::span<const Vec3f> points_;
  std::size_t width_, rows_;
};

int side_of(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

}  // namespace

std::optional<FrameView> measure_frame(std::span<const Vec3f> points, std::size_t width,
                                       const std::optional<Vec3f>& eye) {
  if (width < 2 || points.size() < 2 * width) return std::nullopt;
  const FrameCells cells(points, width);
  const FrameCount alike = cells.count([&](std::size_t r, std::size_t c) {
    return c + 1 < cells.columns() ? side_of(dot(cells.normal(r, c), cells.normal(r, c + 1))) : 0;
  });
  const auto share = [](std::size_t part, const FrameCount& of) {
    return static_cast<double>(part) / static_cast<double>(of.all());
  };
  if (alike.all() < kFewestCells || share(alike.one, alike) < kOrdered) return std::nullopt;

  FrameView view;
  float sign = 1;
  if (eye) {
    const FrameCount seen = cells.count([&](std::size_t r, std::size_t c) {
      const Vec3 normal = cells.normal(r, c), ray = Vec3(*eye) - Vec3(cells.at(r, c));
      const double facing = dot(normal, ray);
      return std::abs(facing) > kEdgewise * norm(normal) * norm(ray) ? side_of(facing) : 0;
    });
    view.seen_from_eye = seen.all() >= kFewestCells && share(std::max(seen.one, seen.other), seen) >= kSeen;
    // Pictures may be stored upside down or mirrored.
    if (view.seen_from_eye && seen.other > seen.one) sign = -1;
  }
  view.normals.resize(points.size());
  parallel_for(0, cells.rows() + 1, 16, [&](std::size_t r) {
    for (std::size_t c = 0; c < width; ++c) {
      if (!is_finite(cells.at(r, c))) continue;
      // Cells across a depth jump are large and unreliable: small cells have more weight.
      Vec3 sum;
      for (const std::size_t row : {r, r - 1})
        for (const std::size_t column : {c, c - 1}) {
          if (row >= cells.rows() || column >= cells.columns()) continue;  // also for -1, which is large as unsigned
          const Vec3 normal = cells.normal(row, column);
          const double area = norm(normal);
          if (!(area > 0)) continue;
          const Vec3 corner(cells.at(row, column));
          const double edges = squared_norm(Vec3(cells.at(row + 1, column)) - corner) +
                               squared_norm(Vec3(cells.at(row, column + 1)) - corner);
          sum += normal / (area * edges);
        }
      view.normals[r * width + c] = Vec3f(normalized(sum)) * sign;
    }
  });
  return view;
}

}  // namespace sansmesh::inline v1::io
