// Where a picture is taken from.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"

namespace sansmesh {

/// The axis that points up in the picture. The front looks from +z where y is up and from −y where z is up.
enum class UpAxis { y, z };

/// A direction to look from, in degrees: azimuth 0 is the front, 90 the right side (from +x); elevation 90 is above.
struct ViewDirection {
  double azimuth = 35;
  double elevation = 20;
};

/// front, back, left, right, top, bottom or iso. Throws ArgumentError naming the view and the choices.
ViewDirection named_view(const std::string& name);

/// The direction that looks straight at a box that is a single layer, 50 times as wide and high as thick at least;
/// nothing of others.
std::optional<ViewDirection> view_of_layer(const Box3& box, UpAxis up);

/// `frames` views (at least 1) evenly around the up axis, the first of them `view`.
std::vector<ViewDirection> turntable(const ViewDirection& view, int frames);

/// Pinhole camera. `right`, `up` and `backward` are orthonormal; the picture plane at distance 1 reaches from
/// −half_width to half_width and from −half_height to half_height.
struct Camera {
  Vec3f position, right, up, backward;
  float half_width = 1, half_height = 1;

  /// Unit direction through a place of the picture: x from −1 (left) to 1, y from −1 (bottom) to 1.
  Vec3f direction(float x, float y) const {
    return normalized(x * half_width * right + y * half_height * up - backward);
  }
};

/// The camera nearest to the points, each a ball of the given radius, from which all of them are seen with `margin` (a
/// share of the picture's half) left on each side. `field_of_view`: angle in degrees over the shorter side; `aspect`:
/// width / height. Points must be finite.
Camera frame_camera(std::span<const Vec3f> points, const ViewDirection& view, UpAxis up, double field_of_view,
                    double aspect, double margin, double radius = 0);

}  // namespace sansmesh
