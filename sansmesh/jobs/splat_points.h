// Points that are drawn as splats: spread evenly over a surface.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/field/color_field.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/render/blended_splats.h"

namespace sansmesh {

struct SplatPoints {
  PointSet points;  ///< in coordinates of the model
  std::vector<SplatStretch> stretches;
};

/// About `count` points on the surface (0: as many as its samples, within what pictures can show), with `colors`,
/// unless null; each longer along what is bent less.
SplatPoints spread_splats(const SurfaceModel& model, std::size_t count, const ColorField* colors, Progress& progress);

}  // namespace sansmesh
