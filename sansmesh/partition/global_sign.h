// Inside or outside, decided by all local functions together: the generalised winding number of their patches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/partition/far_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Area of {x : ⟨x − point, normal⟩ = 0} within the cube [lower, lower + edge]³. Patches cut out of the cells that they
/// pass through tile a surface whatever the density of its samples.
float plane_area_in_cube(const Vec3f& point, const Vec3f& normal, const Vec3f& lower, float edge);

/// What a far field is at a point, and how much it counts there against another: Σ area / r⁶ (1 / length⁴).
struct FarValue {
  float value = 0, weight = 0;
  Vec3f gradient, weight_gradient;
};

/// Far field of a set of patches: w(x) = Σ ⟨p − x, a⟩ / (4π ‖p − x‖³) is about 1 inside, 0 outside and 1/2 on the
/// surface and on the membrane that closes a hole (Barill et al. 2018). Groups of patches far away count as one, by
/// their sums and the first and second moments of these about their middle: to about 0.1 % of 1, 0.5 % at most.
/// Patches that bound no solid have a far field all the same: the side of the nearest ones.
class GlobalSign {
 public:
  GlobalSign() = default;
  /// Patches that are neighbours in space should be neighbours in the list. `unit`: about the extent of all of them;
  /// sums of 1/r⁶ stay in the range of float only in such a unit. `open`: they bound no solid.
  explicit GlobalSign(std::span<const OrientedPatch> patches, float unit = 1, bool open = false);

  bool empty() const { return tree_.levels.empty(); }

  /// Closed: (1 − 2 w) · d, negative inside; d is a smooth estimate of the distance to the nearest patches (exact for a
  /// plane). Finite everywhere, with a continuous gradient but where w passes 0 or 1, and no steeper than a distance by
  /// far. Open: the mean distance from the patches' planes, weighted by area / r⁶: nearly that of the nearest ones.
  void signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients = {}) const;

  /// The same, to be mixed with another of the same unit. Gradients are left alone unless `gradient`.
  void far_values(std::span<const Vec3f> x, bool gradient, std::span<FarValue> values) const;

  /// The winding number alone.
  void winding_number(std::span<const Vec3f> x, std::span<float> values) const;

 private:
  float unit_ = 1;
  bool open_ = false;
  FarTree tree_;
};

/// The far field of patches some of which bound solids and some of which do not: each kind by itself, the nearer one
/// counts.
struct FarField {
  GlobalSign closed, open;

  void signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients = {}) const;
};

}  // namespace sansmesh::inline v1
