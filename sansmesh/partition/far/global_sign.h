// Sign of the function far from all supports: the generalised winding number of the patches of all local functions.
#pragma once

#include <span>

#include "sansmesh/partition/far/far_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Area of {x : ⟨x − point, normal⟩ = 0} within the cube [lower, lower + edge]³. Patches restricted to their cells tile
/// a surface at any density of its samples.
float plane_area_in_cube(const Vec3f& point, const Vec3f& normal, const Vec3f& lower, float edge);

/// Value of a far field at a point, and its weight in a blend of two fields: Σ area / r⁶ (1 / length⁴).
struct FarValue {
  float value = 0, weight = 0;
  Vec3f gradient, weight_gradient;
};

/// Far field of a set of patches: w(x) = Σ ⟨p − x, a⟩ / (4π ‖p − x‖³) is about 1 inside, 0 outside and 1/2 on the
/// surface and on the membrane that closes a hole (barill2018). Distant groups of patches are approximated by their
/// sums and the first and second moments of these about their centre: typical error about 0.001, at most 0.005. The far
/// field of open patches is the signed distance to the nearest ones.
class GlobalSign {
 public:
  GlobalSign() = default;
  /// Patches that are neighbours in space should be neighbours in the list. `unit`: approximate extent of all patches;
  /// sums of 1/r⁶ stay in the range of float only in such a unit. `open`: the patches bound no solid.
  explicit GlobalSign(std::span<const OrientedPatch> patches, float unit = 1, bool open = false);

  bool empty() const { return tree_.levels.empty(); }

  /// Closed: (1 − 2 w) · d, negative inside, where d is a smooth estimate of the distance to the nearest patches (exact
  /// for a plane). Finite everywhere; the gradient is continuous except where w passes 0 or 1, and at most as steep as
  /// a distance far away. Open: the mean distance from the patches' planes, weighted by area / r⁶, nearly that of the
  /// nearest ones.
  void signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients = {}) const;

  /// The same with weights for a blend with another field of the same unit. Gradients are unchanged unless `gradient`.
  void far_values(std::span<const Vec3f> x, bool gradient, std::span<FarValue> values) const;

  /// Winding number only.
  void winding_number(std::span<const Vec3f> x, std::span<float> values) const;
  /// Rough signed distances of open patches from sums without moments, in a third of the time, and `most`, the largest
  /// sizes that the same sums give with all patches facing the point: errors are below a tenth of that at 99 of 100
  /// points. `most` is infinite for closed patches.
  void rough_distance(std::span<const Vec3f> x, std::span<float> values, std::span<float> most) const;
  /// Signs of the distances of closed patches where a rough winding number leaves no doubt, in a fifth of the time: −1
  /// inside, 1 outside, else 0.
  void easy_signs(std::span<const Vec3f> x, std::span<float> signs) const;

 private:
  float unit_ = 1;
  bool open_ = false;
  FarTree tree_;
};

/// Far field of patches some of which bound solids and some of which do not: a field for each kind, of which the nearer
/// one dominates.
struct FarField {
  GlobalSign closed, open;

  void signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients = {}) const;

  /// Like GlobalSign::easy_signs; 0 if there are open patches, whose sides are rarely clear.
  void easy_signs(std::span<const Vec3f> x, std::span<float> signs) const;
};

}  // namespace sansmesh::inline v1
