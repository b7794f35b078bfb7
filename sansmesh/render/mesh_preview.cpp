#include "sansmesh/render/mesh_preview.h"

#include <cmath>
#include <string>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/render/painter.h"
#include "sansmesh/render/preview_scene.h"

namespace sansmesh {
namespace {

void check_range(const char* name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;
  const auto shown = [](double v) {
    std::string text = std::to_string(v);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  throw ArgumentError("`" + std::string(name) + "` must be from " + shown(lowest) + " to " + shown(highest) + ", not " +
                      (std::isfinite(value) ? shown(value) : std::to_string(value)));
}

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

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress) {
  options.validate();
  Subject subject = make_subject(mesh, options);
  const float radius = subject.radius;
  const float below = subject.mesh.normals.empty() ? radius : 0;  // balls reach below the lowest point, discs hardly
  const Camera camera = frame_camera(subject.mesh.vertices, options.view, options.up, options.field_of_view,
                                     static_cast<double>(options.width) / options.height, kPictureMargin, radius);
  const PreviewScene scene(std::move(subject), options, camera.backward);
  Painter painter(scene, camera, options);
  if (options.ground) painter.add_ground(scene.points(), below);
  return painter.paint(progress);
}

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options) {
  Progress progress;
  return render_mesh(mesh, options, progress);
}

}  // namespace sansmesh
