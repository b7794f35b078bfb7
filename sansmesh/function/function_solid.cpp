#include "sansmesh/function/function_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sansmesh/function/mesh_function.h"

namespace sansmesh {
namespace {

/// Cells along each side of the grid on which it is known where the function is far from zero.
constexpr std::size_t kGrid = 32;

/// The blocks of a function's mesh, asked for the smallest one near a point, and where the function is far from zero:
/// far from its samples it takes longest to evaluate.
class FunctionKnowledge final : public csg::FieldKnowledge {
 public:
  explicit FunctionKnowledge(const PartitionOfUnity& field)
      : tree_(field.mesh_blocks(default_mesh_error(field.report()))), deepest_(tree_.size()) {
    for (std::size_t b = tree_.size(); b-- > 0;) {  // children come after their parents
      deepest_[b] = tree_[b].level;
      if (tree_.is_leaf(b)) continue;
      for (std::size_t c = 0; c < 8; ++c)
        deepest_[b] = std::max(deepest_[b], deepest_[static_cast<std::size_t>(tree_[b].first_child) + c]);
    }
    find_far(field);
  }

  /// Edge of the smallest block that the ball meets; that of the whole tree if it meets none.
  double detail(const Vec3& x, double reach) const override {
    std::uint8_t level = 0;
    look(0, x, reach, level);
    return tree_.edge() / static_cast<double>(1u << level);
  }

  double least(double sign, const Vec3& x) const override {
    std::size_t cell = 0;
    for (std::size_t k = 3; k-- > 0;) {
      const double at = (x[k] - tree_.lower()[k]) / tree_.edge() * kGrid;
      if (!(at >= 0 && at < kGrid)) return kNothing;
      cell = cell * kGrid + static_cast<std::size_t>(at);
    }
    const double far = sign * far_[cell];
    return far > 0 ? far : kNothing;
  }

 private:
  static constexpr double kNothing = -std::numeric_limits<double>::infinity();

  /// Values at corners and middles of all cells: no point is farther from one than 0.56 edges; slopes up to 2.7 are
  /// allowed for.
  void find_far(const ScalarField& field) {
    constexpr std::size_t n = kGrid + 1;
    const double edge = tree_.edge() / kGrid;
    const auto point = [&](std::size_t i, std::size_t side, double shift) {
      Vec3 p;
      for (std::size_t k = 0; k < 3; ++k, i /= side)
        p[k] = tree_.lower()[k] + (static_cast<double>(i % side) + shift) * edge;
      return p;
    };
    std::vector<Vec3> x;
    x.reserve(n * n * n + kGrid * kGrid * kGrid);
    for (std::size_t i = 0; i < n * n * n; ++i) x.push_back(point(i, n, 0));
    for (std::size_t i = 0; i < kGrid * kGrid * kGrid; ++i) x.push_back(point(i, kGrid, 0.5));
    std::vector<double> f(x.size());
    field.evaluate(x, f);
    far_.resize(kGrid * kGrid * kGrid);
    for (std::size_t i = 0; i < far_.size(); ++i) {
      const std::size_t corner = i % kGrid + n * (i / kGrid % kGrid + n * (i / kGrid / kGrid));
      const double sign = f[n * n * n + i] < 0 ? -1 : 1;
      double least = sign * f[n * n * n + i];
      for (const std::size_t c : {0ul, 1ul, n, n + 1, n * n, n * n + 1, n * n + n, n * n + n + 1})
        least = std::min(least, sign * f[corner + c]);
      far_[i] = sign * std::max(0.0, least - kLikelySlope * edge);
    }
  }

  void look(std::size_t b, const Vec3& x, double radius, std::uint8_t& level) const {
    if (deepest_[b] <= level) return;
    const double half = tree_.block_edge(b) / 2;
    const Vec3 d = x - tree_.block_center(b);
    double outside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double off = std::max(0.0, std::abs(d[k]) - half);
      outside += off * off;
    }
    if (outside > radius * radius) return;
    if (tree_.is_leaf(b)) {
      level = tree_[b].level;
      return;
    }
    for (std::size_t c = 0; c < 8; ++c) look(static_cast<std::size_t>(tree_[b].first_child) + c, x, radius, level);
  }

  BlockTree tree_;
  std::vector<std::uint8_t> deepest_;  ///< level of the leaves below each block
  std::vector<double> far_;            ///< on the grid: what values do not come closer to zero than, with their sign
};

}  // namespace

Solid function_solid(std::shared_ptr<const SurfaceFunction> function) {
  const PartitionOfUnity& field = function->field;
  auto known = std::make_shared<const FunctionKnowledge>(field);
  const Vec3 origin = function->origin;
  const double unit = function->unit;
  const std::shared_ptr<const ScalarField> shared(std::move(function), &field);
  return csg::place(csg::leaf(shared, std::move(known)), origin, unit);
}

}  // namespace sansmesh
