// Pictures of surfaces without a mesh, with mirrors and glass.
#pragma once

#include <span>

#include "sansmesh/field/color_field.h"
#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Perspective picture of a surface, framed by `points` (usually its samples; at least one finite) in the coordinates
/// of the caster. `colors` may be null: surface_color. Does not depend on the number of threads. Throws DataError if
/// there is nothing to frame, ArgumentError for bad options.
Image render_surface(const SurfaceCaster& caster, std::span<const Vec3f> points, const ColorField* colors,
                     const SurfaceRenderOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
