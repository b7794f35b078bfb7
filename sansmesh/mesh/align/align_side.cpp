#include "sansmesh/mesh/align/align_side.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/sampling/poisson_discs.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/sampling/subsample.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::size_t kFewest = 20;
constexpr std::size_t kDense = 60000;  // samples that describe a surface
constexpr std::size_t kMeanPlane = 5;  // neighbours averaged for a tangent plane
/// Lateral distance from the nearest sample, in spacings, beyond which a point is beyond the border.
constexpr double kAsideOverSpacing = 1.5;
constexpr std::size_t kOfBlur = 16;
constexpr double kFirstSpacing = 0.06;
constexpr double kLeastCrowd = 0.15;
/// Largest share of inconsistent edges of a mesh with meaningful sides.
constexpr double kFewContradictions = 0.02;
/// Volume over area^(3/2) below which only rounding is left.
constexpr double kNoVolume = 1e-7;

std::vector<Vec3f> to_floats(const std::vector<Vec3>& x) {
  std::vector<Vec3f> floats;
  floats.reserve(x.size());
  for (const Vec3& p : x) floats.emplace_back(p);
  return floats;
}

/// False if faces contradict each other or are back to back, since the nearest face is then arbitrary.
bool tells_sides(const TriangleMesh& mesh) {
  const MeshTopology t = measure_topology(mesh);
  if (static_cast<double>(t.inconsistent_edges) > kFewContradictions * static_cast<double>(t.edges)) return false;
  if (!t.encloses()) return true;
  double volume = 0, area = 0;
  const Vec3 base(mesh.vertices[0]);
  for (const Triangle& face : mesh.triangles) {
    if (!has_valid_corners(mesh.vertices, face)) continue;
    const Vec3 a = Vec3(mesh.vertices[face[0]]) - base, doubled = doubled_area(mesh.vertices, face);
    volume += dot(a, doubled) / 6;
    area += norm(doubled) / 2;
  }
  return std::abs(volume) > kNoVolume * std::pow(area, 1.5);
}

bool has_triangles(const TriangleMesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return has_valid_corners(mesh.vertices, t) && squared_norm(doubled_area(mesh.vertices, t)) > 0;
  });
}

/// Positions of triangle corners, or of all points.
std::vector<Vec3> counted_points(const TriangleMesh& mesh, std::size_t most) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), mesh.triangles.empty() ? 1 : 0);
  for (const Triangle& t : mesh.triangles)
    if (has_valid_corners(mesh.vertices, t)) used[t[0]] = used[t[1]] = used[t[2]] = 1;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] && is_finite(mesh.vertices[i])) points.emplace_back(mesh.vertices[i]);
  std::vector<Vec3> some;
  for (const std::uint32_t i : evenly_spaced(points.size(), most)) some.push_back(points[i]);
  return some;
}

void append(const PointSet& cloud, OrientedPoints& points) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    points.x.emplace_back(cloud.positions[i]);
    points.n.push_back(normalized(Vec3(cloud.normals[i])));
  }
}

/// Removes points with hardly any neighbours.
void drop_strays(OrientedPoints& points, double radius) {
  const std::vector<Vec3f> x = to_floats(points.x);
  const KdTree tree(x);
  std::vector<std::size_t> crowd(x.size());
  parallel_for(0, x.size(), 256,
               [&](std::size_t i) { crowd[i] = tree.count_within(x[i], static_cast<float>(radius)); });
  std::vector<std::size_t> sorted = crowd;
  const double least = kLeastCrowd * static_cast<double>(median(sorted));
  OrientedPoints kept;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (static_cast<double>(crowd[i]) >= least) kept.x.push_back(points.x[i]), kept.n.push_back(points.n[i]);
  if (kept.size() >= kFewest) points = std::move(kept);
}

/// Smooths the normals of faces, which are as noisy as the vertices.
void blur_normals(OrientedPoints& points) {
  const std::vector<Vec3f> x = to_floats(points.x);
  const KdTree tree(x);
  const std::span<const std::uint32_t> order = tree.order();
  std::vector<Vec3> blurred = points.n;
  tree.for_each_nearest(kOfBlur, [&](std::uint32_t slot, std::span<const Neighbour> near) {
    const std::uint32_t i = order[slot];
    Vec3 sum;
    for (const Neighbour& one : near)
      if (const Vec3& n = points.n[order[one.index]]; dot(n, points.n[i]) > 0) sum += n;
    blurred[i] = normalized(sum);
  });
  points.n = std::move(blurred);
}

}  // namespace

