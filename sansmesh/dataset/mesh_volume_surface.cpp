#include "sansmesh/dataset/mesh_volume_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/layer_fields.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/points/remedies.h"
#include "sansmesh/points/sampling/poisson_discs.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMeshError = 0.02;  // in spacings
/// Smallest extent of mesh parts along some axis, over the width h of the weights: weights do not resolve smaller
/// closed parts without a sample inside, and beginnings of borders.
constexpr double kResolved = 1;
/// Vertices of borders of materials farther away than this are removed, in spacings.
constexpr double kOffSurface = 0.2;
/// Points are no closer than this share of the spacing; candidates closer than this share of the requested distance to
/// others are dropped immediately.
constexpr int kMostAlong = 8;
constexpr double kThinned = 0.2;
constexpr std::size_t kFeetAtOnce = 65536;

/// Removes triangles where the field jumps: half-way between two borders of materials the outside of one meets the
/// inside of the other, and coarse blocks connect them.
void drop_jumps(TriangleMesh& mesh, const ScalarField& field, double most) {
  std::vector<Vec3> x(mesh.vertices.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = mesh.origin + Vec3(mesh.vertices[i]);
  std::vector<double> values(x.size());
  field.evaluate(x, values);
  const auto on_surface = [&](std::uint32_t v) { return std::abs(values[v]) <= most; };
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t)
    keep[t] = std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), on_surface);
  if (std::all_of(keep.begin(), keep.end(), [](std::uint8_t k) { return k != 0; })) return;
  keep_triangles(mesh, keep);
  separate_fans(mesh);
}

/// Removes parts that are shorter along every axis than the width of the weights around them, and closed ones with less
/// volume than one sample represents; returns their number.
std::size_t drop_unresolved(TriangleMesh& mesh, const BallUnion& balls, std::span<const float> spacing,
                            double smoothing) {
  const MeshComponents parts = find_components(mesh);
  std::vector<Box3> boxes(parts.size());
  std::vector<double> volumes(parts.size()), areas(parts.size());
  std::vector<Vec3> turned(parts.size());  // vector areas sum to zero over a closed part
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t part = parts.of_triangle[t];
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 p(mesh.vertices[a]), q(mesh.vertices[b]), r(mesh.vertices[c]);
    boxes[part].extend(p), boxes[part].extend(q), boxes[part].extend(r);
    volumes[part] += dot(p, cross(q, r)) / 6;
    const Vec3 area = cross(q - p, r - p);
    turned[part] += area, areas[part] += norm(area);
  }
  const KdTree near(balls.centers);
  std::vector<std::uint8_t> small(parts.size());
  for (std::size_t i = 0; i < small.size(); ++i) {
    const auto found = near.nearest(Vec3f(mesh.origin + boxes[i].center()));
    if (!found) continue;
    const double s = static_cast<double>(spacing[found->index]);
    const Vec3 size = boxes[i].size();
    small[i] = std::max({size.x, size.y, size.z}) < kResolved * smoothing * s ||
               (norm(turned[i]) < 1e-3 * areas[i] && std::abs(volumes[i]) < s * s * s);
  }
  const auto dropped = static_cast<std::size_t>(std::count(small.begin(), small.end(), 1));
  if (dropped == 0) return 0;
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = small[parts.of_triangle[t]] == 0;
  keep_triangles(mesh, keep);
  return dropped;
}

}  // namespace

