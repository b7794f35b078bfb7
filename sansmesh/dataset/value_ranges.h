// Which values a volume's samples have around a place: where a surface of one value can be, and where it cannot.
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

/// Built once, then asked from any thread. Cells in groups of neighbours, under a tree that knows the least and the
/// largest value of all samples below: reconstructions that are smoother than the samples' own cells go beyond these by
/// less than `kBeyond` of the difference.
class ValueRanges {
 public:
  static constexpr double kBeyond = 0.3;

  /// value(i) of sample i. Places are asked for in the coordinates of `place`.
  ValueRanges(const SampledVolume& volume, const std::function<double(std::size_t)>& value, const LocalFrame& frame);

  /// Of the cells that the ball meets; {+infinity, −infinity} where it meets none.
  ValueRange around(const Vec3& x, double radius) const;
  /// Whether `value` is among those of a group of cells that the ball meets: quicker than around().
  bool among(const Vec3& x, double radius, double value) const;
  /// Centres of the groups of cells among whose values `value` is.
  std::vector<Vec3> places_of(double value) const;

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
  double scale_ = 1;  ///< of the values in the tree, which are floats
};

}  // namespace sansmesh::inline v1
