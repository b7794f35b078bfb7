#include "sansmesh/render/scene/mesh_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/image.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/render/scene/corner_normals.h"
#include "sansmesh/render/scene/lighting.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kOffset = 2e-4f;          // share of the diagonal: hides the rounding of floats
constexpr float kDiscOverSpacing = 1.3f;  // discs at random positions leave exp(−π 1.3²) = 0.5 % uncovered
constexpr float kBallOverSpacing = 0.8f;
constexpr float kBehind = 1e-5f;  // share of the diagonal: less would find the same triangle again

/// Removes undrawable elements; keeps the order of the rest.
Subject drawable(const TriangleMesh& mesh, std::span<const Vec3f> vectors) {
  const std::size_t count = mesh.vertices.size();
  std::vector<char> kept(count, mesh.triangles.empty());
  const auto finite = [&](std::uint32_t v) { return v < count && is_finite(mesh.vertices[v]); };
  const auto good = [&](const Triangle& t) { return finite(t[0]) && finite(t[1]) && finite(t[2]); };
  for (const Triangle& t : mesh.triangles)
    if (good(t)) kept[t[0]] = kept[t[1]] = kept[t[2]] = 1;

  Subject subject;
  TriangleMesh& result = subject.mesh;
  std::vector<std::uint32_t> index(count);
  for (std::size_t v = 0; v < count; ++v) {
    if (!kept[v] || !is_finite(mesh.vertices[v])) continue;
    index[v] = static_cast<std::uint32_t>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[v]);
    if (mesh.normals.size() == count) result.normals.push_back(mesh.normals[v]);
    if (mesh.colors.size() == count) result.colors.push_back(mesh.colors[v]);
    if (vectors.size() == count) subject.vectors.push_back(vectors[v]);
  }
  for (const Triangle& t : mesh.triangles)
    if (good(t)) result.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
  return subject;
}

RayScene make_rays(const Subject& subject, const Vec3f& toward_viewer) {
  const TriangleMesh& mesh = subject.mesh;
  if (!mesh.triangles.empty()) return RayScene::triangles(mesh.vertices, mesh.triangles);
  if (mesh.normals.empty()) return RayScene::balls(mesh.vertices, subject.radius);
  std::vector<Vec3f> normals = mesh.normals;
  for (Vec3f& n : normals) {
    n = is_finite(n) ? normalized(n) : Vec3f{};
    if (n == Vec3f{}) n = toward_viewer;
  }
  return RayScene::discs(mesh.vertices, normals, subject.radius);
}

}  // namespace

namespace {

/// `frame`: frame of the vertices; null: that of their box.
Subject framed_subject(const TriangleMesh& mesh, std::span<const Vec3f> vectors, const RenderOptions& options,
                       const PictureFrame* frame) {
  Subject subject = drawable(mesh, vectors);
  TriangleMesh& own = subject.mesh;
  if (own.vertices.empty()) throw DataError("nothing to draw: the mesh has no finite vertices");
  if (own.triangles.empty() && !mesh.triangles.empty())
    throw DataError("nothing to draw: no triangle has three finite corners");
  Box3 box;
  for (const Vec3f& p : own.vertices) box.extend(Vec3(p));
  double size = box.diagonal();
  if (!own.triangles.empty() && !(size > 0)) throw DataError("nothing to draw: all vertices coincide");

  if (own.triangles.empty()) {
    double radius = options.look.point_radius.value_or(0);
    if (!(radius > 0)) {
      PointSet cloud;
      cloud.positions = own.vertices;
      radius = estimate_spacing(cloud) * (own.normals.empty() ? kBallOverSpacing : kDiscOverSpacing);
    }
    if (!(size > 0)) size = radius > 0 ? 4 * radius : 1;  // all points coincide
    if (frame) size = frame->size;
    subject.radius = static_cast<float>(radius > 0 ? radius / size : 0.25);
  }
  if (frame) size = frame->size;
  const Vec3 center = frame ? frame->center : box.center();
  subject.frame = {mesh.origin + center, size};
  for (Vec3f& p : own.vertices) p = Vec3f((Vec3(p) - center) / size);
  return subject;
}

}  // namespace

