// Renders a scene to pixels with soft light.
#pragma once

#include <memory>
#include <span>

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Free share of the picture's half around the subject.
constexpr double kPictureMargin = 0.13;

/// Camera of a picture of these points (finite, in coordinates of `frame`), each a ball of the given radius, with
/// kPictureMargin. Throws ArgumentError if no point is near the box in the options.
Camera picture_camera(std::span<const Vec3f> points, const PictureFrame& frame, const RenderOptions& options,
                      float radius = 0);

/// The subject's box should have centre 0 and a diagonal of about 1. All arguments must outlive the painter.
class Painter {
 public:
  /// `smooth_light`: shadows are averaged over neighbouring pixels; not needed without shadows.
  Painter(const PictureScene& scene, const Camera& camera, const RenderOptions& options, bool smooth_light = true);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// Adds a ground plane for shadows, `below` under the lowest point.
  void add_ground(std::span<const Vec3f> points, float below);

  /// Frame of the painter's coordinates in those of the options' curvature.
  void set_frame(const PictureFrame& frame);

  /// Paints tiles in parallel; the picture does not depend on the number of threads.
  Image paint(Progress& progress) const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// Paints the visible part of the scene. A ground plane, if the options have one, is `below` under the lowest point.
Image paint_scene(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                  const RenderOptions& options, bool smooth_light, std::span<const Vec3f> points, float below,
                  Progress& progress);

}  // namespace sansmesh::inline v1