OrientedPoints OrientedPoints::some(std::size_t most) const {
  OrientedPoints some;
  for (const std::uint32_t i : evenly_spaced(size(), most)) some.x.push_back(x[i]), some.n.push_back(n[i]);
  return some;
}

SampleSurface::SampleSurface(OrientedPoints points, double spacing) : points_(std::move(points)), spacing_(spacing) {
  const std::vector<Vec3f> x = to_floats(points_.x);
  tree_ = KdTree(x);
}

bool SampleSurface::closest(const Vec3& q, double reach, Foot& foot) const {
  std::array<Neighbour, kMeanPlane> near;
  const std::size_t found = tree_.nearest(Vec3f(q), near);
  const double aside = kAsideOverSpacing * spacing_;
  if (found == 0 || !(static_cast<double>(near[0].squared_distance) <= reach * reach + aside * aside)) return false;
  const Vec3& nearest = points_.x[near[0].index];
  const Vec3& first = points_.n[near[0].index];
  Vec3 point, normal;
  double count = 0;
  for (std::size_t k = 0; k < found; ++k) {
    const Vec3 &p = points_.x[near[k].index], &n = points_.n[near[k].index];
    const double along = dot(n, first);
    if (k > 0 && (std::abs(along) < 0.7 || squared_norm(p - nearest) > 9 * spacing_ * spacing_)) continue;
    point += p;
    normal += along < 0 ? -n : n;
    count += 1;
  }
  point = point / count;
  foot.normal = normalized(normal);
  foot.point = q - foot.normal * dot(q - point, foot.normal);
  foot.beyond = squared_norm(foot.point - nearest) > aside * aside;
  return true;
}

WholeSurface::WholeSurface(const TriangleMesh& mesh, const OrientedPoints& points, double spacing) : mesh_(mesh) {
  if (mesh.triangles.empty()) {
    points_ = std::make_unique<SampleSurface>(points, spacing);
    return;
  }
  triangles_ = std::make_unique<ClosestTriangle>(mesh);
  const PositionEdges edges = edges_by_position(mesh);
  border_edge_.assign(mesh.triangles.size(), 0);
  border_vertex_.assign(mesh.vertices.size(), 0);
  for (const PositionEdges::Edge& e : edges.edges) {
    if (e.count != 1) continue;
    const std::uint32_t corner = edges.corners[e.first];
    border_edge_[corner / 3] |= static_cast<std::uint8_t>(1u << corner % 3);
    border_vertex_[e.a] = border_vertex_[e.b] = 1;
  }
  for (std::size_t v = 0; v < border_vertex_.size(); ++v) border_vertex_[v] = border_vertex_[edges.representative[v]];
}

bool WholeSurface::closest(const Vec3& q, double reach, Foot& foot) const {
  if (points_) return points_->closest(q, reach, foot);
  ClosestTriangle::Hit limit;
  limit.squared_distance = reach * reach;
  const ClosestTriangle::Hit hit = triangles_->closest(q, limit);
  if (hit.triangle == ClosestTriangle::kNone) return false;
  const Triangle& t = mesh_.triangles[hit.triangle];
  foot.point = hit.point;
  foot.normal = normalized(doubled_area(mesh_.vertices, t));
  foot.beyond = false;
  if (const std::uint8_t borders = border_edge_[hit.triangle];
      borders || border_vertex_[t[0]] || border_vertex_[t[1]] || border_vertex_[t[2]]) {
    const auto part =
        locate_on_triangle(q, Vec3(mesh_.vertices[t[0]]), Vec3(mesh_.vertices[t[1]]), Vec3(mesh_.vertices[t[2]])).part;
    switch (part) {
      case TrianglePart::a:
      case TrianglePart::b:
      case TrianglePart::c:
        foot.beyond = border_vertex_[t[static_cast<std::size_t>(part)]] != 0;
        break;
      case TrianglePart::ab:
      case TrianglePart::bc:
      case TrianglePart::ca:
        foot.beyond = (borders >> (static_cast<unsigned>(part) - static_cast<unsigned>(TrianglePart::ab)) & 1u) != 0;
        break;
      case TrianglePart::inside:
        break;
    }
  }
  return true;
}

LocalFrame measure_side(const TriangleMesh& mesh, const char* name) {
  const std::vector<Vec3> points = counted_points(mesh, kDense);
  if (points.size() < (mesh.triangles.empty() ? kFewest : 4))
    throw DataError(std::string("the ") + name + " surface has too few points to be aligned");
  Vec3 middle;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> c;
    c.reserve(points.size());
    for (const Vec3& p : points) c.push_back(p[k]);
    middle[k] = median(c);
  }
  std::vector<double> far;
  far.reserve(points.size());
  for (const Vec3& p : points) far.push_back(norm(p - middle));
  const double size = nth_smallest(far, far.size() * 3 / 4);
  if (!(size > 0 && std::isfinite(size))) throw DataError(std::string("the ") + name + " surface has no extent");
  return {mesh.origin + middle, size};
}

