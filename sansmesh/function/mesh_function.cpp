#include "sansmesh/function/mesh_function.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/error.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/function/function_domain.h"
#include "sansmesh/mesh/clip_mesh.h"
#include "sansmesh/mesh/replace_region.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"

namespace sansmesh {
namespace {

/// Least gap of the blocks, for a mesh error that was asked for, in its unit: a coarse mesh is made from a finer one.
constexpr double kCoarseBlocks = 0.5;
/// What is made anew around a change, in edges of the largest block of the surface there: at first, and at most where
/// that was not enough.
constexpr double kMargin = 3, kMostMargin = 60;
/// Share of the surface beyond which making all of it anew is less work.
constexpr double kMostWork = 0.5;
/// Vertices of old and new mesh are the same within this share of a triangle's edge.
constexpr double kSame = 0.1;
/// Share of the triangles off the change that must agree; else the patch was not made as the mesh was.
constexpr double kAgreement = 0.5;
/// At so many vertices an old mesh is checked for belonging to the function.
constexpr std::size_t kAsked = 500;

/// How a function is cut out.
struct Cut {
  double mesh_error;  ///< length of the field
  PolygonizeOptions meshing;
  BlockTree blocks;
};

Cut prepare_cut(const SurfaceFunction& function, const MeshOptions& options) {
  const PartitionOfUnity& field = function.field;
  const PartitionReport& f = field.report();
  const double mesh_error = options.mesh_error ? function.place.from_input(*options.mesh_error) : default_mesh_error(f);
  PolygonizeOptions meshing = detail::meshing_options(options, mesh_error, field.data().options.sharp);
  meshing.seeds = field.seeds();
  const bool coarse = options.mesh_error.has_value();
  const double gap = coarse && options.enhance
                         ? std::max(kCoarseBlocks * mesh_error, std::min(mesh_error, default_mesh_error(f)))
                         : mesh_error;
  return {mesh_error, std::move(meshing), field.mesh_blocks(gap, options.block_depth.value_or(BlockTree::kMaxLevel))};
}

/// Colours for the vertices of a patch from the samples around it.
void color_patch(TriangleMesh& patch, const PointSet& samples, double spacing) {
  Box3f box = bounds(patch);
  const float margin = static_cast<float>(8 * spacing);
  box.lower -= Vec3f{margin, margin, margin}, box.upper += Vec3f{margin, margin, margin};
  PointSet near;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (box.contains(samples.positions[i])) {
      near.positions.push_back(samples.positions[i]);
      near.colors.push_back(samples.colors[i]);
    }
  if (near.size() > 0) detail::carry_colors(patch, near, KdTree(near.positions));
}

/// Edge of the largest block in a box through which the surface may pass.
double largest_block(const Cut& cut, const Box3& box) {
  const BlockTree& tree = cut.blocks;
  const double scale = static_cast<double>(1u << tree.depth()) / tree.edge();
  double largest = tree.edge() / static_cast<double>(1u << tree.depth());
  for (const Vec3& seed : cut.meshing.seeds) {
    if (!box.contains(seed)) continue;
    const Vec3 p = (seed - tree.lower()) * scale;
    const std::int64_t at = tree.find(tree.depth(), static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y),
                                      static_cast<std::int64_t>(p.z));
    if (at >= 0) largest = std::max(largest, tree.block_edge(static_cast<std::size_t>(at)));
  }
  return largest;
}

/// A box that holds the feet of all supports that reach into a box: the surface in it is followed from these.
Box3 with_seeds(const PartitionData& data, const Box3& box) {
  const Box3f near{Vec3f(box.lower - data.origin), Vec3f(box.upper - data.origin)};
  Box3 all = box;
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    const LocalFunction& f = data.functions[i];
    bool reaches = true;
    for (std::size_t k = 0; k < 3; ++k)
      reaches = reaches && f.center[k] + f.radius >= near.lower[k] && f.center[k] - f.radius <= near.upper[k];
    if (reaches) all.extend(data.origin + Vec3(data.supports[i].foot));
  }
  return all;
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += norm(Vec3(mesh.vertices[t[0]] - mesh.vertices[t[1]]));
  return mesh.triangles.empty() ? 0 : sum / static_cast<double>(mesh.triangles.size());
}

/// Whether a mesh runs along the zero set of a function where it has not changed: some of its vertices are checked.
bool belongs_to(const TriangleMesh& mesh, const SurfaceFunction& function, const Box3& change) {
  std::vector<Vec3> x;
  const std::size_t stride = 1 + mesh.vertices.size() / kAsked;
  for (std::size_t v = 0; v < mesh.vertices.size(); v += stride)
    if (const Vec3 p(mesh.vertices[v]); !change.contains(p)) x.push_back(p);
  std::vector<double> f(x.size());
  function.field.evaluate(x, f);
  const double near = function.field.report().spacing;
  const auto on = std::count_if(f.begin(), f.end(), [&](double value) { return std::abs(value) <= near; });
  return static_cast<double>(on) >= kAgreement * static_cast<double>(x.size());
}

