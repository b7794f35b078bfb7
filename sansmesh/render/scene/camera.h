// Cameras of pictures.
#pragma once

#include <span>

#include "sansmesh/box.h"
#include "sansmesh/render_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Projected point: x from −1 (left) to 1, y from −1 (bottom) to 1; `depth` is the distance along the camera's axis.
struct ProjectedPoint {
  float x = 0, y = 0, depth = 0;
};

/// Pinhole camera. `right`, `up` and `backward` are orthonormal; the picture plane at distance 1 reaches from
/// −half_width to half_width and from −half_height to half_height. With `parallel`, orthographic: rays are parallel and
/// begin on that plane, which then contains `position`.
struct Camera {
  Vec3f position, right, up, backward;
  float half_width = 1, half_height = 1;
  bool parallel = false;

  /// Unit direction of the ray through a point of the picture.
  Vec3f direction(float x, float y) const {
    if (parallel) return -backward;
    return normalized(x * half_width * right + y * half_height * up - backward);
  }
  /// Origin of that ray.
  Vec3f origin(float x, float y) const {
    return parallel ? position + x * half_width * right + y * half_height * up : position;
  }
  /// Factor by which objects at that depth appear smaller.
  float shrink(float depth) const { return parallel ? 1 : depth; }
  /// Projection of a point. Behind the camera the depth is not positive, and x and y are undefined.
  ProjectedPoint project(const Vec3f& point) const {
    const Vec3f d = point - position;
    const float depth = -dot(d, backward), scale = shrink(depth);
    return {dot(d, right) / (scale * half_width), dot(d, up) / (scale * half_height), depth};
  }
};

/// The camera closest to the points (finite, each a ball of the given radius) that sees all of them with `margin` (a
/// share of the picture's half) on each side. `field_of_view`: angle in degrees over the shorter side; `aspect`: width
/// / height. `parallel`: the orthographic camera with the smallest picture.
Camera frame_camera(std::span<const Vec3f> points, const ViewDirection& view, UpAxis up, double field_of_view,
                    double aspect, double margin, double radius = 0, bool parallel = false);

/// Translates the camera so that `point` is at the centre of the picture; objects at its depth keep their size.
void look_at(Camera& camera, const Vec3f& point);
/// Narrows the field of view so that objects appear larger by `factor`.
void zoom(Camera& camera, double factor);
/// Zoom factor so that a ball around the centre of the picture at that depth fills the picture up to `margin`.
double zoom_on_ball(const Camera& camera, double depth, double radius, double margin);

}  // namespace sansmesh::inline v1
