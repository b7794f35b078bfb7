#include "sansmesh/attribute_table.h"
#include "sansmesh/inspect.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/option.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "sansmesh/mesh/sewn_mesh.h"
#include "sansmesh/points/face_shape.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSamples = 300'000, kSamplesOfOthers = 5'000;
/// Surfaces that differ in size by more than this are not of the same thing.
constexpr double kOtherUnit = 100;

/// How many to take. From the middle of a much larger surface all of it is about as near, so that each sample there
/// costs as much as all of its triangles: a few tell as much.
std::size_t samples_for(const AssessOptions& options, const TriangleMesh& mesh, const TriangleMesh& reference,
                        std::vector<Note>& notes) {
  const double own = bounds(mesh).diagonal(), other = bounds(reference).diagonal();
  const bool larger = own > other;
  const double ratio = larger ? own / other : other / own;
  if (!(ratio > kOtherUnit) || !std::isfinite(ratio)) return options.samples.value_or(kSamples);
  notes.push_back({.code = "other_unit",
                   .text = fmt::format("{:.4g} times as {} as the reference: are both in the same unit?", ratio,
                                       larger ? "large" : "small"),
                   .remedy = {}});
  return options.samples.value_or(kSamplesOfOthers);
}

}  // namespace

const OptionSchema& AssessOptions::schema() {
  using O = AssessOptions;
  static constexpr OptionRow rows[] = {
      option<&O::samples>({.text = "Samples on each mesh", .from_data = "300000", .range = {1, 2'000'000'000}})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void AssessOptions::validate() const { validate_options(*this); }

AssessResult assess(const TriangleMesh& mesh, Progress& progress) {
  AssessResult result;
  AssessReport& r = result.report;
  r.vertices = mesh.vertices.size();
  if (mesh.triangles.empty()) return result;
  progress.begin("topology and quality");
  const SewnMesh sewn = sewn_mesh(mesh);
  r.topology = sewn_topology(sewn);
  r.quality = measure_quality(sewn.mesh);
  return result;
}

AssessResult assess(const TriangleMesh& mesh, PointSet points, const AssessOptions& options, Progress& progress) {
  options.validate();
  AssessResult result = assess(mesh, progress);
  PointSet samples;
  if (!mesh.triangles.empty() && (points.triangles.empty() || vertices_are_dense(points))) {
    samples.origin = points.origin;
    samples.positions = points.positions;
  }
  const TriangleMesh reference = to_mesh(std::move(points));
  DistanceOptions distance;
  distance.samples = samples_for(options, mesh, reference, result.notes);
  result.report.distance = measure_distance(mesh, reference, distance, progress);
  if (samples.size() > 0) result.report.coverage = measure_coverage(mesh, samples, distance.samples, progress);
  return result;
}

}  // namespace sansmesh::inline v1
