#include "sansmesh/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/points/clean_samples.h"
#include "sansmesh/points/duplicates.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/points/orientation.h"
#include "sansmesh/points/sample_faces.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/polygonize/components.h"
#include "sansmesh/polygonize/mesh_quality.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

/// Components go, unless all are asked for, whose samples stand for less than this share of what those of the largest
/// one stand for, or for less than this share of their own area (a part may well be scanned more sparsely than others).
constexpr double kSmallComponent = 0.01, kSupported = 0.02;
/// Samples that are enough to tell the components' shares.
constexpr std::size_t kSupportSamples = 100000;
/// A local fit takes this many samples.
constexpr std::size_t kFewest = 9;
/// Samples of the faces of a mesh whose vertices are not enough.
constexpr std::size_t kFaceSamples = 400000;
/// Accepted quadric error of the simplification in units of the mesh error: the default, and for a mesh error that was
/// asked for; least gap of the blocks for the latter, in the same unit.
constexpr double kSimplify = 0.22, kCoarseSimplify = 1.8, kCoarseBlocks = 0.5;
/// By default a large mesh is left alone of which fewer than this share of the vertices could go at first: one that is
/// fine because the surface bends everywhere. Simplifying it would take as long as all the rest.
constexpr double kLeastGain = 0.35;
constexpr std::size_t kManyBlocks = 100000;

std::string counted(std::size_t n, const char* noun) { return std::to_string(n) + " " + noun + (n == 1 ? "" : "s"); }

void clean(PointSet& points, ReconstructReport& report) {
  const std::size_t given = points.size();
  const SampleCleaning cleaned = clean_samples(points);
  const auto warn = [&](std::size_t n, const char* why) {
    if (n > 0) report.warnings.push_back(counted(n, "sample") + " left out: " + why);
  };
  warn(cleaned.non_finite, "position or normal not finite");
  warn(cleaned.far_away, "far away from all others");
  warn(cleaned.duplicates, "at the position of another sample");
  if (given > 1 && points.size() == 1) throw DataError("all points coincide: there is no surface to reconstruct");
}

/// Works in a unit in which the cloud is about 1 large, a power of two so that nothing is rounded: squares and sixth
/// powers of lengths then stay within float whatever the unit of the input.
double normalise(PointSet& points) {
  const Vec3f size = bounds(points).size();
  const double unit = std::exp2(std::ceil(std::log2(static_cast<double>(std::max({size.x, size.y, size.z})))));
  const auto factor = static_cast<float>(1 / unit);
  for (Vec3f& p : points.positions) p *= factor;
  for (Vec3f& p : points.scanners) p *= factor;
  points.origin = {};
  return unit;
}

void check_shape(const PointSet& points) {
  if (points.size() < kFewest)
    throw DataError("only " + counted(points.size(), "point") + ": at least " + std::to_string(kFewest) +
                    " are needed");
  switch (classify_shape(points)) {
    case CloudShape::empty:
      throw DataError("no finite points");
    case CloudShape::point:
      throw DataError("all points coincide: there is no surface to reconstruct");
    case CloudShape::line:
      throw DataError("all points lie on one line: there is no surface to reconstruct");
    case CloudShape::plane:
      throw DataError("all points lie in one plane: a closed surface cannot be reconstructed");
    case CloudShape::volume:
      break;
  }
}

/// Faces as samples where the vertices are not enough, and as the source of normals.
void use_faces(PointSet& points, ReconstructOptions::Faces faces, ReconstructReport& report) {
  using Faces = ReconstructOptions::Faces;
  if (points.triangles.empty() || faces == Faces::ignore) return;
  const bool forced = faces == Faces::sample;
  if (forced || !vertices_suffice(points)) {
    PointSet samples = sample_faces(points, kFaceSamples);
    if (samples.size() == 0) return;
    points = std::move(samples);
    if (!forced) report.warnings.push_back("its vertices alone are too sparse: its faces were sampled instead");
  } else if (!points.has_normals()) {
    set_normals_from_faces(points);
  }
}

void prepare_normals(PointSet& points, ReconstructOptions::Normals choice, Progress& progress,
                     ReconstructReport& report) {
  using Normals = ReconstructOptions::Normals;
  if (choice == Normals::as_given) {
    if (!points.has_normals()) throw DataError("there are no normals to be taken as given");
    return;
  }
  if (choice == Normals::estimate) points.normals.clear();
  NormalOptions estimation;
  OrientationOptions orientation;
  progress.begin("check normals");
  switch (check_orientation(points)) {
    case OrientationCheck::oriented:
      return;
    case OrientationCheck::inward:
      report.warnings.push_back("the normals point inward: turned round");
      for (Vec3f& n : points.normals) n = -n;
      return;
    case OrientationCheck::missing:
      progress.begin("estimate normals");
      estimation.spacing = estimate_spacing(points);
      estimation.noise = orientation.noise = estimate_noise(points);
      estimate_normals(points, estimation, progress);
      break;
    case OrientationCheck::unoriented:
      report.warnings.push_back("the normals are not oriented consistently: oriented anew");
      break;
  }
  progress.begin("orient normals");
  orient_normals(points, orientation, progress);
}

