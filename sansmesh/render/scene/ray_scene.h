// Rays against triangles, balls and discs (Embree).
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
  Vec3f normal;                 ///< geometric, unit, of the side that the triangle's order of corners defines
  std::uint32_t primitive = 0;  ///< triangle or point
  float u = 0, v = 0;           ///< weights of the triangle's second and third corner
};

/// A place where a ray goes through a surface.
struct RayCrossing {
  float distance = 0;
  std::uint32_t primitive = 0;
  bool entering = false;  ///< against the side that the triangle's order of corners defines
};

/// Built once, then asked from any thread. Directions must be unit vectors.
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
  /// The same for rays from one place, or from one each, each from a distance on (`beyond`; empty: 0) and up to another
  /// (`until`; empty: infinity). Neighbours in the picture in neighbouring slots go fastest. Sizes must agree.
  void closest(std::span<const Vec3f> origins, std::span<const Vec3f> directions, std::span<const float> beyond,
               std::span<const float> until, std::span<std::optional<RayHit>> hits) const;
  /// All of them up to a distance, by distance, in place of what `found` held. Where a ray meets an edge or a corner,
  /// each triangle there may count.
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
