#include "sansmesh/csg/face_builder.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/csg/primitive_faces.h"

namespace sansmesh::inline v1 {
namespace {

/// The box of unbounded primitives, over that of the solid.
constexpr double kBeyond = 0.25;
/// Share of the error in each of two directions of curvature.
constexpr double kTwoWays = 0.7;

}  // namespace

FaceBuilder::FaceBuilder(double mesh_error, const Box3& region, const Vec3& origin)
    : build_(true), mesh_error_(mesh_error), region_(region), origin_(origin) {}

std::nullopt_t FaceBuilder::refuse(const char* what) {
  if (obstacle.empty()) obstacle = what;
  return std::nullopt;
}

std::uint32_t FaceBuilder::push(SolidFaces faces, std::shared_ptr<const TriangleMesh> mesh, const Similarity& map) {
  if (dot(cross(map.columns[0], map.columns[1]), map.columns[2]) < 0)
    for (Triangle& t : faces.triangles) std::swap(t[1], t[2]);
  if (build_) {  // equal parts are one
    std::uint64_t key = faces.triangles.size();
    for (const Vec3& v : faces.vertices)
      for (std::size_t k = 0; k < 3; ++k) key = scrambled(key ^ std::bit_cast<std::uint64_t>(v[k]));
    for (auto [known, end] = by_key_.equal_range(key); known != end; ++known)
      if (const SolidFaces& p = parts[known->second]; p.vertices == faces.vertices && p.triangles == faces.triangles)
        return expression.leaf(known->second);
    by_key_.emplace(key, static_cast<std::uint32_t>(parts.size()));
  }
  parts.push_back(std::move(faces));
  meshes.push_back(std::move(mesh));
  return expression.leaf(static_cast<std::uint32_t>(parts.size() - 1));
}

template <class Make>
std::uint32_t FaceBuilder::add(const Similarity& map, const Make& make) {
  SolidFaces faces;
  if (build_) {
    faces = make();
    for (Vec3& v : faces.vertices) v = map(v) - origin_;
  }
  return push(std::move(faces), nullptr, map);
}

template <class Make>
std::uint32_t FaceBuilder::add_curved(const Similarity& map, std::size_t sides, double count, const Make& make) {
  curved = true;
  curved_faces += sides < kMostSides ? count : 2 * kMostCurvedFaces;
  return add(map, [&] { return curved_faces > kMostCurvedFaces ? SolidFaces{} : make(); });
}

std::uint32_t FaceBuilder::mesh(std::shared_ptr<const TriangleMesh> mesh, bool overlaps, const Similarity& map) {
  SolidFaces faces;
  faces.overlaps = overlaps;
  if (build_) {
    const bool moved = map.rotates() || map.scale != 1 || map.translation != Vec3{};
    // Without a map, vertices relative to the common origin are exact.
    const Vec3 shift = mesh->origin - origin_;
    faces.triangles = mesh->triangles;
    faces.vertices.reserve(mesh->vertices.size());
    for (const Vec3f& v : mesh->vertices)
      faces.vertices.push_back(moved ? map(mesh->origin + Vec3(v)) - origin_ : Vec3(v) + shift);
  }
  return push(std::move(faces), std::move(mesh), map);
}

std::uint32_t FaceBuilder::ball(const Vec3& center, double radius, const Similarity& map) {
  const std::size_t n = edges_of_quarter(radius, error(map));
  return add_curved(map, n, 8.0 * static_cast<double>(n * n), [&] { return ball_faces(center, radius, n); });
}

std::uint32_t FaceBuilder::box(const Vec3& lower, const Vec3& upper, const Similarity& map) {
  return add(map, [&] { return box_faces(lower, upper); });
}

/// The ball around the region, in the coordinates of the primitive.
void FaceBuilder::reach(const Similarity& map, Vec3& center, double& radius) const {
  const Box3 box = with_margin(region_, 2 * kBeyond);
  center = map.back(box.center());
  radius = box.diagonal() / 2 / map.scale;
}

std::uint32_t FaceBuilder::half_space(const Vec3& normal, double offset, const Similarity& map) {
  unbounded = true;
  return add(map, [&] {
    Vec3 center;
    double radius = 0;
    reach(map, center, radius);
    return half_space_faces(normal, offset, center, radius);
  });
}

std::uint32_t FaceBuilder::cylinder(const Vec3& center, const Vec3& axis, double radius, const Similarity& map) {
  unbounded = true;
  const std::size_t n = sides_of_circle(radius, error(map));
  return add_curved(map, n, 4.0 * static_cast<double>(n), [&] {
    Vec3 middle;
    double far = 0;
    reach(map, middle, far);
    return frustum_faces(center + axis * dot(middle - center, axis), axis, radius, radius, far, n);
  });
}

std::uint32_t FaceBuilder::frustum(const Vec3& center, const Vec3& axis, double bottom, double top, double half_height,
                                   const Similarity& map) {
  const std::size_t n = sides_of_circle(std::max(bottom, top), error(map));
  return add_curved(map, n, 4.0 * static_cast<double>(n),
                    [&] { return frustum_faces(center, axis, bottom, top, half_height, n); });
}

std::uint32_t FaceBuilder::ring(const Vec3& center, const Vec3& axis, double ring, double tube, const Similarity& map) {
  const std::size_t m = sides_of_circle(ring + tube, kTwoWays * error(map)),
                    n = sides_of_circle(tube, kTwoWays * error(map));
  return add_curved(map, std::max(m, n), 2.0 * static_cast<double>(m * n),
                    [&] { return ring_faces(center, axis, ring, tube, m, n); });
}

std::uint32_t FaceBuilder::rod(const Vec3& from, const Vec3& to, double radius, const Similarity& map) {
  const std::size_t n = sides_of_circle(radius, kTwoWays * error(map));
  return add_curved(map, n, static_cast<double>(n * n), [&] { return rod_faces(from, to, radius, n); });
}

std::optional<std::uint32_t> FaceBuilder::combine(const std::vector<NodePtr>& members, double sign,
                                                  const Similarity& map) {
  std::vector<std::uint32_t> children;
  for (const NodePtr& m : members) {
    const auto node = m->faces(*this, map);
    if (!node) return std::nullopt;
    children.push_back(*node);
  }
  return expression.combine(sign > 0 ? BooleanExpression::Kind::any : BooleanExpression::Kind::all,
                            std::move(children));
}

FaceSurvey survey_faces(const SolidNode& root) {
  FaceBuilder builder;
  if (!root.faces(builder, {}) && builder.obstacle.empty()) builder.obstacle = "a function";
  if (builder.obstacle.empty() && builder.parts.empty()) builder.obstacle = "nothing";
  return {builder.obstacle, builder.curved,
          std::any_of(builder.meshes.begin(), builder.meshes.end(), [](const auto& m) { return m != nullptr; }),
          builder.parts.size()};
}

SolidOfFaces faces_of(const SolidNode& root, double mesh_error, const Box3& region) {
  FaceBuilder look;
  root.faces(look, {});
  Vec3 origin;
  for (const auto& m : look.meshes)
    if (m) {
      origin = m->origin;
      break;
    }
  FaceBuilder builder(mesh_error, region, origin);
  const auto whole = root.faces(builder, {});
  if (builder.unbounded) {
    const Box3 end = with_margin(region, kBeyond);
    const std::uint32_t inside = builder.box(end.lower, end.upper, {});
    builder.expression.combine(BooleanExpression::Kind::all, {*whole, inside});
  }
  return {std::move(builder.expression),
          std::move(builder.parts),
          std::move(builder.meshes),
          origin,
          builder.curved,
          builder.curved_faces > FaceBuilder::kMostCurvedFaces};
}

}  // namespace sansmesh::inline v1
