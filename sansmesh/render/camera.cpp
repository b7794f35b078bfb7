#include "sansmesh/render/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
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

Camera frame_camera(std::span<const Vec3f> points, const ViewDirection& view, UpAxis up, double field_of_view,
                    double aspect, double margin, double radius) {
  const double azimuth = view.azimuth * std::numbers::pi / 180, elevation = view.elevation * std::numbers::pi / 180;
  // In a frame with y up; right follows from the azimuth alone, so that nothing is undefined straight above.
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
  const double half_width = aspect >= 1 ? half * aspect : half, half_height = aspect >= 1 ? half : half / aspect;
  camera.half_width = static_cast<float>(half_width);
  camera.half_height = static_cast<float>(half_height);

  // From a camera at (cx, cy, d) a point is seen if |x − cx| <= a (d − z) and |y − cy| <= b (d − z): the sides of the
  // pyramid are planes, so the farthest point against each of them decides.
  const double a = half_width * (1 - margin), b = half_height * (1 - margin);
  constexpr double kLowest = std::numeric_limits<double>::lowest();
  const Reach reach = parallel_reduce(
      points.size(), kChunk, Reach{kLowest, kLowest, kLowest, kLowest, kLowest},
      [&](std::size_t first, std::size_t last) {
        Reach part{kLowest, kLowest, kLowest, kLowest, kLowest};
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 p(points[i]);
          const double x = dot(p, right), y = dot(p, Vec3(camera.up)), z = dot(p, backward);
          const Reach own{x + a * z, -x + a * z, y + b * z, -y + b * z, z};
          for (std::size_t k = 0; k < own.size(); ++k) part[k] = std::max(part[k], own[k]);
        }
        return part;
      },
      [](Reach x, const Reach& y) {
        for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::max(x[k], y[k]);
        return x;
      });
  if (points.empty()) return camera;
  // A ball reaches radius · √(1 + a²) farther against a plane of slope a.
  const double across = (reach[0] + reach[1]) / 2 + radius * std::sqrt(1 + a * a);
  const double along = (reach[2] + reach[3]) / 2 + radius * std::sqrt(1 + b * b);
  const double distance = std::max({across / a, along / b, (reach[4] + radius) + 1e-3});
  camera.position =
      Vec3f(right * ((reach[0] - reach[1]) / 2) + Vec3(camera.up) * ((reach[2] - reach[3]) / 2) + backward * distance);
  return camera;
}

}  // namespace sansmesh
