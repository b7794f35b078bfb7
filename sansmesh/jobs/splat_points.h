// Points that are drawn as splats: spread evenly over a surface.
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

/// About `count` points on the surface (0: as many as its samples, within what pictures can show), with `colors`,
/// unless null; each longer along what is bent less.
SplatPoints spread_splats(const SurfaceModel& model, std::size_t count, const ColorField* colors, Progress& progress);

}  // namespace sansmesh::inline v1
