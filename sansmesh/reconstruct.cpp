#include "sansmesh/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/polygonize/components.h"
#include "sansmesh/polygonize/mesh_quality.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/sample_colors.h"

namespace sansmesh {
namespace {

/// Components go, unless all are asked for, whose samples stand for less than this share of what those of the largest
/// one stand for, or for less than this share of their own area (a part may well be scanned more sparsely than others).
constexpr double kSmallComponent = 0.01, kSupported = 0.02;
/// Samples that are enough to tell the components' shares.
constexpr std::size_t kSupportSamples = 100000;
/// Accepted quadric error of the simplification in units of the mesh error: the default, and for a mesh error that was
/// asked for; least gap of the blocks for the latter, in the same unit.
constexpr double kSimplify = 0.22, kCoarseSimplify = 1.8, kCoarseBlocks = 0.5;
/// By default a large mesh is left alone of which fewer than this share of the vertices could go at first: one that is
/// fine because the surface bends everywhere. Simplifying it would take as long as all the rest.
constexpr double kLeastGain = 0.35;
constexpr std::size_t kManyBlocks = 100000;
/// Mesh error of surfaces that do not know their own, over the spacing and the noise.
constexpr double kErrorOverSpacing = 0.037, kErrorOverNoise = 0.1;

std::string counted(std::size_t n, const char* noun) { return std::to_string(n) + " " + noun + (n == 1 ? "" : "s"); }

/// 1 for the vertices that have a sample within `limit`.
std::vector<std::uint8_t> near_samples(const TriangleMesh& mesh, const KdTree& samples, double limit) {
  std::vector<std::uint8_t> near(mesh.vertices.size());
  const auto limit2 = static_cast<float>(limit * limit);
  parallel_for(0, near.size(), 2048, [&](std::size_t v) {
    const auto found = samples.nearest(mesh.vertices[v]);
    near[v] = found && found->squared_distance <= limit2;
  });
  return near;
}

/// Cuts the surface where no sample is near.
void trim_mesh(TriangleMesh& mesh, const std::vector<std::uint8_t>& near) {
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    keep[i] = near[t[0]] && near[t[1]] && near[t[2]];
  }
  keep_triangles(mesh, keep);
  separate_fans(mesh);
}

/// Area of each component that samples stand for: the number of those nearest to it, times what each stands for.
std::vector<double> supported_area(const TriangleMesh& mesh, const MeshComponents& components, const PointSet& points,
                                   double spacing) {
  std::vector<std::uint32_t> of_vertex(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i]) of_vertex[v] = components.of_triangle[i];
  const KdTree vertices(mesh.vertices);
  const std::size_t stride = 1 + points.size() / kSupportSamples;
  std::vector<std::uint32_t> nearest((points.size() + stride - 1) / stride);
  const Vec3f shift(points.origin - mesh.origin);
  parallel_for(0, nearest.size(), 1024, [&](std::size_t i) {
    const auto found = vertices.nearest(points.positions[i * stride] + shift);
    nearest[i] = found ? of_vertex[found->index] : 0;
  });
  std::vector<double> area(components.size(), 0);
  for (const std::uint32_t c : nearest) area[c] += static_cast<double>(stride) * spacing * spacing;
  return area;
}

/// Keeps the components chosen. Stray samples far from the shape can make sheets larger than parts of it, so what
/// counts is the area that samples stand for; automatically, components go that have little of it.
void choose_components(TriangleMesh& mesh, const ComponentChoice& choice, const PointSet& points, double spacing,
                       ReconstructReport& report) {
  const MeshComponents components = find_components(mesh);
  const std::size_t count = components.size();
  report.components = static_cast<int>(count);
  if (choice.kind == ComponentChoice::Kind::all || count < 2) return;

  std::vector<double> supported = components.area;
  if (components.area[1] >= kSmallComponent * components.area[0])
    supported = supported_area(mesh, components, points, spacing);
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return supported[a] > supported[b]; });
  std::size_t kept = 0;
  std::vector<std::uint8_t> chosen(count, 0);
  for (const std::uint32_t k : order) {
    const bool automatic = choice.kind == ComponentChoice::Kind::automatic;
    if (!automatic && kept == static_cast<std::size_t>(choice.count)) break;
    if (automatic && kept > 0 &&
        (supported[k] < kSmallComponent * supported[order[0]] || supported[k] < kSupported * components.area[k]))
      continue;
    chosen[k] = 1;
    ++kept;
  }
  report.components = static_cast<int>(kept);
  if (kept == count) return;
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = chosen[components.of_triangle[i]];
  keep_triangles(mesh, keep);
  if (choice.kind == ComponentChoice::Kind::automatic)
    report.warnings.push_back(counted(count - kept, "component") +
                              " too small or too far from the samples left out (--components all keeps them)");
}

/// Each vertex takes the mean colour of the four nearest samples, weighted by inverse squared distance.
void carry_colors(TriangleMesh& mesh, const PointSet& points, const KdTree& samples) {
  mesh.colors.resize(mesh.vertices.size());
  parallel_for(0, mesh.vertices.size(), 2048, [&](std::size_t v) {
    const Vec3 color = mean_color(samples, points.colors, mesh.vertices[v]);
    for (std::size_t c = 0; c < 3; ++c)
      mesh.colors[v][c] = static_cast<std::uint8_t>(std::clamp(color[c] + 0.5, 0.0, 255.0));
  });
}

