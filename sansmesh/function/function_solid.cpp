#include "sansmesh/function/function_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sansmesh/function/mesh_function.h"

namespace sansmesh::inline v1 {
namespace {

/// Cells along each side of the grid of lower bounds of the function.
constexpr std::size_t kGrid = 32;
/// Wider balls, in cells, are not looked up.
constexpr double kMostCells = 4;

/// Smallest block of the function's mesh near a point, and lower bounds of the function far from its samples, where its
/// evaluation is slowest.
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

  double least(double sign, const Vec3& x, double radius) const override {
    std::size_t first[3], last[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const double scale = kGrid / tree_.edge(), low = (x[k] - radius - tree_.lower()[k]) * scale,
                   high = (x[k] + radius - tree_.lower()[k]) * scale;
      if (!(low >= 0 && high < kGrid && high - low < kMostCells)) return kNothing;
      first[k] = static_cast<std::size_t>(low), last[k] = static_cast<std::size_t>(high);
    }
    double far = std::numeric_limits<double>::infinity();
    for (std::size_t k = first[2]; k <= last[2]; ++k)
      for (std::size_t j = first[1]; j <= last[1]; ++j)
        for (std::size_t i = first[0]; i <= last[0]; ++i) far = std::min(far, sign * far_[(k * kGrid + j) * kGrid + i]);
    return far > 0 ? far : kNothing;
  }

 private:
  static constexpr double kNothing = -std::numeric_limits<double>::infinity();

  void find_far(const ScalarField& field) {
    const double edge = tree_.edge() / kGrid;
    std::vector<Vec3> x(kGrid * kGrid * kGrid);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0, rest = i; k < 3; ++k, rest /= kGrid)
        x[i][k] = tree_.lower()[k] + (static_cast<double>(rest % kGrid) + 0.5) * edge;
    std::vector<ValueRange> ranges(x.size());
    field.ranges(x, std::sqrt(0.75) * edge, ranges);
    far_.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      far_[i] = ranges[i].least > 0 ? ranges[i].least : std::min(ranges[i].most, 0.0);
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
  std::vector<std::uint8_t> deepest_;  ///< level of the deepest leaf below each block
  std::vector<double> far_;            ///< on the grid: signed bounds of the values closest to zero
};

}  // namespace

Solid function_solid(std::shared_ptr<const FittedFunction> function) {
  const PartitionOfUnity& field = function->field;
  auto known = std::make_shared<const FunctionKnowledge>(field);
  const LocalFrame frame = function->frame;
  const std::shared_ptr<const ScalarField> shared(std::move(function), &field);
  return csg::place(csg::leaf(shared, std::move(known)), frame);
}

}  // namespace sansmesh::inline v1
