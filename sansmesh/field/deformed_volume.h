// Volume deformed by a map of space, without resampling (tejada2008, 6.4; docs/methods/deformation.md).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/map_stretch.h"
#include "sansmesh/space_map.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// f(T(x)) for a backward map T; gradients are Jᵀ ∇f = (I + J_D)ᵀ ∇f with D(x) = T(x) − x. Components are transported
/// unchanged, including those of vectors. Gaps opened by cuts, and points where the map is undefined, are outside the
/// volume; values there continue those of f, or are zero.
class DeformedVolume final : public VolumeField {
 public:
  /// `near`: an approximate box of the deformed volume. `bounds` is used unchanged if given, otherwise computed
  /// (preimage_box). Throws DataError as preimage_box.
  DeformedVolume(std::shared_ptr<const VolumeField> source, std::shared_ptr<const SpaceMap> map,
                 std::optional<Box3> near = {}, std::optional<Box3> bounds = {});

  Box3 bounds() const override { return bounds_; }
  std::size_t components() const override { return source_->components(); }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  /// Spacing at T(x) divided by the stretch.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;
  /// Ranges of the source in boxes that contain the images under T (SpaceMap::images).
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  std::shared_ptr<const VolumeField> source_;
  std::shared_ptr<const SpaceMap> map_;
  bool gaps_;
  Box3 bounds_;
  MapStretch stretch_;
};

}  // namespace sansmesh::inline v1
