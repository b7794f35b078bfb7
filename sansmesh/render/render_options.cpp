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
  check_color("background_color", background_color);
  check_color("surface_color", surface_color);
  check_range("samples", samples, 1, 8);
  check_range("occlusion_rays", occlusion_rays, 0, 64);
  if (point_radius && !(*point_radius > 0 && std::isfinite(*point_radius)))
    throw ArgumentError("`point_radius` must be positive, not " + std::to_string(*point_radius));
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
