#include "sansmesh/mesh_function.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/error.h"
#include "sansmesh/mesh_steps.h"

namespace sansmesh {
namespace {

/// Least gap of the blocks, for a mesh error that was asked for, in its unit: a coarse mesh is made from a finer one.
constexpr double kCoarseBlocks = 0.5;

}  // namespace

void MeshOptions::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw ArgumentError(what);
  };
  check(!mesh_error || (std::isfinite(*mesh_error) && *mesh_error > 0), "mesh error must be a positive length");
  check(!triangles || (*triangles >= 4 && enhance),
        "the number of triangles must be at least 4, and needs enhancement");
  check(displacement >= 0 && displacement < 1, "displacement must lie in [0, 1)");
  check(displacement == 0 || !enhance, "displacement needs enhancement to be off: clustering undoes it");
  check(!trim || (std::isfinite(*trim) && *trim >= 0), "trim must be a length of at least 0");
  check(components.kind != ComponentChoice::Kind::count || components.count >= 1,
        "the number of components must be at least 1");
  check(!box || (is_finite(box->lower) && is_finite(box->upper) && !box->empty()),
        "a box must be finite, and its lower corner below its upper one");
  check(!block_depth || (*block_depth >= 2 && *block_depth <= 12), "the depth of the blocks must lie in 2..12");
}

TriangleMesh mesh_function(const SurfaceFunction& function, const MeshOptions& options, Progress& progress,
                           MeshReport* report) {
  options.validate();
  MeshReport local;
  MeshReport& r = report ? *report : local;
  const PartitionOfUnity& field = function.field;
  const PartitionReport& f = field.report();
  const double unit = function.unit;
  const double mesh_error = options.mesh_error ? *options.mesh_error / unit : default_mesh_error(f);
  r.mesh_error = mesh_error * unit;

  PolygonizeOptions meshing = detail::meshing_options(options, mesh_error, field.data().options.sharp);
  meshing.seeds = field.seeds();
  const bool coarse = options.mesh_error.has_value();
  const double gap = coarse && options.enhance
                         ? std::max(kCoarseBlocks * mesh_error, std::min(mesh_error, default_mesh_error(f)))
                         : mesh_error;
  const BlockTree blocks = field.mesh_blocks(gap);
  r.depth = blocks.depth();
  TriangleMesh mesh = detail::cut_out(field, blocks, options, meshing, progress, r);

  progress.begin("finish mesh");
  const PointSet& points = *function.samples;
  if (options.trim) {
    if (points.size() == 0) throw DataError("cannot be trimmed: its samples were not kept");
    const double close = std::max(4 * f.spacing, 6 * f.noise);
    const KdTree samples(points.positions);
    detail::trim_mesh(mesh, detail::near_samples(mesh, samples, *options.trim > 0 ? *options.trim / unit : close));
  }
  detail::finish_mesh(mesh, points, f.spacing, options, r);
  detail::to_input(mesh, function.origin, unit);
  progress.finish();
  return mesh;
}

double default_mesh_error(const PartitionReport& report) {
  return std::max(0.46 * report.accuracy, 0.037 * report.spacing);
}

}  // namespace sansmesh
