#include "sansmesh/reconstruct.h"

#include <algorithm>
#include <string>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/model/surface_domain.h"

namespace sansmesh {
namespace {

using namespace detail;

/// Mesh error of surfaces that do not know their own, over the spacing and the noise.
constexpr double kErrorOverSpacing = 0.037, kErrorOverNoise = 0.1;

constexpr const char* kKeepAll = "; `components = all` keeps every part";

PreparedCloud prepare(PointSet points, const CloudUse& use, Progress& progress, ReconstructReport& r) {
  PreparedCloud cloud = prepare_cloud(std::move(points), use, progress);
  r.estimated_normals = cloud.estimated_normals;
  r.oriented_by = cloud.oriented_by;
  r.alignment = cloud.alignment;
  return cloud;
}

/// The surface asked for, with those options of the fit that it heeds.
SurfaceOptions surface_options(const ReconstructOptions& options) {
  SurfaceOptions o = *options.surface;
  const SurfaceMethodInfo& info = surface_method_info(o.method);
  if (options.error && info.heeds(SurfaceOption::error)) o.error = options.error;
  if (options.max_depth && info.heeds(SurfaceOption::max_depth)) o.max_depth = options.max_depth;
  if (!options.sharp && info.heeds(SurfaceOption::smooth)) o.smooth = true;
  return o;
}

/// A surface that was not made for it, as a mesh: cut out in blocks as fine as the samples where it bends, and cut off
/// where these end.
TriangleMesh reconstruct_surface(PointSet points, const ReconstructOptions& options, Progress& progress,
                                 ReconstructReport& r) {
  const SurfaceOptions choice = surface_options(options);
  const SurfaceModel model = make_surface_model(prepare(std::move(points), options, progress, r), choice, progress);
  r.warnings = model.warnings();
  r.spacing = model.report().spacing;
  r.noise = model.report().noise;
  const Placement& place = model.place();
  const double spacing = place.from_input(r.spacing);
  const double mesh_error = options.mesh_error
                                ? place.from_input(*options.mesh_error)
                                : std::max(kErrorOverSpacing * spacing, place.from_input(kErrorOverNoise * r.noise));
  r.mesh_error = place.to_input(mesh_error);
  PolygonizeOptions meshing = meshing_options(options, mesh_error, model.creases());
  const ScalarField& field = model.field(progress);
  meshing.placement = model.placement(progress);
  meshing.seeds = model.seeds();
  PointSet feet = model.feet(progress);
  progress.begin("choose blocks");
  BlockTree blocks = model.blocks_for(feet, mesh_error);
  progress.begin("find borders");
  std::optional<double> fill, trim;
  if (options.fill_holes) fill = std::min(place.from_input(*options.fill_holes), blocks.edge());
  if (options.trim)
    trim = *options.trim > 0 ? place.from_input(*options.trim) : std::max(4 * spacing, 6 * place.from_input(r.noise));
  std::optional<bool> solid;
  if (options.open) solid = !*options.open;
  // Beyond those of the samples they are of what closes holes.
  feet.positions.resize(std::min(feet.size(), model.points().size()));
  feet.normals.resize(feet.size());
  const SurfaceDomain domain(field, feet, spacing, fill, trim, solid, model.closes_holes());
  domain.refine(blocks, options.block_depth.value_or(BlockTree::kMaxLevel));
  if (trim || !domain.solid() || !model.closes_holes()) meshing.domain = &domain;
  r.open = domain.ends();
  r.block_depth = blocks.depth();
  TriangleMesh mesh = cut_out(field, blocks, options, meshing, progress, r);

  progress.begin("finish mesh");
  finish_mesh(mesh, model.points(), spacing, place.from_input(r.noise), mesh_error, options, r);
  mark_confidence(mesh, model.points(), spacing, place.from_input(r.noise), place, options, r);
  if (r.most_lost) {
    r.most_lost = place.to_input(*r.most_lost);
    r.warnings.push_back(lost_samples(r) + kKeepAll);
  }
  move_to_input(mesh, place);
  progress.finish();
  return mesh;
}

}  // namespace

void ReconstructOptions::validate() const {
  if (surface) surface->validate();
  if (other_surface()) {
    const FitOptions none;
    const SurfaceMethodInfo& info = surface_method_info(surface->method);
    const auto unset = [&](bool ok, const char* field, std::optional<SurfaceOption> heeded = {}) {
      if (!ok && !(heeded && info.heeds(*heeded)))
        throw ArgumentError("`" + std::string(field) + "` belongs to the partition, not to the surface " + info.name);
    };
    unset(!is_paper(), "fit = paper");
    unset(mesher != Mesher::walk, "mesher = walk");
    unset(!threshold, "threshold");
    unset(!coverage, "coverage");
    unset(!max_depth, "max_depth", SurfaceOption::max_depth);
    unset(!error, "error", SurfaceOption::error);
    unset(!support, "support");
    unset(max_degree == none.max_degree, "max_degree");
    unset(sharp == none.sharp, "sharp = false", SurfaceOption::smooth);
  }
  FitOptions::validate();
  MeshOptions::validate();
  const bool walks = mesher == Mesher::walk || (mesher == Mesher::automatic && is_paper());
  if (walks) validate_walk();
  if (!walks && enhance && displacement > 0)
    throw ArgumentError("`displacement` needs `enhance = false`: clustering undoes it");
}

TriangleMesh reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress,
                         ReconstructReport* report) {
  options.validate();
  ReconstructReport local;
  ReconstructReport& r = report ? *report : local;
  r = {};
  if (options.other_surface()) return reconstruct_surface(std::move(points), options, progress, r);
  const SurfaceFunction function =
      fit_surface_function(prepare(std::move(points), options, progress, r), options, progress);
  const PartitionReport& f = function.field.report();
  TriangleMesh mesh = mesh_function(function, options, progress, &r);
  r.spacing = function.place.to_input(f.spacing);
  r.noise = function.place.to_input(f.noise);
  r.fits = f.functions;
  r.fit_depth = f.depth;
  r.fits_of_degree = f.functions_of_degree;
  r.paper = function.paper;
  r.open_share = f.area > 0 ? f.open_area / f.area : 0;
  r.behind = f.behind;
  if (r.most_lost && !r.warnings.empty())
    r.warnings.back() += r.open_share < 1 ? "; `open = true` ends the surface where they end" : kKeepAll;
  r.warnings.insert(r.warnings.begin(), function.warnings.begin(), function.warnings.end());
  return mesh;
}

}  // namespace sansmesh
