#include "sansmesh/render/annotate/crest_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/field/curvature_field.h"

namespace sansmesh::inline v1 {
namespace {

/// Pixels to each side of a line that must be lower: enough for differences above rounding, few enough for fine lines.
constexpr float kCrestReach = 3;
/// Least decrease of a crest over that distance, relative to its height: flatter ones are the noise of cylinders.
constexpr float kLeastFall = 0.006f;
/// Lines reach full strength at this factor of the threshold.
constexpr float kFullStrength = 1.7f;
/// Least ratio of the principal curvatures' sizes: below it the direction is undefined.
constexpr float kOneSided = 1.15f;
/// Suggestive contours: least depth of the cosine's valley, and range of the cosine, away from silhouettes and frontal
/// views.
constexpr float kLeastDip = 0.012f, kLeastFacing = 0.08f, kMostFacing = 0.65f;
/// Neighbouring pixels are on different sheets if their tangent planes are separated by more than this many times their
/// distance.
constexpr float kTangentGap = 3;

struct Texel {
  bool hit = false;
  float distance = 0, facing = 0;
  Vec3f position, normal;
  PrincipalCurvatures curvature;
};

class CrestInk {
 public:
  CrestInk(const PictureScene& scene, const Camera& camera, const PictureFrame& frame, const RenderOptions& options)
      : camera_(camera),
        options_(options),
        step_(2 * camera.half_height / static_cast<float>(options.view.height)),
        map_(options.view.width, options.view.height) {
    parallel_for(0, static_cast<std::size_t>(options.view.height), 4,
                 [&](std::size_t row) { look(scene, frame, static_cast<int>(row)); });
  }

  float at(int x, int y) const {
    const Texel& here = map_.at(x, y);
    if (!here.hit) return 0;
    float ink = suggestive(x, y, here);
    const PrincipalCurvatures& b = here.curvature;
    if (!b.defined) return ink;
    if (b.k1 > kOneSided * std::abs(b.k2))
      ink = std::max(ink, crest(x, y, here, b.k1, b.direction1, [](const Texel& t) { return t.curvature.k1; }));
    if (-b.k2 > kOneSided * std::abs(b.k1))
      ink = std::max(ink, crest(x, y, here, -b.k2, b.direction2, [](const Texel& t) { return -t.curvature.k2; }));
    return ink;
  }

 private:
  void look(const PictureScene& scene, const PictureFrame& frame, int y) {
    CameraRays rays(camera_);
    for (int x = 0; x < map_.width; ++x)
      rays.add((2 * static_cast<float>(x) + 1) / static_cast<float>(map_.width) - 1,
               1 - (2 * static_cast<float>(y) + 1) / static_cast<float>(map_.height));
    std::vector<std::optional<SurfacePoint>> points(rays.size());
    const EyeRays eye = rays.rays();
    scene.closest(eye, points);
    std::vector<Vec3> positions;
    std::vector<Vec3f> normals;
    std::vector<int> columns;
    for (int x = 0; x < map_.width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      if (!points[i] || points[i]->cover < 0.5f) continue;
      Texel& t = map_.at(x, y);
      t = {true,
           points[i]->distance,
           -dot(points[i]->normal, eye.directions[i]),
           eye.at(i, points[i]->distance),
           points[i]->normal,
           {}};
      positions.push_back(Vec3(t.position) * frame.size + frame.center);
      normals.push_back(t.normal);
      columns.push_back(x);
    }
    if (options_.look.curvature == nullptr || positions.empty()) return;
    std::vector<PrincipalCurvatures> curvatures(positions.size());
    options_.look.curvature->evaluate(positions, normals, curvatures);
    const auto size = static_cast<float>(frame.size);
    for (std::size_t k = 0; k < curvatures.size(); ++k) {
      PrincipalCurvatures& b = map_.at(columns[k], y).curvature;
      b = curvatures[k];
      b.k1 *= size, b.k2 *= size;  // relative to the picture's diagonal
    }
  }

