#include "sansmesh/mesh/mesh_coverage.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kLostSpacings = 2, kLostNoises = 4, kInventedSpacings = 4;
/// Radius in spacings within which far points are counted, and number of tested centres.
constexpr double kTogether = 30;
constexpr std::size_t kTestedCenters = 300;
constexpr std::size_t kCoverageChunk = 512;  // number of points per chain of hints

/// Computes the share of far points, and the one around which most of them are.
void sum_up(std::span<const Vec3f> points, std::span<const std::uint8_t> is_far, const Vec3& origin, double spacing,
            FarPoints& result) {
  result.tested = points.size();
  std::vector<Vec3f> far;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_far[i]) far.push_back(points[i]);
  if (far.empty()) return;
  result.share = static_cast<double>(far.size()) / static_cast<double>(points.size());
  const KdTree tree(far);
  const std::size_t stride = 1 + far.size() / kTestedCenters;
  std::vector<std::size_t> around((far.size() + stride - 1) / stride);
  parallel_for(0, around.size(), 4, [&](std::size_t i) {
    around[i] = tree.count_within(far[i * stride], static_cast<float>(kTogether * spacing));
  });
  const auto center = std::max_element(around.begin(), around.end()) - around.begin();
  result.densest = origin + Vec3(far[static_cast<std::size_t>(center) * stride]);
}

/// 1 for points, translated by `shift`, that are farther than `beyond` from a mesh.
std::vector<std::uint8_t> far_from(const ClosestTriangle& mesh, std::span<const Vec3f> points, const Vec3& shift,
                                   double beyond) {
  std::vector<std::uint8_t> is_far(points.size());
  parallel_ranges(0, points.size(), kCoverageChunk, [&](std::size_t first, std::size_t last) {
    ClosestTriangle::Hit hit;
    for (std::size_t i = first; i < last; ++i) {
      if (!is_finite(points[i])) continue;
      hit = mesh.closest(Vec3(points[i]) + shift, hit);
      is_far[i] = hit.squared_distance > beyond * beyond;
    }
  });
  return is_far;
}

}  // namespace

double lost_beyond(double spacing, double noise) { return std::max(kLostSpacings * spacing, kLostNoises * noise); }

std::vector<std::uint8_t> far_samples(const TriangleMesh& mesh, const PointSet& samples, double beyond) {
  return far_from(ClosestTriangle(mesh), samples.positions, samples.origin - mesh.origin, beyond);
}

FarPoints find_lost(const TriangleMesh& mesh, const PointSet& samples, double spacing, double noise, std::size_t most) {
  FarPoints result;
  result.beyond = lost_beyond(spacing, noise);
  const std::size_t stride = 1 + (samples.size() - std::min<std::size_t>(samples.size(), 1)) / most;
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < samples.size(); i += stride)
    if (is_finite(samples.positions[i])) points.push_back(samples.positions[i]);
  const auto is_far = far_from(ClosestTriangle(mesh), points, samples.origin - mesh.origin, result.beyond);
  sum_up(points, is_far, samples.origin, spacing, result);
  return result;
}

FarPoints find_invented(const TriangleMesh& mesh, const PointSet& samples, double spacing, std::size_t count) {
  FarPoints result;
  result.beyond = kInventedSpacings * spacing;
  const Vec3 shift = mesh.origin - samples.origin;
  std::vector<Vec3f> on_mesh;
  for (const FaceSample& s : sample_triangles(mesh.vertices, mesh.triangles, count))
    on_mesh.emplace_back(s.position + shift);
  const KdTree tree(samples.positions);
  const auto limit2 = static_cast<float>(result.beyond * result.beyond);
  std::vector<std::uint8_t> is_far(on_mesh.size());
  parallel_for(0, on_mesh.size(), kCoverageChunk, [&](std::size_t i) {
    const auto found = tree.nearest(on_mesh[i]);
    is_far[i] = !found || found->squared_distance > limit2;
  });
  sum_up(on_mesh, is_far, samples.origin, spacing, result);
  return result;
}

MeshCoverage measure_coverage(const TriangleMesh& mesh, const PointSet& samples, std::size_t count,
                              Progress& progress) {
  if (count < 1) throw ArgumentError("`samples` must be at least 1");
  progress.begin("spacing and noise");
  PointSet finite;
  finite.origin = samples.origin;
  for (const Vec3f& p : samples.positions)
    if (is_finite(p)) finite.positions.push_back(p);
  if (finite.size() == 0) throw DataError("the cloud has no finite points");
  MeshCoverage coverage;
  coverage.spacing = estimate_spacing(finite);
  coverage.noise = estimate_noise(finite);
  progress.begin("samples without a surface");
  coverage.lost = find_lost(mesh, finite, coverage.spacing, coverage.noise);
  progress.begin("surface without samples");
  coverage.invented = find_invented(mesh, finite, coverage.spacing, count);
  progress.finish();
  return coverage;
}

namespace {

constexpr ReportRow kFarPointsRows[] = {
    reported<&FarPoints::share>({.text = "Share of far points", .unit = "share"}),
    reported<&FarPoints::tested>({.name = "looked_at", .text = "Number of tested points"}),
    reported<&FarPoints::beyond>({.text = "Distance from which a point is far", .unit = "length"}),
    reported<&FarPoints::densest>(
        {.name = "most_around", .text = "Point around which most far points are", .unit = "length"})};

}  // namespace

const ReportSchema& FarPoints::schema() {
  static constexpr ReportSchema schema{kFarPointsRows};
  return schema;
}

namespace {

constexpr ReportRow kMeshCoverageRows[] = {
    reported<&MeshCoverage::spacing>({.text = "Spacing of the samples", .unit = "length"}),
    reported<&MeshCoverage::noise>({.text = "Noise of the samples", .unit = "length"}),
    reported<&MeshCoverage::lost>({.text = "Samples without a surface"}),
    reported<&MeshCoverage::invented>({.text = "Surface without samples"})};

}  // namespace

const ReportSchema& MeshCoverage::schema() {
  static constexpr ReportSchema schema{kMeshCoverageRows};
  return schema;
}

}  // namespace sansmesh::inline v1
