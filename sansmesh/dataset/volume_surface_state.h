// Data members of VolumeSurface.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/dataset/volume_surface.h"
#include "sansmesh/surface/foot_field.h"
#include "sansmesh/surface/layer_projection.h"

namespace sansmesh::inline v1 {

struct VolumeSurface::State {
  std::shared_ptr<const SampledVolume> volume;
  Placement place;
  VolumeSurfaceOptions options;
  VolumeSurfaceReport report;
  std::optional<LayerProjection> projection;
  SurfaceFeet feet;                         ///< feet of `places`
  std::unique_ptr<const ScalarField> side;  ///< of points outside the balls
  BallUnion places;                         ///< samples next to the surface, with a ball around each
  std::vector<float> place_spacing;         ///< spacing at `places`
  std::unique_ptr<const VolumeDomain> domain;
  std::unique_ptr<const ScalarField> field;
  BallUnion balls;
  std::vector<float> spacing;
};

}  // namespace sansmesh::inline v1