AlignSide prepare_side(const TriangleMesh& mesh, const LocalFrame& frame, std::size_t most, const char* name,
                       Progress& progress) {
  AlignSide side;
  const Vec3 shift = mesh.origin - frame.origin;
  const auto own = [&](const Vec3f& p) { return (Vec3(p) + shift) / frame.unit; };
  side.is_mesh = has_triangles(mesh);
  side.has_sides = side.is_mesh ? tells_sides(mesh) : !mesh.normals.empty();
  if (side.is_mesh) {
    side.mesh.vertices.reserve(mesh.vertices.size());
    for (const Vec3f& p : mesh.vertices) side.mesh.vertices.push_back(Vec3f(own(p)));
    side.mesh.triangles = mesh.triangles;
    std::erase_if(side.mesh.triangles, [&](const Triangle& t) { return !has_valid_corners(mesh.vertices, t); });
    for (const FaceSample& s : sample_triangles(side.mesh.vertices, side.mesh.triangles, kDense)) {
      side.dense.x.push_back(s.position);
      side.dense.n.emplace_back(s.normal);
    }
    blur_normals(side.dense);
    for (const Triangle& t : side.mesh.triangles) side.area += norm(doubled_area(side.mesh.vertices, t)) / 2;
  } else {
    PointSet cloud;
    std::vector<std::uint32_t> finite;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      if (is_finite(mesh.vertices[i])) finite.push_back(static_cast<std::uint32_t>(i));
    const bool given = !mesh.normals.empty();
    for (const std::uint32_t k : evenly_spaced(finite.size(), given ? finite.size() : std::max(most, kDense))) {
      cloud.positions.push_back(Vec3f(own(mesh.vertices[finite[k]])));
      if (given) cloud.normals.push_back(mesh.normals[finite[k]]);
    }
    PointSet dense;
    try {
      if (!given) estimate_normals(cloud, {}, progress);
      for (const std::uint32_t i : evenly_spaced(cloud.size(), kDense)) {
        dense.positions.push_back(cloud.positions[i]);
        dense.normals.push_back(cloud.normals[i]);
      }
      // Only the global search needs consistent signs of estimated normals, for these samples.
      if (!given) orient_normals(dense, {}, progress);
    } catch (const DataError&) {
      throw DataError(std::string("the ") + name + " surface has no normals, and none can be estimated");
    }
    append(cloud, side.all);
    append(dense, side.dense);
    drop_strays(side.dense, 2 * kFirstSpacing);
    side.area =
        static_cast<double>(poisson_discs(side.dense.x, kFirstSpacing).size()) * kFirstSpacing * kFirstSpacing / 0.75;
  }
  if (side.dense.size() < kFewest)
    throw DataError(std::string("the ") + name + " surface has too few points to be aligned");
  const OrientedPoints even = even_samples(side, kFirstSpacing, 0);
  for (const Vec3& p : even.x) side.centroid += p / static_cast<double>(even.size());
  for (const Vec3& p : even.x) side.radius += squared_norm(p - side.centroid);
  side.radius = std::sqrt(side.radius / static_cast<double>(even.size()));
  // The sample spacing is derived from the larger surface: the smaller one may have a single sample.
  if (!(side.radius > 0))
    throw DataError(std::string("the ") + name +
                    " surface is too small relative to the other (`find_scale` estimates the scale)");
  return side;
}

OrientedPoints even_samples(const AlignSide& side, double spacing, double blur) {
  OrientedPoints even;
  const std::vector<std::uint32_t> chosen = poisson_discs(side.dense.x, spacing);
  even.x.resize(chosen.size()), even.n.resize(chosen.size());
  std::vector<Vec3f> x;
  KdTree tree;
  if (blur > 0) {
    x = to_floats(side.dense.x);
    tree = KdTree(x);
  }
  parallel_ranges(0, chosen.size(), 64, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> near;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t s = chosen[i];
      even.x[i] = side.dense.x[s], even.n[i] = side.dense.n[s];
      if (!(blur > 0)) continue;
      tree.within(x[s], static_cast<float>(blur), near);
      Vec3 sum;
      for (const Neighbour& one : near) {
        const Vec3& n = side.dense.n[one.index];
        if (dot(n, even.n[i]) > 0) sum += n;
      }
      if (squared_norm(sum) > 0) even.n[i] = normalized(sum);
    }
  });
  return even;
}

}  // namespace sansmesh::inline v1::detail
