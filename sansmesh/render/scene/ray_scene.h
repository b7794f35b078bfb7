// Ray casting on triangles, balls and discs (Embree).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct RayHit {
  float distance = 0;           ///< along the ray's direction
  Vec3f normal;                 ///< geometric unit normal, oriented by the triangle's order of corners
  std::uint32_t primitive = 0;  ///< triangle or point
  float u = 0, v = 0;           ///< barycentric weights of the triangle's second and third corner
};

/// Crossing of a ray through a surface.
struct RayCrossing {
  float distance = 0;
  std::uint32_t primitive = 0;
  bool entering = false;  ///< from the side of the normal, which follows from the triangle's order of corners
};

/// Built once; queries are thread-safe. Directions must be unit vectors.
class RayScene {
 public:
  /// Corners must exist and be finite.
  static RayScene triangles(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);
  static RayScene balls(std::span<const Vec3f> centers, float radius);
  static RayScene balls(std::span<const Vec3f> centers, std::span<const float> radii);
  static RayScene discs(std::span<const Vec3f> centers, std::span<const Vec3f> normals, float radius);
  static RayScene discs(std::span<const Vec3f> centers, std::span<const Vec3f> normals, std::span<const float> radii);

  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  std::optional<RayHit> closest(const Vec3f& origin, const Vec3f& direction) const;
  /// The same for many rays with a common origin or one per ray, within distances from `beyond` (empty: 0) to `until`
  /// (empty: infinity). Fastest if neighbouring rays are adjacent. Sizes must agree.
  void closest(std::span<const Vec3f> origins, std::span<const Vec3f> directions, std::span<const float> beyond,
               std::span<const float> until, std::span<std::optional<RayHit>> hits) const;
  /// Replaces `found` by all crossings up to a distance, sorted by distance. At an edge or a corner each adjacent
  /// triangle may count.
  void crossings(const Vec3f& origin, const Vec3f& direction, float length, std::vector<RayCrossing>& found) const;
  bool blocked(const Vec3f& origin, const Vec3f& direction, float length, float near = 0) const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  template <class Radius>
  static std::unique_ptr<State> make_balls(std::span<const Vec3f> centers, std::span<const Vec3f> normals,
                                           const Radius& radius);
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
