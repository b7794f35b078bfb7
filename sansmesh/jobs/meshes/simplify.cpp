#include "sansmesh/attribute_table.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/option.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh/topology_words.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kDefaultRatio = 0.5;
/// Share of the diagonal above which a distance is reported.
constexpr double kFarOff = 0.01;
/// Shape bounds for a number of triangles, best first: a worse one only if the number requires it.
constexpr double kShapes[] = {kLeastShapeOfNumber, 0};
constexpr double kShapeOfError = 0.3;  ///< shape bound for an error
constexpr double kMostTriangles = 2'000'000'000;

/// A simplified mesh with its distance from the original.
struct Simplified {
  TriangleMesh mesh;
  SurfaceDistance distance;
  double shape = 0;  ///< least shape of new triangles

  double farthest() const { return std::max(distance.to_reference.max, distance.from_reference.max); }
  double rms() const { return std::max(distance.to_reference.rms, distance.from_reference.rms); }
  bool far_off() const { return distance.diagonal > 0 && farthest() > kFarOff * distance.diagonal; }
};

Simplified simplified(TriangleMesh mesh, const TriangleMesh& original, const SimplifyOptions& asked,
                      CollapseOptions options, Progress& progress) {
  progress.begin("simplify");
  for (const double shape : kShapes) {
    options.least_shape = asked.triangle_shape.value_or(asked.error ? kShapeOfError : shape);
    if (!mesh.triangles.empty()) simplify_mesh(mesh, options, progress);
    if (asked.triangle_shape || asked.error || mesh.triangles.size() <= options.triangles) break;
  }
  Simplified made{std::move(mesh), {}, options.least_shape};
  made.distance = measure_distance(made.mesh, original, DistanceOptions{}, progress);
  return made;
}

Note seams_note(std::size_t seams) {
  return {.code = "seams",
          .text = fmt::format("{} coincident with another, but with other colours or attributes: seams may open",
                              seams == 1 ? "1 vertex is" : grouped(seams) + " vertices are")};
}

Note more_triangles_note(const TriangleMesh& mesh, std::size_t wanted) {
  const std::size_t stay = measure_topology(mesh).nonmanifold_edges;
  return {.code = "more_triangles",
          .text = fmt::format("{} instead of {} triangles: no other edge can be collapsed{}",
                              grouped(mesh.triangles.size()), grouped(wanted),
                              stay > 0 ? fmt::format(" ({} with three or more triangles stay)", counted(stay, "edge"))
                                       : ", or the shape would change")};
}

Note far_off_note(const SimplifyOptions& asked, const Simplified& made) {
  const SurfaceDistance& d = made.distance;
  const std::size_t triangles = made.mesh.triangles.size();
  Note note{.code = "far_off",
            .text = fmt::format("up to {} off, {:.1f} % of the diagonal (rms {:.2f} %): {} {} too few for all of its "
                                "shape",
                                length_words(made.farthest()), d.percent(made.farthest()), d.percent(made.rms()),
                                counted(triangles, "triangle"), triangles == 1 ? "is" : "are")};
  if (asked.triangle_shape.value_or(0) > 0)
    note.remedy = "`triangle_shape = 0` allows thinner ones, which may be closer";
  else if (!asked.error)
    note.remedy = "`error` sets the allowed distance";
  return note;
}

}  // namespace

const OptionSchema& SimplifyOptions::schema() {
  using O = SimplifyOptions;
  static constexpr OptionRow rows[] = {
      option<&O::triangles>({.text = "Target number of triangles", .range = {4, kMostTriangles}}),
      option<&O::ratio>(
          {.text = "Target share of the triangles", .unit = "share", .from_data = "0.5", .range = {0, 1, true, true}}),
      option<&O::error>({.text = "Fewest triangles within this distance of the original (rms, at each vertex)",
                         .unit = "length",
                         .range = positive()}),
      option<&O::triangle_shape>({.text = "Least shape of new triangles: 0 any, 0.3 angles of 10°, 0.56 of 20°",
                                  .unit = "share",
                                  .from_data = "0.01, 0 if necessary; with --error 0.3",
                                  .range = {0, 0.9},
                                  .old_name = "shape"})};
  return option_schema<rows>();
}

