#include "sansmesh/mesh_csg.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/csg/solid_node.h"
#include "sansmesh/mesh_steps.h"
#include "sansmesh/polygonize/crease_mesh.h"
#include "sansmesh/polygonize/mesh_topology.h"

namespace sansmesh {
namespace {

constexpr double kCellsOnDiagonal = 256;
constexpr double kMostCells = 4096;
/// Default quadric error, in cells: a tenth of what curved parts are off anyway.
constexpr double kSimplify = 1e-3;
/// By default nothing is simplified where a smaller share of the vertices could go: then the rest takes its time in
/// vain.
constexpr double kLeastGain = 0.05;
/// Blocks are cut down to this level wherever the solid may be: fields are distances only near their surfaces.
constexpr int kBaseLevel = 5;
/// Faces of blocks should not lie in faces of solids, which are often at round numbers: the cube is shifted by this
/// share of a block.
constexpr Vec3 kShift{0.3819, 0.2361, 0.4271};

/// Where to look, or an error that says why nowhere.
Box3 box_of(const PiecewiseField& solid, const CsgMeshOptions& options) {
  Box3 box = solid.bounds();
  if (options.box)
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] = std::max(box.lower[k], options.box->lower[k]);
      box.upper[k] = std::min(box.upper[k], options.box->upper[k]);
    }
  if (box.empty()) throw DataError(options.box ? "the solid has no point inside the box" : "the solid is empty");
  std::string endless;
  for (std::size_t k = 0; k < 3; ++k)
    for (const bool upper : {false, true})
      if (!std::isfinite((upper ? box.upper : box.lower)[k]))
        endless += fmt::format("{}{}{}", endless.empty() ? "" : ", ", upper ? '+' : '-', "xyz"[k]);
  if (!endless.empty())
    throw ArgumentError(fmt::format(
        "the solid is not known to end in the directions {}: intersect it with a box, or give a box to cut it off",
        endless));
  return box;
}

/// The box less what the surface is known not to reach: boxes of fields hold more than their surfaces, and differences
/// are smaller than what they begin with.
Box3 tightened(const ScalarField& field, const Box3& box, double slope) {
  constexpr std::size_t n = std::size_t{1} << kBaseLevel;
  const Vec3 step = box.size() * (1.0 / n);
  std::vector<Vec3> centers(n * n * n);
  std::vector<double> values(centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i)
    for (std::size_t k = 0, rest = i; k < 3; ++k, rest /= n)
      centers[i][k] = box.lower[k] + (static_cast<double>(rest % n) + 0.5) * step[k];
  field.evaluate(centers, values);
  Box3 reached;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (std::abs(values[i]) > slope * norm(step) / 2) continue;
    reached.extend(centers[i] - step * 0.5);
    reached.extend(centers[i] + step * 0.5);
  }
  if (reached.empty()) throw DataError("the solid is empty");
  for (std::size_t k = 0; k < 3; ++k) {  // without rounding, where nothing could be left out
    reached.lower[k] = std::max(reached.lower[k], box.lower[k]);
    reached.upper[k] = std::min(reached.upper[k], box.upper[k]);
  }
  return reached;
}

double cell_of(const Box3& box, const CsgMeshOptions& options) {
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) throw DataError("the solid has no extent");
  const double cell = options.cell         ? *options.cell
                      : options.resolution ? longest / *options.resolution
                                           : box.diagonal() / kCellsOnDiagonal;
  if (longest / cell > kMostCells)
    throw ArgumentError(fmt::format("cell {} is too small for a box of {} × {} × {}: at most {} cells along a side",
                                    cell, size.x, size.y, size.z, kMostCells));
  return std::min(cell, longest / 2);
}

/// Blocks of edge `cell` wherever the surface may be in the box.
BlockTree blocks_around(const ScalarField& field, const Box3& box, double cell, double slope, Progress& progress) {
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  int depth = 0;
  while (cell * static_cast<double>(1 << depth) < longest + 4 * cell) ++depth;
  const double edge = cell * static_cast<double>(1 << depth);
  BlockTree tree(box.center() - Vec3{edge, edge, edge} * 0.5 + cell * (kShift - Vec3{0.5, 0.5, 0.5}), edge);
  progress.begin("blocks", static_cast<std::size_t>(depth));
  std::vector<std::uint32_t> level{0};
  for (int l = 0; l < depth; ++l) {
    const double half = edge / static_cast<double>(1 << l) / 2;
    std::vector<std::uint32_t> candidates;
    std::vector<Vec3> centers;
    for (const std::uint32_t b : level) {
      const Vec3 c = tree.block_center(b);
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k)
        meets = meets && c[k] + half >= box.lower[k] - cell && c[k] - half <= box.upper[k] + cell;
      if (!meets) continue;
      candidates.push_back(b);
      centers.push_back(c);
    }
    std::vector<double> values;
    if (l >= kBaseLevel) values.resize(centers.size()), field.evaluate(centers, values);
    level.clear();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (l >= kBaseLevel && std::abs(values[i]) > slope * std::sqrt(3.0) * half) continue;
      const auto child = static_cast<std::uint32_t>(tree.subdivide(candidates[i]));
      for (std::uint32_t c = 0; c < 8; ++c) level.push_back(child + c);
    }
    progress.advance();
  }
  progress.finish();
  return tree;
}

