// Pictures of surfaces that were never meshed: lit like those of meshes, and with mirrors and glass.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/image.h"
#include "sansmesh/field/color_field.h"
#include "sansmesh/render/camera.h"
#include "sansmesh/render/mesh_preview.h"
#include "sansmesh/render/surface_caster.h"

namespace sansmesh {

/// As for meshes (`smooth` and `point_radius` have no effect here), and:
struct SurfaceRenderOptions : RenderOptions {
  /// Share of the light that a mirror would send, 0..1. Mirror rays are cast on the surface itself.
  double reflection = 0;
  /// Share of the light that comes through, 0..1: the surface bounds a clear body. reflection + transmission <= 1.
  double transmission = 0;
  /// Of the body against what is around it, 1..4: 1.33 water, 1.5 glass. Mirrors what Fresnel's formulas say on top.
  double refraction_index = 1.5;
  /// Mirror and refraction rays in sequence, 1..16.
  int bounces = 4;
  /// Shadows fall from the surface itself, not from discs around the samples: exact and slow.
  bool exact_shadows = false;
  /// For quick frames: no shadows, no occlusion, no ground, one sample per pixel, whatever else is set.
  bool plain = false;
  /// The view does not zoom with the direction: frames of a turntable fit together.
  bool steady = false;
  /// What mirrors and glass show where a ray leaves: linear light (1 is white) from a unit direction. Default: the
  /// background in front, a bright sky elsewhere.
  std::function<Vec3f(const Vec3f& direction)> environment;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

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