void SimplifyOptions::validate() const {
  validate_options(*this);
  if ((triangles ? 1 : 0) + (ratio ? 1 : 0) + (error ? 1 : 0) > 1)
    throw ArgumentError("give only one of `triangles`, `ratio` and `error`");
}

SimplifyResult simplify(TriangleMesh mesh, const SimplifyOptions& options, Progress& progress) {
  options.validate();
  SimplifyResult result;
  const TriangleMesh original = mesh;
  const JoinedVertices joined = join_equal_vertices(mesh);
  result.report.vertices = original.vertices.size(), result.report.triangles = original.triangles.size();
  result.report.joined_vertices = joined.joined;
  if (joined.seams > 0) result.notes.push_back(seams_note(joined.seams));
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return !has_valid_corners(mesh.vertices, t); });
  keep_triangles(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1));  // also drops vertices without triangles
  CollapseOptions collapse;
  collapse.error = options.error.value_or(0);
  if (!options.error)
    collapse.triangles = options.triangles.value_or(index_in<std::size_t>(
        std::round(options.ratio.value_or(kDefaultRatio) * static_cast<double>(original.triangles.size())), 4,
        std::max<std::size_t>(4, original.triangles.size())));
  Simplified best = simplified(std::move(mesh), original, options, collapse, progress);
  if (collapse.triangles > 0 && best.mesh.triangles.size() > collapse.triangles)
    result.notes.push_back(more_triangles_note(best.mesh, collapse.triangles));
  if (best.far_off()) result.notes.push_back(far_off_note(options, best));
  result.report.distance = best.distance;
  result.report.least_shape = best.shape;
  result.mesh = std::move(best.mesh);
  return result;
}

const ReportSchema& SimplifyReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&SimplifyReport::vertices>({.name = "input.vertices", .text = "Vertices of the original"}),
      reported<&SimplifyReport::triangles>({.name = "input.triangles", .text = "Triangles of the original"}),
      reported<&SimplifyReport::joined_vertices>({.text = "Vertices merged with a coincident one"}),
      reported<[](const SimplifyReport& r) { return r.distance.to_reference; }>(
          {.name = "to_original", .text = "Distances from the result to the original"}),
      reported<[](const SimplifyReport& r) { return r.distance.from_reference; }>(
          {.name = "from_original", .text = "Distances from the original to the result"}),
      reported<[](const SimplifyReport& r) { return r.distance.diagonal; }>(
          {.name = "diagonal", .text = "Diagonal of the original's box", .unit = "length"}),
      reported<&SimplifyReport::least_shape>({.text = "Least shape of new triangles"})};
  return report_schema<rows>();
}

std::vector<std::string> summary_of(const SimplifyResult& made) {
  const SimplifyReport& r = made.report;
  const std::size_t triangles = made.mesh.triangles.size();
  const double share = static_cast<double>(triangles) / static_cast<double>(std::max<std::size_t>(r.triangles, 1));
  std::vector<std::string> lines{
      fmt::format("{}, {} vertices", counted(r.triangles, "triangle"), grouped(r.vertices)),
      fmt::format("now {} ({:.2f} %), {} vertices, {}", counted(triangles, "triangle"), 100 * share,
                  grouped(made.mesh.vertices.size()), border_words(measure_topology(made.mesh))),
      titled("to original", distance_words(r.distance.to_reference, r.distance)),
      titled("from original", distance_words(r.distance.from_reference, r.distance)),
      "(in brackets: % of the diagonal of the original's bounding box)"};
  return lines;
}

}  // namespace sansmesh::inline v1