TriangleMesh mesh_volume_surface(const VolumeSurface& surface, const MeshOptions& meshing, Progress& progress,
                                 MeshReport* report) {
  meshing.validate();
  MeshReport local;
  MeshReport& r = report ? *report : local;
  r = {};
  const LocalFrame& frame = surface.frame();
  MeshOptions own = meshing;
  if (meshing.mesh_error) own.mesh_error = frame.from_input(*meshing.mesh_error);
  const double error = own.mesh_error.value_or(kMeshError * frame.from_input(surface.report().spacing));
  r.mesh_error = frame.to_input(error);
  progress.begin("find surface");
  const BlockTree blocks = surface.blocks();
  PolygonizeOptions polygonize = detail::meshing_options(own, error, false);
  const bool iso = surface.options().kind == VolumeSurfaceOptions::Kind::isovalue;
  const LayerDomain domain(surface.domain(), iso ? nullptr : &surface.balls());
  polygonize.domain = &domain;
  TriangleMesh mesh = detail::cut_out(surface.field(), blocks, own, polygonize, progress, r);
  if (mesh.triangles.empty()) throw DataError("has no such surface");
  progress.begin("finish mesh");
  if (!iso) drop_jumps(mesh, surface.field(), kOffSurface * frame.from_input(surface.report().spacing));
  if (meshing.components.kind == ComponentChoice::Kind::automatic) {
    const std::size_t dropped = drop_unresolved(mesh, surface.balls(), surface.spacing(), surface.report().smoothing);
    if (dropped > 0)
      r.notes.push_back(with_remedy(remedy("parts_left_out", "components"),
                                    counted(dropped, "part") + " too small for weights of this width left out"));
  } else {
    detail::choose_components(mesh, meshing.components, {}, 0, r);
  }
  if (mesh.triangles.empty()) throw DataError("has no such surface that weights of this width resolve");
  const MeshTopology topology = measure_topology(mesh);
  r.components = static_cast<int>(topology.components);
  r.open = !topology.closed();
  move_to_input(mesh, frame);
  progress.finish();
  return mesh;
}

PointSet sample_volume_surface(const VolumeSurface& surface, std::optional<double> distance, Progress& progress) {
  if (distance && !(std::isfinite(*distance) && *distance >= surface.report().spacing / kMostAlong))
    throw ArgumentError(fmt::format("`distance` must be at least {:.4g}, a part of {} of the spacing",
                                    surface.report().spacing / kMostAlong, kMostAlong));
  const LocalFrame& frame = surface.frame();
  const double apart = frame.from_input(distance.value_or(surface.report().spacing));
  const BallUnion& balls = surface.sample_balls();
  const std::span<const float> spacings = surface.sample_spacing();
  progress.begin("project", balls.centers.size());
  std::vector<Vec3> feet, normals;
  std::vector<Vec3f> x;
  std::vector<float> around;
  const auto flush = [&] {
    progress.check();
    // Points in the volume are thinned immediately: memory is proportional to the result.
    std::vector<Vec3> found, facing;
    for (const FootPoint& f : find_feet(surface.projection(), x, around).feet)
      found.push_back(f.position), facing.push_back(f.normal);
    std::vector<std::uint8_t> inside(found.size());
    surface.domain().locate(found, inside);
    for (const std::uint32_t i : poisson_discs(found, kThinned * apart)) {
      if (inside[i] == 0) continue;
      feet.push_back(found[i]);
      normals.push_back(facing[i]);
    }
    x.clear(), around.clear();
  };
  for (std::size_t i = 0; i < balls.centers.size(); ++i) {
    // Feet of the samples next to the surface and, for dense results, of points around these.
    const double ratio = 2 * static_cast<double>(spacings[i]) / apart;
    const int along = index_in<int>(std::ceil(ratio), 1, 2 * kMostAlong);
    const float step = spacings[i] / static_cast<float>(along), first = 0.5f * static_cast<float>(1 - along);
    for (int a = 0; a < along; ++a)
      for (int b = 0; b < along; ++b)
        for (int c = 0; c < along; ++c) {
          const Vec3f at{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
          x.push_back(balls.centers[i] + (at + Vec3f{first, first, first}) * step);
          around.push_back(spacings[i]);
        }
    if (x.size() >= kFeetAtOnce) flush();
    progress.advance();
  }
  if (!x.empty()) flush();
  if (feet.empty()) throw DataError("has no such surface");
  progress.begin("choose points");
  const std::vector<std::uint32_t> chosen = poisson_discs(feet, apart);
  PointSet points;
  points.origin = frame.origin;
  points.positions.reserve(chosen.size()), points.normals.reserve(chosen.size());
  for (const std::uint32_t i : chosen) {
    points.positions.push_back(Vec3f(feet[i] * frame.unit));
    points.normals.push_back(Vec3f(normals[i]));
  }
  progress.finish();
  return points;
}

}  // namespace sansmesh::inline v1
