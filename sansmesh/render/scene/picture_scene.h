// What a painter asks of whatever it paints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The painter's coordinates: (x − center) / size.
struct PictureFrame {
  Vec3 center;
  double size = 1;
  Vec3f to_picture(const Vec3& x) const { return Vec3f((x - center) / size); }
  Vec3f to_surface(const Vec3f& x) const { return Vec3f(Vec3(x) * size + center); }
};

/// Where a ray from the eye ends.
struct SurfacePoint {
  float distance = 0;  ///< from where the ray begins to the surface itself: what is in front of what goes by it
  Vec3f position;      ///< just off the surface on the viewer's side: further rays start here
  Vec3f normal;        ///< for shading, unit, on the viewer's side
  Vec3f color;         ///< share of light reflected, linear
  float gloss = 1;     ///< strength of highlights
  Vec3f beyond{};      ///< light that mirrors and clear bodies send, linear; comes on top
  float opacity = 1;   ///< share of the light from behind that is kept back; counts in layers() only
  Vec3f vector{};      ///< of a flow there; 0 where there is none
  float cover = 1;     ///< of what the ray stands for, the share that the surface covers; counts in closest() only
};

/// Rays from the eye, neighbours in the picture in neighbouring slots. Sizes must agree.
struct EyeRays {
  std::span<const Vec3f> origins;     ///< one for all, or one for each
  std::span<const Vec3f> directions;  ///< unit vectors
  /// Only what is at least as far as this counts, and no farther than that; empty: 0 and infinity.
  std::span<const float> near = {}, far = {};

  std::size_t size() const { return directions.size(); }
  const Vec3f& origin(std::size_t i) const { return origins[origins.size() == 1 ? 0 : i]; }
  Vec3f at(std::size_t i, float distance) const { return origin(i) + distance * directions[i]; }
};

/// Rays of a camera through places of its picture.
class CameraRays {
 public:
  explicit CameraRays(const Camera& camera) : camera_(camera) {}
  void clear() { origins_.clear(), directions_.clear(); }
  /// x from −1 (left) to 1, y from −1 (bottom) to 1
  void add(float x, float y) {
    if (camera_.parallel || origins_.empty()) origins_.push_back(camera_.origin(x, y));
    directions_.push_back(camera_.direction(x, y));
  }
  std::size_t size() const { return directions_.size(); }
  EyeRays rays() const { return {origins_, directions_}; }

 private:
  Camera camera_;
  std::vector<Vec3f> origins_, directions_;
};

struct ShadowRay {
  Vec3f origin, direction;
  float length, near = 0;
};

/// Safe from several threads. Rays come in batches. Sizes must agree.
class PictureScene {
 public:
  virtual ~PictureScene() = default;
  /// The first point of the surface along the rays.
  virtual void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const = 0;
  /// All that is to be seen along the rays, front to back: of ray i points[first[i]] up to points[first[i + 1]], in
  /// place of what both held. Of scenes that are opaque the first point.
  virtual void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const;
  /// 1 where the surface is in the way, else 0.
  virtual void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const = 0;
};

/// Opacity of a sheet that has `opacity` seen at right angles, at a cosine between ray and normal: a ray at an angle
/// has a longer way through it.
float sheet_opacity(float opacity, float cosine);
/// Light from behind that is worth looking for, and so many sheets at most.
constexpr float kLeastThrough = 0.002f;
constexpr int kMostSheets = 256;

/// What of a scene lies in a box (in the scene's coordinates). What is passed must outlive it.
class ClippedScene final : public PictureScene {
 public:
  ClippedScene(const PictureScene& scene, const Box3f& box) : scene_(scene), box_(box) {}
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override;
  void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const override;
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override;

 private:
  const PictureScene& scene_;
  Box3f box_;
};

}  // namespace sansmesh::inline v1