/// 1 for the vertices that have a sample within `limit`.
std::vector<std::uint8_t> near_samples(const TriangleMesh& mesh, const PointSet& points, const KdTree& samples,
                                       double limit) {
  std::vector<std::uint8_t> near(mesh.vertices.size());
  const Vec3f shift(mesh.origin - points.origin);
  const auto limit2 = static_cast<float>(limit * limit);
  parallel_for(0, near.size(), 2048, [&](std::size_t v) {
    const auto found = samples.nearest(mesh.vertices[v] + shift);
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
    std::array<Neighbour, 4> found;
    const std::size_t count = samples.nearest(mesh.vertices[v], found);
    double sum[3] = {}, weight = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double w = 1 / (static_cast<double>(found[k].squared_distance) +
                            1e-12 * static_cast<double>(found[count - 1].squared_distance) + 1e-30);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += w * points.colors[found[k].index][c];
      weight += w;
    }
    for (std::size_t c = 0; c < 3; ++c)
      mesh.colors[v][c] = static_cast<std::uint8_t>(std::clamp(sum[c] / weight + 0.5, 0.0, 255.0));
  });
}

}  // namespace

void ReconstructOptions::validate() const {
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
  progress.begin("check samples");
  clean(points, r);
  use_faces(points, options.faces, r);
  check_shape(points);
  const Vec3 origin = points.origin;
  const double unit = normalise(points);
  prepare_normals(points, options.normals, progress, r);

  PartitionOptions fit;
  fit.max_depth = options.max_depth;
  if (options.error) fit.error = *options.error / unit;
  fit.support = options.support;
  fit.max_degree = options.max_degree;
  fit.sharp = options.sharp;
  const PartitionOfUnity field = fit_partition_of_unity(points, fit, progress);
  const PartitionReport& f = field.report();
  r.spacing = f.spacing * unit;
  r.noise = f.noise * unit;
  r.depth = f.depth;
  r.fits = f.functions;
  const double mesh_error = options.mesh_error ? *options.mesh_error / unit : default_mesh_error(f);
  r.mesh_error = mesh_error * unit;

  PolygonizeOptions meshing;
  meshing.cluster = options.enhance;
  meshing.smoothing_rounds = options.enhance ? meshing.smoothing_rounds : 0;
  meshing.creases = options.sharp;
  meshing.displacement = options.displacement;
  meshing.seeds = field.seeds();
  // Blocks have sizes in powers of two, and triangles of one size in every direction: only edge collapses give each
  // place the triangles it needs. They cost more time than they save elsewhere, so by default only the cheap ones run;
  // where a coarse mesh is asked for, it is made from a finer one.
  const bool coarse = options.mesh_error.has_value();
  if (options.enhance) {
    meshing.simplify = (coarse ? kCoarseSimplify : kSimplify) * mesh_error;
    meshing.triangles = options.triangles.value_or(0);
  }
  const double gap = coarse && options.enhance
                         ? std::max(kCoarseBlocks * mesh_error, std::min(mesh_error, default_mesh_error(f)))
                         : mesh_error;
  const BlockTree blocks = field.mesh_blocks(gap);
  r.blocks = blocks.leaves().size();
  if (r.blocks > kManyBlocks && !coarse && !options.triangles) meshing.least_gain = kLeastGain;
  if (options.measure_quality) {
    PolygonizeOptions plain = meshing;
    plain.cluster = false;
    plain.creases = false;
    plain.smoothing_rounds = 0;
    plain.simplify = 0;
    plain.triangles = 0;
    plain.displacement = 0;
    const MeshQuality before = measure_quality(polygonize(field, blocks, points.origin, plain, progress));
    r.aspect_mean_before = before.aspect_mean;
    r.aspect_deviation_before = before.aspect_deviation;
  }
  TriangleMesh mesh = polygonize(field, blocks, points.origin, meshing, progress);

  progress.begin("finish mesh");
  const double close = std::max(4 * f.spacing, 6 * f.noise);
  const bool color = options.carry_colors && points.has_colors();
  const KdTree samples = options.trim || color ? KdTree(points.positions) : KdTree();
  if (options.trim)
    trim_mesh(mesh, near_samples(mesh, points, samples, *options.trim > 0 ? *options.trim / unit : close));
  choose_components(mesh, options.components, points, f.spacing, r);
  if (color) carry_colors(mesh, points, samples);
  if (mesh.triangles.empty()) throw DataError("no surface was found near the samples");
  if (options.measure_quality) {
    const MeshQuality after = measure_quality(mesh);
    r.aspect_mean = after.aspect_mean;
    r.aspect_deviation = after.aspect_deviation;
  }
  for (Vec3f& v : mesh.vertices) v *= static_cast<float>(unit);
  mesh.origin = origin;
  progress.finish();
  return mesh;
}

double default_mesh_error(const PartitionReport& report) {
  return std::max(0.46 * report.accuracy, 0.037 * report.spacing);
}

}  // namespace sansmesh
