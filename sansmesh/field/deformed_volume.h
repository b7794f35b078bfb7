// A volume deformed: seen through a map of space, without resampling (METHODS §7.1).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/map_stretch.h"
#include "sansmesh/space_map.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// f(T(x)) for a backward map T; gradients are Jᵀ ∇f = (I + J_D)ᵀ ∇f with D(x) = T(x) − x. Components are carried as
/// they are, those of vectors too. Gaps that a cut has opened, and places where the map is not defined, are not in the
/// volume; values there go on as f does, or are zero.
class DeformedVolume final : public VolumeField {
 public:
  /// `near`: a box about where the deformed volume lies. `bounds` is taken as it is where given, else found
  /// (box_before). Throws DataError as that does.
  DeformedVolume(std::shared_ptr<const VolumeField> source, std::shared_ptr<const SpaceMap> map,
                 std::optional<Box3> near = {}, std::optional<Box3> bounds = {});

  Box3 bounds() const override { return bounds_; }
  std::size_t components() const override { return source_->components(); }
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  /// That at T(x) through the stretch there.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;
  /// Those of the source in the boxes that hold T of these (SpaceMap::images).
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  std::shared_ptr<const VolumeField> source_;
  std::shared_ptr<const SpaceMap> map_;
  bool gaps_;
  Box3 bounds_;
  MapStretch stretch_;
};

}  // namespace sansmesh::inline v1
