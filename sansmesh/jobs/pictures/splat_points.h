// Evenly spread points on a surface, drawn as splats.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/field/color_field.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/splat/blended_splats.h"

namespace sansmesh::inline v1 {

struct SplatPoints {
  PointSet points;  ///< in coordinates of the model
  std::vector<SplatStretch> stretches;
};

/// About `count` points on the surface (0: the number of samples, limited by the resolution of pictures), with `colors`
/// unless null. Splats are longer along the direction of smaller curvature.
SplatPoints spread_splats(const SurfaceModel& model, std::size_t count, const ColorField* colors, Progress& progress);

}  // namespace sansmesh::inline v1
