#include "sansmesh/attribute_table.h"
#include "sansmesh/inspect.h"
#include "sansmesh/measure/distance_map.h"
#include "sansmesh/option.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <string>
#include <string_view>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/refine_edges.h"

namespace sansmesh::inline v1 {
namespace {

/// Edges longer than this part of the diagonal make a map of vertices a coarse one.
constexpr double kCoarse = 0.02;

bool is_coarse(const TriangleMesh& mesh, double diagonal) {
  double edges = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges += norm(Vec3(mesh.vertices[t[k]]) - Vec3(mesh.vertices[t[(k + 1) % 3]]));
  return !mesh.triangles.empty() && edges / (3 * static_cast<double>(mesh.triangles.size())) > kCoarse * diagonal;
}

/// Cuts large triangles up if that is asked for.
void refine(TriangleMesh& mesh, const std::string& name, const std::optional<double>& edge, double diagonal,
            Progress& progress, std::vector<Note>& notes) {
  if (edge) {
    progress.begin("refine");
    if (!refine_edges(mesh, *edge))
      notes.push_back(
          {.code = "edges_stay_long",
           .text = fmt::format("edges stay longer than {}: more than 20 million triangles", length_words(*edge)),
           .remedy = {},
           .of = name});
  } else if (is_coarse(mesh, diagonal)) {
    notes.push_back({.code = "coarse",
                     .text = "has large triangles, and only their corners are compared",
                     .remedy = "`refine` cuts them up",
                     .of = name});
  }
}

}  // namespace

const OptionSchema& CompareOptions::schema() {
  using O = CompareOptions;
  static constexpr std::string_view sides[] = {"part", "reference"};
  static const OptionRow rows[] = {
      option_group<&O::map>(DistanceMapOptions::schema().rows),
      option<&O::on>({.text = "Draw the map on the part or the reference; the sign stays the part's",
                      .unit = "choice",
                      .choices = sides}),
      option<&O::refine>(
          {.text = "First halve edges of the mapped mesh until none is longer", .unit = "length", .range = positive()}),
      option<&O::align>({.text = "First move the part onto the reference"}),
      option_group<&O::alignment>(SurfaceAlignmentOptions::schema().rows)};
  static const OptionSchema schema{rows};
  return schema;
}

void CompareOptions::validate() const {
  validate_options(*this);
  if (align) return;
  if (const auto set = options_set(alignment); !set.empty())
    throw ArgumentError(fmt::format("`{}` means nothing without `align`", set.front()));
}

CompareResult compare(const AnySurface& part, const AnySurface& reference, const CompareOptions& options,
                      Progress& progress) {
  options.validate();
  const bool reversed = options.on == MapSide::reference;
  if (options.align && part.field() && reversed)
    throw ArgumentError("`align` moves meshes and points: with `on = reference`, the part may not be a function");
  CompareResult result;
  CompareReport& r = result.report;
  AnySurface moved = part, still = reference;
  if (options.align) {
    AlignResult aligned = sansmesh::align(part, reference, options.alignment, progress);
    moved = AnySurface(std::move(aligned.moved), part.name());
    // So that the mesh of an isosurface is made once.
    if (reference.kind() == AnySurface::Kind::isosurface) still = AnySurface(*aligned.fixed, reference.name());
    r.alignment = std::move(aligned.report);
    r.motion = aligned.motion;
    result.notes = std::move(aligned.notes);
  }
  const AnySurface& mapped = reversed ? still : moved;
  const AnySurface& other = reversed ? moved : still;
  result.mesh = *mapped.mesh(progress, result.notes);
  r.diagonal = reference.bounds().diagonal();
  refine(result.mesh, mapped.name(), options.refine, r.diagonal, progress, result.notes);

  progress.begin("prepare");
  const std::shared_ptr<const SignedDistance> distance = other.distance(progress, result.notes);
  DistanceMapOptions map = options.map;
  map.reversed = reversed;
  if (!map.max_distance && r.diagonal > 0) map.max_distance = 0.1 * r.diagonal;
  result.map = with_name(mapped.name(), [&] { return distance_map(result.mesh, *distance, map, progress); });
  if (!result.map.has_sides)
    result.notes.push_back({.code = "no_sign",
                            .text = "distances have no sign: " + other.name() + " is points without normals",
                            .remedy = {},
                            .of = mapped.name()});
  apply_map(result.mesh, result.map, result.map.statistics.range);
  return result;
}

}  // namespace sansmesh::inline v1
