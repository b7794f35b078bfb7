// Where a picture is taken from.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/render_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A place of a picture: x from −1 (left) to 1, y from −1 (bottom) to 1; `depth` is the distance along the camera's
/// axis.
struct PicturePlace {
  float x = 0, y = 0, depth = 0;
};

/// Pinhole camera. `right`, `up` and `backward` are orthonormal; the picture plane at distance 1 reaches from
/// −half_width to half_width and from −half_height to half_height. With `parallel`, orthographic: rays are parallel and
/// begin on that plane, which then lies at the position itself.
struct Camera {
  Vec3f position, right, up, backward;
  float half_width = 1, half_height = 1;
  bool parallel = false;

  /// Unit direction of the ray through a place of the picture.
  Vec3f direction(float x, float y) const {
    if (parallel) return -backward;
    return normalized(x * half_width * right + y * half_height * up - backward);
  }
  /// Where that ray begins.
  Vec3f origin(float x, float y) const {
    return parallel ? position + x * half_width * right + y * half_height * up : position;
  }
  /// What lies at that depth is seen smaller by this.
  float shrink(float depth) const { return parallel ? 1 : depth; }
  /// Where a point is seen; its depth is not positive behind the camera, and then x and y mean nothing.
  PicturePlace seen(const Vec3f& point) const {
    const Vec3f d = point - position;
    const float depth = -dot(d, backward), scale = shrink(depth);
    return {dot(d, right) / (scale * half_width), dot(d, up) / (scale * half_height), depth};
  }
};

/// The camera nearest to the points, each a ball of the given radius, from which all of them are seen with `margin` (a
/// share of the picture's half) left on each side. `field_of_view`: angle in degrees over the shorter side; `aspect`:
/// width / height. Points must be finite. `parallel`: the orthographic one, whose picture is as small as it can be.
Camera frame_camera(std::span<const Vec3f> points, const ViewDirection& view, UpAxis up, double field_of_view,
                    double aspect, double margin, double radius = 0, bool parallel = false);

/// Moves the camera beside, without turning it, so that the place is in the middle of the picture; what lies at the
/// place's depth keeps its size.
void look_at(Camera& camera, const Vec3f& place);
/// So many times as large: a narrower field, from where the camera is.
void zoom(Camera& camera, double factor);
/// The zoom at which a ball around what is in the middle of the picture, at that depth, fills it up to `margin`.
double zoom_on_ball(const Camera& camera, double depth, double radius, double margin);

}  // namespace sansmesh::inline v1
