// Neighbour queries on samples in D variables, exact in double precision although the tree is in float.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {

/// A position in D variables.
template <int D>
using Position = std::array<double, D>;

template <int D>
double squared_distance(const Position<D>& a, const Position<D>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < D; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

/// Throws DataError naming the first sample with a value that is not finite.
void require_finite(std::span<const double> values, std::size_t components = 1);

/// Samples with a tree over them, D = 1, 2, 3. Queries are thread-safe. The tree holds the positions relative to the
/// middle of their box in units of its size, so an offset of the coordinates costs no digits. `within` separates
/// samples closer than 1e-7 of the box, `nearest` does not.
template <int D>
class SampleIndex {
 public:
  struct Hit {
    double squared_distance;
    std::uint32_t index;
  };

  SampleIndex() = default;
  /// Copies the positions. Throws DataError for none, and for coordinates that are not finite.
  explicit SampleIndex(std::span<const Position<D>> positions);

  std::size_t size() const { return positions_.size(); }
  std::span<const Position<D>> positions() const { return positions_; }
  const Position<D>& lower() const { return lower_; }
  const Position<D>& upper() const { return upper_; }

  /// Replaces `out` by the samples nearer than `radius` (in double precision), nearest first up to rounding to float.
  void within(const Position<D>& x, double radius, std::vector<Hit>& out) const;
  /// Replaces `out` by the min(k, size()) nearest samples, in the order of their distance rounded to float.
  void nearest(const Position<D>& x, std::size_t k, std::vector<Hit>& out) const;

  /// Indices of the samples in an order where consecutive ones are close together.
  std::span<const std::uint32_t> order() const { return tree_.order(); }

  /// Spacing h of the samples: the median (for D > 1 the lower quartile) over at most 4,096 of them of the distance to
  /// their 2D-th neighbour. On a grid that is the grid spacing; for random samples of density n it is 0.84, 0.90 and
  /// 1.00 n^(−1/D) for D = 1, 2, 3. If neighbours coincide: the box's longest edge over the D-th root of the number of
  /// samples, or 1 if that vanishes.
  double spacing() const;

 private:
  Vec3f local(const Position<D>& x) const;

  std::vector<Position<D>> positions_;
  Position<D> lower_{}, upper_{}, center_{};
  double scale_ = 1;
  KdTree tree_;
};

extern template class SampleIndex<1>;
extern template class SampleIndex<2>;
extern template class SampleIndex<3>;

}  // namespace sansmesh::inline v1
