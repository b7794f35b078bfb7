#include "sansmesh/render/scene/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kChunk = 65536;

/// Largest values of x − a z, −x − a z, y − b z, −y − b z and z over the points in camera axes.
using Reach = std::array<double, 5>;

}  // namespace

ViewDirection named_view(const std::string& name) {
  static const std::pair<const char*, ViewDirection> views[] = {
      {"front", {0, 0}}, {"back", {180, 0}},   {"left", {-90, 0}}, {"right", {90, 0}},
      {"top", {0, 90}},  {"bottom", {0, -90}}, {"iso", {35, 20}},
  };
  for (const auto& [known, view] : views)
    if (name == known) return view;
  throw ArgumentError("unknown view '" + name + "': front, back, left, right, top, bottom or iso");
}

std::optional<ViewDirection> view_of_layer(const Box3& box, UpAxis up) {
  constexpr double kThin = 0.02;
  const Vec3 size = box.size();
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(size[k] < kThin * std::min(size[(k + 1) % 3], size[(k + 2) % 3]))) continue;
    const std::size_t upright = up == UpAxis::y ? 1 : 2;
    return named_view(k == 0 ? "right" : k == upright ? "top" : "front");
  }
  return std::nullopt;
}

std::vector<ViewDirection> turntable(const ViewDirection& view, int frames) {
  if (frames < 1) throw ArgumentError("`frames` must be at least 1, not " + std::to_string(frames));
  std::vector<ViewDirection> views;
  views.reserve(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i)
    views.push_back({i == 0 ? view.azimuth : std::remainder(view.azimuth + 360.0 * i / frames, 360.0), view.elevation});
  return views;
}

ViewDirection view_from(const Vec3& direction, UpAxis up) {
  const Vec3 d = normalized(up == UpAxis::z ? Vec3{direction.x, direction.z, -direction.y} : direction);
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double level = std::hypot(d.x, d.z);
  return {level > 0 ? std::atan2(d.x, d.z) * kDegrees : 0, std::atan2(d.y, level) * kDegrees};
}

namespace {

/// A camera with the axes of that view, at the origin.
Camera turned_camera(const ViewDirection& view, UpAxis up, double field_of_view, double aspect) {
  const double azimuth = view.azimuth * std::numbers::pi / 180, elevation = view.elevation * std::numbers::pi / 180;
  // In a frame with y up; `right` depends only on the azimuth, so that views from straight above are defined.
  Vec3 right{std::cos(azimuth), 0, -std::sin(azimuth)};
  Vec3 backward{std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
  if (up == UpAxis::z) {
    right = {right.x, -right.z, right.y};
    backward = {backward.x, -backward.z, backward.y};
  }
  Camera camera;
  camera.right = Vec3f(right);
  camera.backward = Vec3f(backward);
  camera.up = Vec3f(cross(backward, right));

  const double half = std::tan(field_of_view * std::numbers::pi / 360);
  camera.half_width = static_cast<float>(aspect >= 1 ? half * aspect : half);
  camera.half_height = static_cast<float>(aspect >= 1 ? half : half / aspect);
  return camera;
}

/// Largest values of x − a z, −x − a z, y − b z, −y − b z and z over the points.
Reach reach_of(std::span<const Vec3f> points, const Camera& camera, double a, double b) {
  const Vec3 right(camera.right), up(camera.up), backward(camera.backward);
  constexpr double kLowest = std::numeric_limits<double>::lowest();
  return parallel_reduce(
      points.size(), kChunk, Reach{kLowest, kLowest, kLowest, kLowest, kLowest},
      [&](std::size_t first, std::size_t last) {
        Reach part{kLowest, kLowest, kLowest, kLowest, kLowest};
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 p(points[i]);
          const double x = dot(p, right), y = dot(p, up), z = dot(p, backward);
          const Reach own{x + a * z, -x + a * z, y + b * z, -y + b * z, z};
          for (std::size_t k = 0; k < own.size(); ++k) part[k] = std::max(part[k], own[k]);
        }
        return part;
      },
      [](Reach x, const Reach& y) {
        for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::max(x[k], y[k]);
        return x;
      });
}

}  // namespace

Camera frame_camera(std::span<const Vec3f> points, const ViewDirection& view, UpAxis up, double field_of_view,
                    double aspect, double margin, double radius, bool parallel) {
  Camera camera = turned_camera(view, up, field_of_view, aspect);
  camera.parallel = parallel;
  if (points.empty()) return camera;
  const Vec3 right(camera.right), above(camera.up), backward(camera.backward);
  if (parallel) {
    const Reach reach = reach_of(points, camera, 0, 0);
    const double across = (reach[0] + reach[1]) / 2 + radius, along = (reach[2] + reach[3]) / 2 + radius;
    const double half_height = std::max({across / aspect, along, 1e-6}) / (1 - margin);
    camera.half_height = static_cast<float>(half_height);
    camera.half_width = static_cast<float>(half_height * aspect);
    // In front of everything, at a distance of the subject's size: other content may extend beyond the points.
    camera.position = Vec3f(right * ((reach[0] - reach[1]) / 2) + above * ((reach[2] - reach[3]) / 2) +
                            backward * (reach[4] + radius + 2 * half_height));
    return camera;
  }
  // From a camera at (cx, cy, d) a point is visible if |x − cx| <= a (d − z) and |y − cy| <= b (d − z). The sides of
  // the pyramid are planes, so the extreme point against each of them decides.
  const double half = std::tan(field_of_view * std::numbers::pi / 360);
  const double a = (aspect >= 1 ? half * aspect : half) * (1 - margin);
  const double b = (aspect >= 1 ? half : half / aspect) * (1 - margin);
  const Reach reach = reach_of(points, camera, a, b);
  // A ball extends radius · √(1 + a²) farther against a plane of slope a.
  const double across = (reach[0] + reach[1]) / 2 + radius * std::sqrt(1 + a * a);
  const double along = (reach[2] + reach[3]) / 2 + radius * std::sqrt(1 + b * b);
  const double distance = std::max({across / a, along / b, (reach[4] + radius) + 1e-3});
  camera.position =
      Vec3f(right * ((reach[0] - reach[1]) / 2) + above * ((reach[2] - reach[3]) / 2) + backward * distance);
  return camera;
}

void look_at(Camera& camera, const Vec3f& point) {
  const Vec3f d = point - camera.position;
  camera.position += dot(d, camera.right) * camera.right + dot(d, camera.up) * camera.up;
  // Moves the camera back if the point is behind it.
  const float depth = -dot(d, camera.backward), least = 0.01f;
  if (depth < least) camera.position += (least - depth) * camera.backward;
}

void zoom(Camera& camera, double factor) {
  camera.half_width /= static_cast<float>(factor);
  camera.half_height /= static_cast<float>(factor);
}

double zoom_on_ball(const Camera& camera, double depth, double radius, double margin) {
  const double half = static_cast<double>(std::min(camera.half_width, camera.half_height)) * (1 - margin);
  // The silhouette of the ball has a slope of r/√(d² − r²).
  const double slope = camera.parallel ? radius : radius / std::sqrt(std::max(depth * depth - radius * radius, 1e-12));
  return half / slope;
}

}  // namespace sansmesh::inline v1
