#include "sansmesh/attribute_table.h"
#include "sansmesh/inspect.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/option.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/mesh/repair/sewn_mesh.h"
#include "sansmesh/mesh/topology_words.h"
#include "sansmesh/points/shape/face_shape.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSamples = 300'000, kSamplesOfOthers = 5'000;
/// Size ratio above which the units are probably different.
constexpr double kOtherUnit = 100;

/// Number of samples. From the middle of a much larger surface, all of the surface is at nearly the same distance, so
/// each sample costs as much as all triangles; few samples suffice.
std::size_t samples_for(const AssessOptions& options, const TriangleMesh& mesh, const TriangleMesh& reference,
                        std::vector<Note>& notes) {
  const double own = bounds(mesh).diagonal(), other = bounds(reference).diagonal();
  const bool larger = own > other;
  const double ratio = larger ? own / other : other / own;
  if (!(ratio > kOtherUnit) || !std::isfinite(ratio)) return options.samples.value_or(kSamples);
  notes.push_back({.code = "other_unit",
                   .text = fmt::format("{:.4g} times as {} as the reference: are both in the same unit?", ratio,
                                       larger ? "large" : "small")});
  return options.samples.value_or(kSamplesOfOthers);
}

}  // namespace

const OptionSchema& AssessOptions::schema() {
  using O = AssessOptions;
  static constexpr OptionRow rows[] = {
      option<&O::samples>({.text = "Samples on each mesh", .from_data = "300000", .range = {1, 2'000'000'000}})};
  return option_schema<rows>();
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
  require_same_system(mesh.reference.get(), "the surface", points.reference.get(), "the reference");
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

const ReportSchema& AssessReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const AssessReport& r) { return value_if(!r.topology, r.vertices); }>(
          {.name = "surface.points", .text = "Points, if there are no triangles"}),
      reported<&AssessReport::topology>({.text = "Connectivity of the triangles"}),
      reported<&AssessReport::quality>({.text = "Shape quality of the triangles"}),
      reported<[](const AssessReport& r) {
        return value_if(r.topology && r.topology->encloses(), r.quality ? r.quality->volume : 0);
      }>({.name = "quality.volume", .text = "Volume, if the mesh is closed", .unit = "length³"}),
      reported<[](const AssessReport& r) {
        return r.distance ? std::optional(r.distance->to_reference) : std::nullopt;
      }>({.name = "to_reference", .text = "Distances to the reference: accuracy"}),
      reported<[](const AssessReport& r) {
        return r.distance ? std::optional(r.distance->from_reference) : std::nullopt;
      }>({.name = "from_reference", .text = "Distances from the reference: completeness"}),
      reported<[](const AssessReport& r) { return r.distance ? std::optional(r.distance->diagonal) : std::nullopt; }>(
          {.name = "reference.diagonal", .text = "Diagonal of the reference's box", .unit = "length"}),
      reported<&AssessReport::coverage>({.text = "Samples without a surface, and surface without samples"})};
  return report_schema<rows>();
}

namespace {

/// "0.12 % of the samples: farther than 0.5 from the mesh, most of it around (1, 2, 3)".
std::string far_words(const FarPoints& f, const char* of, const char* from) {
  return fmt::format("{} of the {}: farther than {} from {}{}",
                     f.share > 0 && f.share < 5e-5 ? "less than 0.01 %" : fmt::format("{:.2f} %", 100 * f.share), of,
                     length_words(f.beyond), from, f.densest ? ", most of it around " + point_words(*f.densest) : "");
}

}  // namespace

std::vector<std::string> summary_of(const AssessReport& r) {
  std::vector<std::string> lines;
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text)); };
  if (r.topology && r.quality) {
    const MeshQuality& q = *r.quality;
    line("topology", topology_words(*r.topology));
    line("triangles", fmt::format("aspect ratio {:.3f} ± {:.3f} (worst {:.3g}), mean smallest angle {:.1f}°, "
                                  "{:.3f} % of triangles below 10°",
                                  q.aspect_mean, q.aspect_deviation, q.aspect_max, q.smallest_angle_mean,
                                  100 * q.small_angle_share));
    line("size", "area " + length_words(q.area) + (r.topology->encloses() ? ", volume " + length_words(q.volume) : ""));
  }
  if (r.distance) {
    line("to reference", distance_words(r.distance->to_reference, *r.distance));
    line("from reference", distance_words(r.distance->from_reference, *r.distance));
    lines.emplace_back("(in brackets: % of the diagonal of the reference's bounding box)");
  }
  if (r.coverage) {
    line("lost", far_words(r.coverage->lost, "samples", "the mesh"));
    line("invented", far_words(r.coverage->invented, "area", "every sample"));
  }
  return lines;
}

}  // namespace sansmesh::inline v1
