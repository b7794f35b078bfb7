#include "sansmesh/reconstruct.h"

#include <algorithm>

#include "sansmesh/core/error.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"

namespace sansmesh {
namespace {

using namespace detail;

/// Mesh error of surfaces that do not know their own, over the spacing and the noise.
constexpr double kErrorOverSpacing = 0.037, kErrorOverNoise = 0.1;

/// A surface that was not made for it, as a mesh: cut out in blocks as fine as the samples, and trimmed where it leaves
/// its domain of definition.
TriangleMesh reconstruct_surface(PointSet points, const ReconstructOptions& options, Progress& progress,
                                 ReconstructReport& r) {
  SurfaceOptions choice = *options.surface;
  choice.faces = options.faces;
  choice.normals = options.normals;
  choice.remove_outliers = options.remove_outliers;
  const SurfaceModel model = make_surface_model(std::move(points), choice, progress);
  r.warnings = model.warnings();
  r.spacing = model.report().spacing;
  r.noise = model.report().noise;
  const double unit = model.unit(), spacing = r.spacing / unit;
  const double mesh_error = options.mesh_error
                                ? *options.mesh_error / unit
                                : std::max(kErrorOverSpacing * spacing, kErrorOverNoise * r.noise / unit);
  r.mesh_error = mesh_error * unit;
  PolygonizeOptions meshing = meshing_options(options, mesh_error, choice.sharp);
  meshing.placement = model.placement();
  meshing.seeds = model.seeds();
  const BlockTree blocks = model.blocks(1);
  r.depth = blocks.depth();
  TriangleMesh mesh = cut_out(model.field(), blocks, options, meshing, progress, r);

  progress.begin("finish mesh");
  std::vector<Vec3> x(mesh.vertices.begin(), mesh.vertices.end());
  std::vector<double> values(x.size());
  std::vector<std::uint8_t> inside(x.size());
  model.field().evaluate_in_domain(x, values, {}, inside);
  if (std::find(inside.begin(), inside.end(), 0) != inside.end()) trim_mesh(mesh, inside);
  if (options.trim && *options.trim > 0)
    trim_mesh(mesh, near_samples(mesh, KdTree(model.points().positions), *options.trim / unit));
  finish_mesh(mesh, model.points(), spacing, options, r);
  to_input(mesh, model.origin(), unit);
  progress.finish();
  return mesh;
}

}  // namespace

void ReconstructOptions::validate() const {
  if (surface) surface->validate();
  FitOptions::validate();
  MeshOptions::validate();
}

TriangleMesh reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress,
                         ReconstructReport* report) {
  options.validate();
  ReconstructReport local;
  ReconstructReport& r = report ? *report : local;
  r = {};
  if (options.surface) return reconstruct_surface(std::move(points), options, progress, r);
  const SurfaceFunction function = fit_surface_function(std::move(points), options, progress);
  const PartitionReport& f = function.field.report();
  r.spacing = f.spacing * function.unit;
  r.noise = f.noise * function.unit;
  r.fits = f.functions;
  TriangleMesh mesh = mesh_function(function, options, progress, &r);
  r.depth = f.depth;
  r.warnings.insert(r.warnings.begin(), function.warnings.begin(), function.warnings.end());
  return mesh;
}

}  // namespace sansmesh
