// Pictures of surfaces that were never meshed: lit like those of meshes, and with mirrors and glass.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/image.h"
#include "sansmesh/field/color_field.h"
#include "sansmesh/render/camera.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/render/surface_caster.h"

namespace sansmesh {

/// The surface seen in perspective, framed by `points` (such as its samples; at least one finite) in the coordinates of
/// the caster. `colors` may be null: surface_color. Does not depend on the number of threads. Throws DataError where
/// there is nothing to frame, ArgumentError for bad options.
Image render_surface(const SurfaceCaster& caster, std::span<const Vec3f> points, const ColorField* colors,
                     const SurfaceRenderOptions& options, Progress& progress);

/// Distances along the rays through the middles of the pixels, rows from top to bottom; infinity where nothing is.
struct DepthMap {
  int width = 0, height = 0;
  std::vector<float> distances;
  float at(int x, int y) const { return distances[static_cast<std::size_t>(y) * width + x]; }
};

/// `camera` in the coordinates of the caster. Throws ArgumentError unless width and height are 1..16384.
DepthMap surface_depth(const SurfaceCaster& caster, const Camera& camera, int width, int height);

}  // namespace sansmesh
