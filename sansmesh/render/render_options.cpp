#include "sansmesh/render/render_options.h"

#include <cmath>
#include <string>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

void check_color(const char* name, const Vec3f& color) {
  for (std::size_t k = 0; k < 3; ++k) check_range(name, static_cast<double>(color[k]), 0, 1);
}

}  // namespace

void RenderOptions::validate() const {
  check_range("width", width, 1, 16384);
  check_range("height", height, 1, 16384);
  check_range("view.azimuth", view.azimuth, -3600, 3600);
  check_range("view.elevation", view.elevation, -90, 90);
  check_range("field_of_view", field_of_view, 1, 120);
  check_range("zoom", zoom, 0.001, 100000);
  if (look_at && !is_finite(*look_at)) throw ArgumentError("`look_at` must be finite");
  if (look_radius && !(*look_radius > 0 && std::isfinite(*look_radius)))
    throw ArgumentError("`look_radius` must be positive, not " + std::to_string(*look_radius));
  if (look_radius && !look_at) throw ArgumentError("`look_radius` needs `look_at`");
  if (scale_bar && !orthographic)
    throw ArgumentError("`scale_bar` needs `orthographic`: in perspective there is no one scale");
  if (!(input_length > 0 && std::isfinite(input_length))) throw ArgumentError("`input_length` must be positive");
  if (clip_box) {
    if (!is_finite(clip_box->lower) || !is_finite(clip_box->upper)) throw ArgumentError("`clip_box` must be finite");
    const Vec3 size = clip_box->size();
    if (!(size.x > 0 && size.y > 0 && size.z > 0))
      throw ArgumentError("`clip_box` must have an extent: XMIN < XMAX, YMIN < YMAX and ZMIN < ZMAX");
  }
  check_color("background_color", background_color);
  check_color("surface_color", surface_color);
  check_range("wire_width", wire_width, 0.1, 50);
  check_color("wire_color", wire_color);
  check_range("exposure_reach", exposure_reach, 1e-6, 10);
  check_range("bend_light", bend_light, 0, 1);
  check_range("line_width", line_width, 0.1, 50);
  check_range("line_strength", line_strength, 0.1, 1e6);
  check_color("line_color", line_color);
  check_range("samples", samples, 1, 8);
  check_range("occlusion_rays", occlusion_rays, 0, 64);
  if (point_radius && !(*point_radius > 0 && std::isfinite(*point_radius)))
    throw ArgumentError("`point_radius` must be positive, not " + std::to_string(*point_radius));
}

void move_from_input(RenderOptions& options, const Placement& place) {
  if (options.look_at) options.look_at = place.from_input(*options.look_at);
  if (options.look_radius) options.look_radius = place.from_input(*options.look_radius);
  options.input_length *= place.unit;
  if (options.clip_box) options.clip_box = place.from_input(*options.clip_box);
}

void SurfaceRenderOptions::validate() const {
  RenderOptions::validate();
  check_range("reflection", reflection, 0, 1);
  check_range("transmission", transmission, 0, 1);
  check_range("refraction_index", refraction_index, 1, 4);
  check_range("bounces", bounces, 1, 16);
  if (reflection + transmission > 1 + 1e-9)
    throw ArgumentError("`reflection` + `transmission` must be at most 1, not " +
                        std::to_string(reflection + transmission));
}

}  // namespace sansmesh
