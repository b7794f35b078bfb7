// Bounds of a volume's sample values in a ball, which locate its level sets.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Immutable after construction, safe from any thread. Groups of neighbouring cells under a tree whose nodes have the
/// smallest and largest sample value below. Reconstructions smoother than linear interpolation exceed this range by
/// less than `kBeyond` of the difference.
class ValueRanges {
 public:
  static constexpr double kBeyond = 0.3;

  /// value(i) of sample i. Query points are in the coordinates of `frame`.
  ValueRanges(const SampledVolume& volume, const std::function<double(std::size_t)>& value, const LocalFrame& frame);

  /// Range of the cells that the ball meets; {+infinity, −infinity} if it meets none.
  ValueRange around(const Vec3& x, double radius) const;
  /// Approximate range of all samples.
  ValueRange of_samples() const;
  /// Whether `value` is in the range of a group of cells that the ball meets; faster than around().
  bool among(const Vec3& x, double radius, double value) const;
  /// Centres of the groups of cells with `value` in their range.
  std::vector<Vec3> points_with(double value) const;

 private:
  struct Node {
    BoxNode boxes;
    float least[kTreeWidth], most[kTreeWidth];
  };
  /// Squared distances from x to the nearest and the farthest point of a lane's box.
  struct Reach {
    float nearest, farthest;
  };
  static Reach reach(const Node& node, std::size_t lane, const Vec3f& x);

  struct Item {
    Box3f box;
    float least, most;
  };
  static std::vector<Item> lattice_items(const SampledVolume& volume, const std::function<double(std::size_t)>& value,
                                         const LocalFrame& frame);
  static std::vector<Item> cell_items(const SampledVolume& volume, const std::function<double(std::size_t)>& value,
                                      const LocalFrame& frame);

  std::vector<std::vector<Node>> levels_;
  double scale_ = 1;  ///< factor of the values in the tree, which are floats
};

}  // namespace sansmesh::inline v1
