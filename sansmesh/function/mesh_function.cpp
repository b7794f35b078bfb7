#include "sansmesh/function/mesh_function.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/error.h"
#include "sansmesh/function/function_cut.h"
#include "sansmesh/function/function_domain.h"
#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/polygonize/lattice/walk_surface.h"

namespace sansmesh::inline v1 {
namespace {

/// A box that contains the feet of all supports that reach into a box: starting points for the surface in it.
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

/// Walks from the simplices at the samples, or at the feet of the supports if the samples were not kept.
TriangleMesh walked(const FittedFunction& function, const MeshOptions& options, const BlockTree& blocks,
                    Progress& progress, MeshReport& r) {
  const PartitionOfUnity& field = function.field;
  WalkOptions walk;
  const PointSet& points = *function.samples;
  if (points.size() > 0) {
    walk.seeds.reserve(points.size());
    for (const Vec3f& p : points.positions) walk.seeds.push_back(points.origin + Vec3(p));
  } else {
    walk.seeds = field.seeds();
  }
  if (options.measure_quality) {
    const MeshQuality before = measure_quality(walk_surface(field, blocks, {}, walk, progress));
    r.aspect_mean_before = before.aspect_mean;
    r.aspect_deviation_before = before.aspect_deviation;
  }
  walk.displacement = options.displacement;
  WalkReport report;
  TriangleMesh mesh = walk_surface(field, blocks, {}, walk, progress, &report);
  r.simplices = report.simplices;
  return mesh;
}

}  // namespace

TriangleMesh mesh_function(const FittedFunction& function, const MeshOptions& options, Progress& progress,
                           MeshReport* report) {
  options.validate();
  const bool walks = is_walked(function, options);
  if (walks) options.validate_walk();
  if (!walks && options.enhance && options.displacement > 0)
    throw ArgumentError("`displacement` needs `enhance = false` or `mesher = walk`: clustering undoes it");
  MeshReport local;
  MeshReport& r = report ? *report : local;
  r = {};
  const PartitionOfUnity& field = function.field;
  const PartitionReport& f = field.report();
  const LocalFrame& frame = function.frame;
  detail::FunctionCut cut = detail::prepare_cut(function, options, default_mesh_error(f));
  r.mesh_error = frame.to_input(cut.mesh_error);
  std::optional<Box3> box;
  if (options.box) {
    box = frame.from_input(*options.box);
    cut.meshing.regions = {with_seeds(field.data(), *box)};
  }
  const PointSet& points = *function.samples;
  std::optional<double> trim;
  if (options.trim) {
    if (points.size() == 0) throw DataError("cannot be trimmed: its samples were not kept");
    trim = *options.trim > 0 ? frame.from_input(*options.trim) : std::max(4 * f.spacing, 6 * f.noise);
  }
  std::optional<FunctionDomain> domain;
  if (FunctionDomain::needed(function, trim)) {
    progress.begin("find borders");
    std::optional<double> fill;
    if (options.fill_holes) fill = frame.from_input(*options.fill_holes);
    domain.emplace(function, fill, trim);
    domain->refine(cut.blocks, options.block_depth.value_or(BlockTree::kMaxLevel));
    cut.meshing.domain = &*domain;
  }
  r.block_depth = cut.blocks.depth();
  r.open = f.open_area > 0;
  TriangleMesh mesh;
  if (walks) {
    if (r.open) throw DataError("the surface is open, and walks make closed surfaces only");
    BlockTree blocks = std::move(cut.blocks);
    blocks.balance();
    r.blocks = blocks.leaves().size();
    mesh = walked(function, options, blocks, progress, r);
  } else {
    mesh = detail::cut_out(field, cut.blocks, options, cut.meshing, progress, r);
  }

  progress.begin("finish mesh");
  MeshOptions finish = options;
  if (box) {
    clip_mesh(mesh, {Vec3f(box->lower), Vec3f(box->upper)});
    if (mesh.triangles.empty()) throw DataError("there is no surface in the box");
    // Cuts by the box are irrelevant for the choice of components.
    if (finish.components.kind == ComponentChoice::Kind::automatic) finish.components.kind = ComponentChoice::Kind::all;
  }
  detail::finish_mesh(mesh, points, f.spacing, f.noise, cut.mesh_error, frame, finish, r);
  detail::mark_confidence(mesh, points, f.spacing, f.noise, frame, options, r);
  if (options.triangles && mesh.triangles.size() > *options.triangles)
    r.notes.push_back(detail::too_many_triangles(mesh.triangles.size(), *options.triangles));
  // An edit removes the surface of samples on purpose.
  if (!function.history.empty()) std::erase_if(r.notes, [](const Note& n) { return n.code == detail::kLostSamples; });
  move_to_input(mesh, frame);
  progress.finish();
  return mesh;
}

bool is_walked(const FittedFunction& function, const MeshOptions& options) {
  return options.mesher == Mesher::walk ||
         (options.mesher == Mesher::automatic && function.field.data().paper.has_value());
}

double default_mesh_error(const PartitionReport& report) {
  return std::max(0.46 * report.accuracy, 0.037 * report.spacing);
}

}  // namespace sansmesh::inline v1