Subject make_subject(const TriangleMesh& mesh, const RenderOptions& options) {
  return framed_subject(mesh, {}, options, nullptr);
}

Subject make_subject(const TriangleMesh& mesh, const RenderOptions& options, const PictureFrame& frame,
                     std::span<const Vec3f> vectors) {
  const PictureFrame own{frame.center - mesh.origin, frame.size};
  return framed_subject(mesh, vectors, options, &own);
}

namespace {

/// Lighting normal of a disc nearly parallel to the ray. At the silhouette of a shape, discs of its far side are
/// visible. They belong to the silhouette, whose neighbours they continue, not to the dark inside. Discs that face
/// farther away are seen from behind, like sheets.
Vec3f back_of_disc(const Vec3f& normal, const Vec3f& direction) {
  const float away = dot(normal, direction);
  const float t = std::clamp((away - 0.3f) / 0.4f, 0.0f, 1.0f), behind = t * t * (3 - 2 * t);
  return normalized((1 - 2 * behind) * (normal - away * direction) - away * direction);
}

}  // namespace

MeshScene::MeshScene(Subject subject, const RenderOptions& options, const Camera& camera)
    : subject_(std::move(subject)),
      rays_(make_rays(subject_, camera.backward)),
      linear_(256),
      only_wires_(options.look.wireframe == PictureLook::Wireframe::only),
      color_(linear_color(options.look.surface_color)),
      wire_color_(linear_color(options.look.wire_color)) {
  TriangleMesh& mesh = subject_.mesh;
  if (options.look.smooth && !mesh.triangles.empty()) corner_normals_ = corner_normals(mesh);
  if (!options.look.use_colors) mesh.colors.clear();
  if (options.look.wireframe != PictureLook::Wireframe::none && !mesh.triangles.empty())
    wires_ = MeshWires(mesh, camera, options.view.height, options.quality.samples, options.look.wire_width);
  for (int i = 0; i < 256; ++i) {
    const float c = from_byte(static_cast<std::uint8_t>(i));
    linear_[static_cast<std::size_t>(i)] = linear_color({c, c, c}).x;
  }
}

Vec3f MeshScene::vertex_color(std::uint32_t vertex) const {
  const auto& c = subject_.mesh.colors[vertex];
  return {linear_[c[0]], linear_[c[1]], linear_[c[2]]};
}

SurfacePoint MeshScene::on_triangle(const RayHit& hit, const Vec3f& at) const {
  const TriangleMesh& mesh = subject_.mesh;
  const Triangle& t = mesh.triangles[hit.primitive];
  const float weight[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  SurfacePoint point{hit.distance, at, hit.normal, color_};
  if (!mesh.colors.empty()) {
    point.color = {};
    for (std::size_t k = 0; k < 3; ++k) point.color += weight[k] * vertex_color(t[k]);
  }
  for (std::size_t k = 0; k < 3 && !subject_.vectors.empty(); ++k) point.vector += weight[k] * subject_.vectors[t[k]];
  if (corner_normals_.empty()) return point;

  // The surface implied by the smooth normals bulges out of the triangle. Shadow rays start there: from the triangle
  // itself, neighbours would block them along the shadow boundary (Hanika, Hacking the Shadow Terminator, Ray Tracing
  // Gems II, 2021).
  Vec3f normal, lift;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& n = corner_normals_[3 * hit.primitive + k];
    normal += weight[k] * n;
    lift += weight[k] * std::abs(std::min(0.0f, dot(at - mesh.vertices[t[k]], n))) * n;
  }
  if (squared_norm(normal) > 0) point.normal = normalized(normal);
  point.position += lift;
  return point;
}