/// False: it could not be done, and the mesh is as it was.
bool update_in_place(const SurfaceFunction& function, TriangleMesh& mesh, const Box3& changed,
                     const MeshOptions& options, Progress& progress, MeshUpdate& u) {
  // In the coordinates of the field.
  TriangleMesh moved = mesh;
  move_from_input(moved, function.place);
  const Box3 change = function.place.from_input(changed);
  if (!belongs_to(moved, function, change)) return false;
  Cut cut = prepare_cut(function, options);
  // Whether the mesh was simplified, where that is not known beforehand: which of the two agrees with it.
  std::vector<bool> ways{cut.meshing.simplify > 0};
  if (ways[0] && detail::may_skip_simplification(cut.blocks.leaves().size(), options)) ways = {false, true};
  cut.blocks.balance();
  MeshReport report;
  const double edge = largest_block(cut, change);
  for (double margin = kMargin; margin <= kMostMargin; margin *= 2) {
    const Vec3 wide = Vec3{1, 1, 1} * (margin * edge);
    const Box3 region{change.lower - wide, change.upper + wide};
    const auto in_region = static_cast<std::size_t>(std::count_if(
        cut.meshing.seeds.begin(), cut.meshing.seeds.end(), [&](const Vec3& seed) { return region.contains(seed); }));
    if (static_cast<double>(in_region) > kMostWork * static_cast<double>(cut.meshing.seeds.size())) break;
    cut.meshing.region = region;
    for (const bool simplify : ways) {
      PolygonizeOptions meshing = cut.meshing;
      if (!simplify) meshing.simplify = 0;
      TriangleMesh patch = polygonize(function.field, cut.blocks, {}, meshing, progress);
      const bool colors = !moved.colors.empty() && function.samples->has_colors();
      if (colors) color_patch(patch, *function.samples, function.field.report().spacing);
      progress.begin("join");
      const RegionReplacement r =
          replace_region(moved, patch, {Vec3f(region.lower), Vec3f(region.upper)},
                         {Vec3f(change.lower), Vec3f(change.upper)}, static_cast<float>(kSame * mean_edge(patch)));
      if (r.agreement < kAgreement) continue;
      ways = {simplify};
      if (!r.done) break;  // a wider patch is needed
      if (moved.triangles.empty()) return false;
      u = {true, r.removed, r.added};
      detail::choose_components(moved, options.components, *function.samples, function.field.report().spacing, report);
      move_to_input(moved, function.place);
      mesh = std::move(moved);
      return true;
    }
  }
  return false;
}

}  // namespace

TriangleMesh mesh_function(const SurfaceFunction& function, const MeshOptions& options, Progress& progress,
                           MeshReport* report) {
  options.validate();
  MeshReport local;
  MeshReport& r = report ? *report : local;
  r = {};
  const PartitionOfUnity& field = function.field;
  const PartitionReport& f = field.report();
  const Placement& place = function.place;
  Cut cut = prepare_cut(function, options);
  r.mesh_error = place.to_input(cut.mesh_error);
  r.block_depth = cut.blocks.depth();
  std::optional<Box3> box;
  if (options.box) {
    box = place.from_input(*options.box);
    cut.meshing.region = with_seeds(field.data(), *box);
  }
  const PointSet& points = *function.samples;
  std::optional<double> trim;
  if (options.trim) {
    if (points.size() == 0) throw DataError("cannot be trimmed: its samples were not kept");
    trim = *options.trim > 0 ? place.from_input(*options.trim) : std::max(4 * f.spacing, 6 * f.noise);
  }
  std::optional<FunctionDomain> domain;
  if (FunctionDomain::needed(function, trim)) {
    progress.begin("find borders");
    std::optional<double> fill;
    if (options.fill_holes) fill = place.from_input(*options.fill_holes);
    domain.emplace(function, fill, trim);
    domain->refine(cut.blocks, options.block_depth.value_or(BlockTree::kMaxLevel));
    cut.meshing.domain = &*domain;
  }
  r.open = f.open_area > 0;
  TriangleMesh mesh = detail::cut_out(field, cut.blocks, options, cut.meshing, progress, r);

  progress.begin("finish mesh");
  MeshOptions finish = options;
  if (box) {
    clip_mesh(mesh, {Vec3f(box->lower), Vec3f(box->upper)});
    if (mesh.triangles.empty()) throw DataError("there is no surface in the box");
    // What the box cuts off says nothing about what a piece belongs to.
    if (finish.components.kind == ComponentChoice::Kind::automatic) finish.components.kind = ComponentChoice::Kind::all;
  }
  detail::finish_mesh(mesh, points, f.spacing, f.noise, cut.mesh_error, finish, r);
  detail::mark_confidence(mesh, points, f.spacing, f.noise, place, options, r);
  if (options.triangles && mesh.triangles.size() > *options.triangles)
    r.warnings.push_back(counted(mesh.triangles.size(), "triangle") + " instead of " + grouped(*options.triangles) +
                         ": each part, hole and handle needs some");
  // An edit takes away what samples stand for on purpose.
  if (r.most_lost && function.history.empty()) {
    r.most_lost = place.to_input(*r.most_lost);
    r.warnings.push_back(detail::lost_samples(r));
  }
  move_to_input(mesh, place);
  progress.finish();
  return mesh;
}

TriangleMesh update_mesh(const SurfaceFunction& function, TriangleMesh before, const Box3& changed,
                         const MeshOptions& options, Progress& progress, MeshUpdate* update) {
  options.validate();
  MeshUpdate local;
  MeshUpdate& u = update ? *update : local;
  u = {};
  if (changed.empty()) {
    u.local = true;
    return before;
  }
  // What depends on the whole mesh can only be made from the whole.
  const bool whole = options.triangles || options.trim || options.box || options.measure_quality ||
                     options.confidence.value_or(false) || FunctionDomain::needed(function, {});
  if (!whole && update_in_place(function, before, changed, options, progress, u)) return before;
  return mesh_function(function, options, progress);
}

double default_mesh_error(const PartitionReport& report) {
  return std::max(0.46 * report.accuracy, 0.037 * report.spacing);
}

}  // namespace sansmesh
