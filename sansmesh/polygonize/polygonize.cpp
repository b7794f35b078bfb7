#include "sansmesh/polygonize/polygonize.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/polygonize/creases/crease_edges.h"
#include "sansmesh/polygonize/lattice/extraction.h"
#include "sansmesh/polygonize/surface_chain.h"
#include "sansmesh/polygonize/vertex_placement.h"

namespace sansmesh::inline v1 {
namespace {

/// A surface as extracted from the lattice.
struct RawSurface {
  std::vector<Triangle> triangles;
  std::vector<Vec3f> vertices;       ///< relative to the origin
  std::vector<std::uint8_t> on_cap;  ///< closes the mesh at a face of the cube, where no surface exists to move it to
};

/// Frees the lattice, which is larger than the surface, on return.
RawSurface extract(const ScalarField& field, BlockTree blocks, const Vec3& origin, const PolygonizeOptions& options,
                   Progress& progress) {
  Extraction e(field, std::move(blocks), origin, options.regions);
  progress.begin("evaluate lattice");
  if (options.domain) e.leave_out(*options.domain);
  e.activate(options.seeds);
  if (options.displacement > 0) e.displace(options.displacement);

  progress.begin("march");
  std::vector<std::uint8_t> merged;
  if (options.cluster) merged.assign(e.lattice_vertices(), 1);
  SurfaceChain chain =
      make_surface_chain({[&](const ChainSource::Flags& m, const ChainSource::Flags& near) { return e.march(m, near); },
                          [&](ChainSource::Flags& marked) { e.widen(marked); }},
                         merged);
  const std::size_t n = chain.vertices.size();
  RawSurface raw{std::move(chain.triangles), std::vector<Vec3f>(n), std::vector<std::uint8_t>(n)};
  parallel_for(0, n, 4096, [&](std::size_t i) {
    const ChainVertex v = chain.vertices[i];
    raw.on_cap[i] = e.is_cap(v.a) || e.is_cap(v.b);
    if (v.a == v.b) {
      raw.vertices[i] = e.position(v.a);
    } else {
      const float t = e.value(v.a) / (e.value(v.a) - e.value(v.b));
      const Vec3f a = e.position(v.a), b = e.position(v.b);
      raw.vertices[i] = a + (b - a) * t;
    }
  });
  return raw;
}

/// Square of the longest edge at each vertex.
std::vector<float> longest_edges(const RawSurface& raw) {
  std::vector<float> longest(raw.vertices.size(), 0);
  for (const Triangle& t : raw.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const float d = squared_norm(raw.vertices[t[k]] - raw.vertices[t[(k + 1) % 3]]);
      longest[t[k]] = std::max(longest[t[k]], d);
    }
  return longest;
}

/// Simplifies the mesh with its vertices at x; false if it is unchanged.
bool simplified(const PolygonizeOptions& options, TriangleMesh& mesh, const std::vector<Vec3>& x, Progress& progress) {
  if (!(options.simplify > 0)) return false;
  progress.begin("simplify");
  parallel_for(0, x.size(), 4096, [&](std::size_t i) { mesh.vertices[i] = Vec3f(x[i] - mesh.origin); });
  std::vector<Vec3f> normals = std::move(mesh.normals);  // recomputed if the mesh changes
  mesh.normals.clear();
  CollapseOptions simplify;
  simplify.error = options.simplify;
  simplify.triangles = options.triangles;
  if (options.triangles > 0) simplify.least_shape = kLeastShapeOfNumber;
  simplify.least_gain = options.least_gain;
  // Parts of a mesh without borders may be recomputed, and must match.
  simplify.in_patches = options.domain != nullptr;
  const bool changed = simplify_mesh(mesh, simplify, progress);
  if (!changed) mesh.normals = std::move(normals);
  progress.begin("place vertices again");
  return changed;
}

constexpr std::size_t kFarFewer = 10;

/// Vertices this close to the contour, as a fraction of a crossing edge, are moved onto it.
constexpr float kSnapToContour = 0.3f;

/// Removes the part outside the domain of the mesh with its vertices at x, and the caps at the cube's faces.
void cut_off(const ScalarField& domain, const std::vector<std::uint8_t>& on_cap, TriangleMesh& mesh,
             std::vector<Vec3>& x) {
  std::vector<double> value(x.size());
  domain.evaluate(x, value);
  std::vector<float> height(x.size());
  parallel_for(0, x.size(), 8192, [&](std::size_t i) {
    mesh.vertices[i] = Vec3f(x[i] - mesh.origin);
    height[i] = on_cap[i] ? std::min(-1.0f, -static_cast<float>(value[i])) : -static_cast<float>(value[i]);
  });
  clip_mesh(mesh, std::move(height), kSnapToContour);
  x.resize(mesh.vertices.size());
  parallel_for(0, x.size(), 8192, [&](std::size_t i) { x[i] = mesh.origin + Vec3(mesh.vertices[i]); });
}

}  // namespace

TriangleMesh polygonize(const ScalarField& field, BlockTree blocks, const Vec3& origin,
                        const PolygonizeOptions& options, Progress& progress) {
  if (!(options.displacement >= 0 && options.displacement < 1))
    throw ArgumentError("polygonize: `displacement` must lie in [0, 1)");
  if (!(options.simplify >= 0)) throw ArgumentError("polygonize: `simplify` must be a length of at least 0");
  progress.begin("balance blocks");
  blocks.balance();
  const ScalarField& placement = options.placement ? *options.placement : field;
  const Box3 cube = blocks.bounds();
  RawSurface raw = extract(field, std::move(blocks), origin, options, progress);

  progress.begin("place vertices");
  // A root is within half the lattice's local spacing of the vertex's start; a longer step indicates an unreliable
  // gradient.
  const std::vector<float> longest = longest_edges(raw);
  const std::vector<std::uint8_t> on_cap = std::move(raw.on_cap);
  TriangleMesh mesh;
  mesh.origin = origin;
  mesh.triangles = std::move(raw.triangles);
  mesh.vertices = std::move(raw.vertices);
  const std::size_t n = mesh.vertices.size();
  mesh.normals.resize(n);
  std::vector<Vec3> x(n), g(n);
  std::vector<double> f(n);
  parallel_for(0, n, 8192, [&](std::size_t i) { x[i] = origin + Vec3(mesh.vertices[i]); });
  const auto to_surface = [&] {
    placement.evaluate(x, f, g);
    parallel_for(0, n, 4096, [&](std::size_t i) {
      const double slope2 = squared_norm(g[i]);
      if (options.root_steps > 0 && slope2 > 1e-4 && !on_cap[i]) {
        Vec3 move = g[i] * (-f[i] / slope2);
        const double most = 0.6 * std::sqrt(static_cast<double>(longest[i])), size = norm(move);
        if (size > most) move *= most / size;
        x[i] += move;
      }
      mesh.normals[i] = Vec3f(normalized(g[i]));
    });
  };
  for (int step = 1; step < options.root_steps; ++step) to_surface();
  VertexCorners corners(mesh.triangles, n);
  if (options.smoothing_rounds > 0)
    smooth_tangentially(mesh.triangles, corners, mesh.normals, options.smoothing_rounds, x);
  to_surface();
  if (options.creases) {
    snap_to_creases(placement, mesh.triangles, corners, mesh.normals, x);
    if (turn_edges_to_creases(placement, x, mesh.normals, mesh.triangles) > 0)
      corners = VertexCorners(mesh.triangles, n);
  }
  if (options.domain) {
    cut_off(*options.domain, on_cap, mesh, x);
    corners = VertexCorners(mesh.triangles, mesh.vertices.size());
  }
  const std::size_t fine = mesh.triangles.size();
  if (simplified(options, mesh, x, progress)) {
    // A number of triangles far below that of the surface leaves triangles off the surface: their vertices are placed
    // so that these are nearest.
    const bool far_fewer = options.triangles > 0 && fine > kFarFewer * mesh.triangles.size();
    place_again(placement, options, far_fewer, mesh, x);
    if (options.creases) turn_edges_to_creases(placement, x, mesh.normals, mesh.triangles);
  } else if (options.balance) {
    balance_gaps(placement, mesh.triangles, corners, mesh.normals, x);
  }
  parallel_for(0, x.size(), 4096, [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) x[i][k] = std::clamp(x[i][k], cube.lower[k], cube.upper[k]);
    mesh.vertices[i] = Vec3f(x[i] - origin);
  });
  progress.finish();
  return mesh;
}

}  // namespace sansmesh::inline v1