SurfacePoint MeshScene::seen(const RayHit& hit, const Vec3f& eye, const Vec3f& direction) const {
  const Vec3f at = eye + hit.distance * direction;
  const bool cloud = subject_.mesh.triangles.empty();
  SurfacePoint point = cloud ? SurfacePoint{hit.distance, at, hit.normal, color_} : on_triangle(hit, at);
  if (cloud && !subject_.mesh.colors.empty()) point.color = vertex_color(hit.primitive);
  const float side = dot(hit.normal, direction) > 0 ? -1.0f : 1.0f;
  if (!wires_.empty()) {
    // Lines are black ink: they absorb light and have no highlights.
    const float ink = only_wires_ ? 1 : wires_.cover(hit, eye, direction);
    point.color = mix(point.color, wire_color_, ink);
    point.gloss *= 1 - ink;
  }
  // Seen from behind, the implied surface is on the far side.
  if (side < 0) point.position = at;
  Vec3f away = hit.normal * side;  // from the surface
  point.normal = point.normal * side;
  if (cloud && side < 0) point.normal = away = back_of_disc(hit.normal, direction);
  // Discs and balls of a rough cloud intersect each other: neighbours must not shade them.
  point.position += away * (kOffset + subject_.radius);
  if (subject_.opacity < 1 && !cloud) point.opacity = sheet_opacity(subject_.opacity, dot(point.normal, direction));
  return point;
}

/// Whether only lines are drawn, and there is none here.
bool MeshScene::clear(const RayHit& hit, const Vec3f& eye, const Vec3f& direction) const {
  return only_wires_ && !wires_.empty() && wires_.cover(hit, eye, direction) < 0.5f;
}

void MeshScene::closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const {
  std::vector<std::optional<RayHit>> hits(rays.size());
  rays_.closest(rays.origins, rays.directions, rays.near, rays.far, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    points[i].reset();
    if (!hits[i] || clear(*hits[i], rays.origin(i), rays.directions[i])) continue;
    points[i] = seen(*hits[i], rays.origin(i), rays.directions[i]);
  }
}

void MeshScene::layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const {
  if (!(subject_.opacity < 1) || subject_.mesh.triangles.empty()) return PictureScene::layers(rays, first, points);
  // Repeatedly casts from just behind the last hit.
  std::vector<RayPoint> found;
  std::vector<std::uint32_t> active(rays.size());
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = static_cast<std::uint32_t>(i);
  const bool apart = rays.origins.size() != 1;
  std::vector<Vec3f> from(rays.origins.begin(), rays.origins.end());
  std::vector<Vec3f> going(rays.directions.begin(), rays.directions.end());
  std::vector<float> beyond(rays.near.begin(), rays.near.end()), until(rays.far.begin(), rays.far.end());
  beyond.resize(rays.size(), 0), until.resize(rays.size(), std::numeric_limits<float>::infinity());
  std::vector<float> left(rays.size(), 1);
  std::vector<std::optional<RayHit>> hits;
  for (int round = 0; round < kMostSheets && !active.empty(); ++round) {
    hits.resize(active.size());
    rays_.closest(from, going, beyond, until, hits);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      if (!hits[k]) continue;
      const std::uint32_t ray = active[k];
      if (!clear(*hits[k], rays.origin(ray), rays.directions[ray])) {
        found.push_back({ray, seen(*hits[k], rays.origin(ray), rays.directions[ray])});
        left[ray] *= 1 - found.back().point.opacity;
        if (left[ray] < kLeastThrough) continue;
      }
      active[kept] = ray;
      if (apart) from[kept] = rays.origin(ray);
      going[kept] = rays.directions[ray];
      until[kept] = until[k];
      beyond[kept++] = hits[k]->distance + kBehind;
    }
    active.resize(kept), going.resize(kept), beyond.resize(kept), until.resize(kept);
    if (apart) from.resize(kept);
  }
  sort_into_layers(found, rays.size(), first, points);
}

void MeshScene::blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const {
  for (std::size_t i = 0; i < rays.size(); ++i)
    answers[i] = !(only_wires_ && !wires_.empty()) &&
                 rays_.blocked(rays[i].origin, rays[i].direction, rays[i].length, rays[i].near);
}

}  // namespace sansmesh::inline v1
