// Interface of scenes for the painter.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// Frame of points with this box. Throws DataError if it is empty or a single point.
PictureFrame frame_of_points(const Box3& box);

/// Intersection of an eye ray.
struct SurfacePoint {
  float distance = 0;  ///< from the ray's origin to the surface itself; the depth order of points
  Vec3f position;      ///< just off the surface on the viewer's side: origin of secondary rays
  Vec3f normal;        ///< for shading, unit, on the viewer's side
  Vec3f color;         ///< share of light reflected, linear
  float gloss = 1;     ///< strength of highlights
  Vec3f beyond{};      ///< light from mirrors and clear bodies, linear; added to the surface's own
  float opacity = 1;   ///< blocked share of the light from behind; only used in layers()
  Vec3f vector{};      ///< flow vector at the point; 0 without flow
  float cover = 1;     ///< share of the ray's footprint that the surface covers; only used in closest()
};

/// Eye rays; neighbours in the picture are adjacent. Sizes must agree.
struct EyeRays {
  std::span<const Vec3f> origins;     ///< one common origin, or one per ray
  std::span<const Vec3f> directions;  ///< unit vectors
  /// Range of distances per ray; empty: 0 and infinity.
  std::span<const float> near = {}, far = {};

  std::size_t size() const { return directions.size(); }
  const Vec3f& origin(std::size_t i) const { return origins[origins.size() == 1 ? 0 : i]; }
  Vec3f at(std::size_t i, float distance) const { return origin(i) + distance * directions[i]; }
};

/// Rays of a camera through points of its picture.
class CameraRays {
 public:
  explicit CameraRays(const Camera& camera) : camera_(camera) {}
  void clear() { origins_.clear(), directions_.clear(); }
  /// x from −1 (left) to 1, y from −1 (bottom) to 1.
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

/// A scene that answers batches of rays. Thread-safe. Sizes must agree.
class PictureScene {
 public:
  virtual ~PictureScene() = default;
  /// The first point of the surface along each ray.
  virtual void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const = 0;
  /// Replaces both vectors by all visible points along the rays, front to back: points[first[i]] to points[first[i +
  /// 1]] for ray i. Opaque scenes return the first point.
  virtual void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const;
  /// 1 for each ray that the surface blocks, else 0.
  virtual void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const = 0;
};

/// A point of a ray, given by its index.
struct RayPoint {
  std::uint32_t ray;
  SurfacePoint point;
};
/// Result of PictureScene::layers() from points in any order of rays, but those of one ray front to back.
void sort_into_layers(std::vector<RayPoint>& found, std::size_t rays, std::vector<std::size_t>& first,
                      std::vector<SurfacePoint>& points);

/// Opacity of a sheet at a cosine between ray and normal, where `opacity` is its value at cosine 1: an oblique ray has
/// a longer path through it.
float sheet_opacity(float opacity, float cosine);
/// Least transmitted light that is traced further, and the largest number of sheets.
constexpr float kLeastThrough = 0.002f;
constexpr int kMostSheets = 256;

/// The part of a scene inside a box (in the scene's coordinates). The scene must outlive it.
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