/// Without options of its own a mesh is cut out like this.
PolygonizeOptions meshing_options(const ReconstructOptions& options, double mesh_error) {
  PolygonizeOptions meshing;
  meshing.cluster = options.enhance;
  meshing.smoothing_rounds = options.enhance ? meshing.smoothing_rounds : 0;
  meshing.creases = options.sharp;
  meshing.displacement = options.displacement;
  // Blocks have sizes in powers of two, and triangles of one size in every direction: only edge collapses give each
  // place the triangles it needs. They cost more time than they save elsewhere, so by default only the cheap ones run;
  // where a coarse mesh is asked for, it is made from a finer one.
  if (options.enhance) {
    meshing.simplify = (options.mesh_error ? kCoarseSimplify : kSimplify) * mesh_error;
    meshing.triangles = options.triangles.value_or(0);
  }
  return meshing;
}

TriangleMesh cut_out(const ScalarField& field, const BlockTree& blocks, const ReconstructOptions& options,
                     PolygonizeOptions meshing, Progress& progress, ReconstructReport& r) {
  r.blocks = blocks.leaves().size();
  if (r.blocks > kManyBlocks && !options.mesh_error && !options.triangles) meshing.least_gain = kLeastGain;
  if (options.measure_quality) {
    PolygonizeOptions plain = meshing;
    plain.cluster = false;
    plain.creases = false;
    plain.smoothing_rounds = 0;
    plain.simplify = 0;
    plain.triangles = 0;
    plain.displacement = 0;
    const MeshQuality before = measure_quality(polygonize(field, blocks, {}, plain, progress));
    r.aspect_mean_before = before.aspect_mean;
    r.aspect_deviation_before = before.aspect_deviation;
  }
  return polygonize(field, blocks, {}, meshing, progress);
}

void finish_mesh(TriangleMesh& mesh, const PointSet& points, double spacing, const ReconstructOptions& options,
                 ReconstructReport& r) {
  choose_components(mesh, options.components, points, spacing, r);
  if (options.carry_colors && points.has_colors()) carry_colors(mesh, points, KdTree(points.positions));
  if (mesh.triangles.empty()) throw DataError("no surface was found near the samples");
  if (options.measure_quality) {
    const MeshQuality after = measure_quality(mesh);
    r.aspect_mean = after.aspect_mean;
    r.aspect_deviation = after.aspect_deviation;
  }
}

/// Back from the coordinates of a prepared cloud.
void to_input(TriangleMesh& mesh, const Vec3& origin, double unit) {
  for (Vec3f& v : mesh.vertices) v *= static_cast<float>(unit);
  mesh.origin = origin;
}

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
  PolygonizeOptions meshing = meshing_options(options, mesh_error);
  meshing.creases = choice.sharp;
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
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw ArgumentError(what);
  };
  check(!max_depth || (*max_depth >= 2 && *max_depth <= 12), "max depth must lie in 2..12");
  check(!error || (std::isfinite(*error) && *error > 0), "error must be a positive length");
  check(!support || (*support >= 1.1 && *support <= 2), "support must lie in 1.1..2");
  check(max_degree >= 1 && max_degree <= 4, "degree must lie in 1..4");
  check(!mesh_error || (std::isfinite(*mesh_error) && *mesh_error > 0), "mesh error must be a positive length");
  check(!triangles || (*triangles >= 4 && enhance),
        "the number of triangles must be at least 4, and needs enhancement");
  check(displacement >= 0 && displacement < 1, "displacement must lie in [0, 1)");
  check(displacement == 0 || !enhance, "displacement needs enhancement to be off: clustering undoes it");
  check(!trim || (std::isfinite(*trim) && *trim >= 0), "trim must be a length of at least 0");
  check(components.kind != ComponentChoice::Kind::count || components.count >= 1,
        "the number of components must be at least 1");
}

TriangleMesh reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress,
                         ReconstructReport* report) {
  options.validate();
  ReconstructReport local;
  ReconstructReport& r = report ? *report : local;
  r = {};
  if (options.surface) return reconstruct_surface(std::move(points), options, progress, r);
  PreparedCloud cloud =
      prepare_cloud(std::move(points), {options.faces, options.normals, options.remove_outliers}, progress);
  r.warnings = std::move(cloud.warnings);
  const double unit = cloud.unit;

  PartitionOptions fit;
  fit.max_depth = options.max_depth;
  if (options.error) fit.error = *options.error / unit;
  fit.support = options.support;
  fit.max_degree = options.max_degree;
  fit.sharp = options.sharp;
  const PartitionOfUnity field = fit_partition_of_unity(cloud.points, fit, progress);
  const PartitionReport& f = field.report();
  r.spacing = f.spacing * unit;
  r.noise = f.noise * unit;
  r.depth = f.depth;
  r.fits = f.functions;
  const double mesh_error = options.mesh_error ? *options.mesh_error / unit : default_mesh_error(f);
  r.mesh_error = mesh_error * unit;

  PolygonizeOptions meshing = meshing_options(options, mesh_error);
  meshing.seeds = field.seeds();
  const bool coarse = options.mesh_error.has_value();
  const double gap = coarse && options.enhance
                         ? std::max(kCoarseBlocks * mesh_error, std::min(mesh_error, default_mesh_error(f)))
                         : mesh_error;
  TriangleMesh mesh = cut_out(field, field.mesh_blocks(gap), options, meshing, progress, r);

  progress.begin("finish mesh");
  if (options.trim) {
    const double close = std::max(4 * f.spacing, 6 * f.noise);
    const KdTree samples(cloud.points.positions);
    trim_mesh(mesh, near_samples(mesh, samples, *options.trim > 0 ? *options.trim / unit : close));
  }
  finish_mesh(mesh, cloud.points, f.spacing, options, r);
  to_input(mesh, cloud.origin, unit);
  progress.finish();
  return mesh;
}

double default_mesh_error(const PartitionReport& report) {
  return std::max(0.46 * report.accuracy, 0.037 * report.spacing);
}

}  // namespace sansmesh