  /// Interpolates between pixels; empty if one of the four is on another sheet.
  template <class Value>
  std::optional<float> between(const Texel& here, float x, float y, const Value& value) const {
    const float left = std::floor(x), top = std::floor(y);
    const int u = index_in<int>(left, -1, map_.width), v = index_in<int>(top, -1, map_.height);
    if (u < 0 || v < 0 || u + 1 >= map_.width || v + 1 >= map_.height) return std::nullopt;
    const float fx = x - left, fy = y - top, apart = kTangentGap * kCrestReach * footprint(here);
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
      const Texel& t = map_.at(u + k % 2, v + k / 2);
      if (!t.hit) return std::nullopt;
      const Vec3f d = t.position - here.position;
      if (std::min(std::abs(dot(d, here.normal)), std::abs(dot(d, t.normal))) > apart) return std::nullopt;
      sum += (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy) * value(t);
    }
    return sum;
  }

  float footprint(const Texel& t) const { return step_ * (camera_.parallel ? 1 : t.distance); }

  /// Maximum of a value along a direction of the picture (in pixels, y down), near a pixel.
  struct Top {
    float away, fall;  // pixels along the direction; mean decrease to both sides
  };
  template <class Value>
  std::optional<Top> top(int x, int y, const Texel& here, float dx, float dy, const Value& value) const {
    const float length = std::hypot(dx, dy);
    if (!(length > 0)) return std::nullopt;
    const float sx = kCrestReach * dx / length, sy = kCrestReach * dy / length;
    const auto px = static_cast<float>(x), py = static_cast<float>(y);
    const std::optional<float> before = between(here, px - sx, py - sy, value),
                               after = between(here, px + sx, py + sy, value);
    if (!before || !after) return std::nullopt;
    const float fall = value(here) - 0.5f * (*before + *after);
    if (!(fall > 0)) return std::nullopt;
    return Top{kCrestReach * 0.25f * (*after - *before) / fall, fall};
  }

  float line(float away) const {
    return std::clamp(0.5f * static_cast<float>(options_.look.line_width) + 0.5f - std::abs(away), 0.0f, 1.0f);
  }

  template <class Value>
  float crest(int x, int y, const Texel& here, float height, const Vec3f& along, const Value& value) const {
    const auto least = static_cast<float>(options_.look.line_strength);
    const float strength = std::clamp((height / least - 1) / (kFullStrength - 1), 0.0f, 1.0f);
    if (!(strength > 0)) return 0;
    // Projection of the direction, from a short step along it.
    const float ahead = footprint(here);
    const ProjectedPoint from = camera_.project(here.position), to = camera_.project(here.position + ahead * along);
    const float dx = (to.x - from.x) * static_cast<float>(map_.width),
                dy = (from.y - to.y) * static_cast<float>(map_.height);
    const auto found = top(x, y, here, dx, dy, [&](const Texel& t) { return t.curvature.defined ? value(t) : 0.0f; });
    if (!found || found->fall < kLeastFall * height) return 0;
    return strength * line(found->away);
  }

  float suggestive(int x, int y, const Texel& here) const {
    if (here.facing < kLeastFacing || here.facing > kMostFacing) return 0;
    const float dx = dot(here.normal, camera_.right), dy = -dot(here.normal, camera_.up);
    const auto found = top(x, y, here, dx, dy, [](const Texel& t) { return -t.facing; });
    if (!found || found->fall < kLeastDip) return 0;
    return std::min(1.0f, found->fall / kLeastDip - 1) * line(found->away);
  }

  const Camera& camera_;
  const RenderOptions& options_;
  float step_;  // width of a pixel at distance 1, or of parallel rays at any distance
  PixelMap<Texel> map_;
};

}  // namespace

PixelMap<float> crest_ink(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                          const RenderOptions& options) {
  const CrestInk crests(scene, camera, frame, options);
  PixelMap<float> ink(options.view.width, options.view.height);
  parallel_for(0, static_cast<std::size_t>(options.view.height), 4, [&](std::size_t y) {
    for (int x = 0; x < options.view.width; ++x) ink.at(x, static_cast<int>(y)) = crests.at(x, static_cast<int>(y));
  });
  return ink;
}

}  // namespace sansmesh::inline v1
