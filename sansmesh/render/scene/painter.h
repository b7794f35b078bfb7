// From rays to pixels: soft light on whatever a scene holds.
#pragma once

#include <memory>
#include <span>

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Share of the picture's half left free around the subject.
constexpr double kPictureMargin = 0.13;

/// The camera of a picture of these points (finite, in the painter's coordinates, those of `frame`), each a ball of the
/// given radius, with that margin. Throws ArgumentError where no point lies near the box that the options ask for.
Camera picture_camera(std::span<const Vec3f> points, const PictureFrame& frame, const RenderOptions& options,
                      float radius = 0);

/// The subject's box should be centred at 0 with a diagonal of about 1. What is passed must outlive the painter.
class Painter {
 public:
  /// `smooth_light`: shadows are means over neighbouring pixels; not needed where there are none.
  Painter(const PictureScene& scene, const Camera& camera, const RenderOptions& options, bool smooth_light = true);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Lets shadows fall on the plane that far below the lowest point.
  void add_ground(std::span<const Vec3f> points, float below);

  /// Where the painter's coordinates lie in those of the options' curvature.
  void set_frame(const PictureFrame& frame);

  /// In tiles, in parallel; the picture does not depend on the number of threads.
  Image paint(Progress& progress) const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// Paints what of the scene the options show; the ground, if there is one, lies that far below the lowest point.
Image paint_scene(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                  const RenderOptions& options, bool smooth_light, std::span<const Vec3f> points, float below,
                  Progress& progress);

}  // namespace sansmesh::inline v1