void measure(const TriangleMesh& mesh, CsgMeshReport& report) {
  struct Sums {
    double area = 0, volume = 0;
  };
  const Sums sums = parallel_reduce(
      mesh.triangles.size(), 4096, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums s;
        for (std::size_t t = first; t < last; ++t) {
          const Vec3 a(mesh.vertices[mesh.triangles[t][0]]), b(mesh.vertices[mesh.triangles[t][1]]),
              c(mesh.vertices[mesh.triangles[t][2]]);
          s.area += norm(cross(b - a, c - a)) / 2;
          s.volume += dot(a, cross(b, c)) / 6;
        }
        return s;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.area + b.area, a.volume + b.volume};
      });
  report.area = sums.area, report.volume = sums.volume;
  const MeshTopology topology = measure_topology(mesh);
  report.components = topology.components;
  report.closed = topology.closed();
}

}  // namespace

void CsgMeshOptions::validate() const {
  if (cell && resolution) throw ArgumentError("give the cell or the resolution, not both");
  if (cell && !(*cell > 0 && std::isfinite(*cell)))
    throw ArgumentError(fmt::format("cell {}: must be a positive length", *cell));
  if (resolution && (*resolution < 4 || *resolution > kMostCells))
    throw ArgumentError(fmt::format("resolution {}: must lie in 4..{}", *resolution, kMostCells));
  if (simplify && !(*simplify >= 0 && std::isfinite(*simplify)))
    throw ArgumentError(fmt::format("simplify {}: must be a length, or 0", *simplify));
  if (!box) return;
  if (!is_finite(box->lower) || !is_finite(box->upper)) throw ArgumentError("box: corners must be finite");
  for (std::size_t k = 0; k < 3; ++k)
    if (!(box->lower[k] < box->upper[k]))
      throw ArgumentError(fmt::format("box: its lower corner must lie below its upper one, but {} >= {} in {}",
                                      box->lower[k], box->upper[k], "xyz"[k]));
}

TriangleMesh mesh_csg(const PiecewiseField& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report) {
  options.validate();
  const Box3 whole_box = box_of(solid, options);
  // A solid is cut off by intersection, so that the faces of the cut have edges as all others.
  const auto* whole = dynamic_cast<const Solid*>(&solid);
  const double slope = whole && whole->node()->lipschitz() ? 1.0001 : 1.5;
  std::optional<Solid> cut;
  if (options.box) {
    const std::shared_ptr<const ScalarField> borrowed(std::shared_ptr<const void>(), &solid);
    cut = csg::intersect(whole ? *whole : csg::leaf(borrowed), csg::box(options.box->lower, options.box->upper));
  }
  const PiecewiseField& field = cut ? *cut : solid;
  const Box3 box = tightened(field, whole_box, slope);
  const double cell = cell_of(box, options);
  BlockTree tree = blocks_around(field, box, cell, slope, progress);

  CsgMeshReport local;
  CsgMeshReport& r = report ? *report : local;
  r = {};
  r.box = box, r.cell = cell, r.depth = tree.depth(), r.blocks = tree.leaves().size();
  PolygonizeOptions polygonize;
  polygonize.simplify = options.simplify.value_or(kSimplify * cell);
  polygonize.least_gain = options.simplify ? 0 : kLeastGain;
  TriangleMesh mesh = polygonize_with_creases(field, std::move(tree), box.center(), polygonize, progress);
  if (mesh.triangles.empty())
    throw DataError(fmt::format("the solid is empty, or thinner than the cells of {:.3g}", cell));
  MeshReport chosen;
  detail::choose_components(mesh, options.components, {}, 0, chosen);
  r.warnings = std::move(chosen.warnings);
  measure(mesh, r);
  return mesh;
}

}  // namespace sansmesh
