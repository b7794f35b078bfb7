#include "sansmesh/attribute_table.h"
#include "sansmesh/mesh/repair/fill_holes.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh/topology_words.h"

namespace sansmesh::inline v1 {
namespace {

/// Share of a component above which a filling that was chosen by default is reported.
constexpr double kWideShare = 0.1;

void add_stray_note(const HoleLoops& found, std::vector<Note>& notes) {
  if (found.stray_edges == 0) return;
  notes.push_back({.code = "stray_border",
                   .text = fmt::format(
                       "{} of the border end at edges with three or more triangles and enclose no hole: they stay open",
                       counted(found.stray_edges, "edge"))});
}

/// Note on openings left open, with the option that closes the widest.
Note ends_note(const FillReport& r) {
  double widest = 0;
  for (const HoleLoop& hole : r.found.loops)
    if (hole.outcome == HoleOutcome::end) widest = std::max(widest, hole.diameter);
  const char* const them = r.ends == 1 ? "it" : "them";
  return {.code = "ends",
          .text = fmt::format("{} open: the surface approaches {} steeply, as at the end of a tube",
                              r.ends == 1 ? "1 opening stays" : grouped(r.ends) + " openings stay", them),
          .remedy = fmt::format("`largest = {}` closes {}, `all` everything", length_words(widest * 1.01), them)};
}

std::size_t wide_fillings(const FillReport& r) {
  return static_cast<std::size_t>(std::count_if(r.found.loops.begin(), r.found.loops.end(), [](const HoleLoop& hole) {
    return hole.outcome == HoleOutcome::filled && hole.share > kWideShare;
  }));
}

}  // namespace

HolesResult list_holes(TriangleMesh mesh, Progress& progress) {
  HolesResult result;
  result.triangles = mesh.triangles.size();
  result.joined_vertices = join_equal_vertices(mesh).joined;
  progress.begin("find holes");
  result.holes = find_holes(mesh);
  add_stray_note(result.holes, result.notes);
  return result;
}

FillResult fill(TriangleMesh mesh, const FillOptions& options, Progress& progress) {
  options.validate();
  FillResult result;
  result.triangles = mesh.triangles.size();
  const JoinedVertices joined = join_equal_vertices(mesh);
  result.joined_vertices = joined.joined;
  result.mesh = std::move(mesh);
  const FillReport& r = result.report = fill_holes(result.mesh, options, progress);
  const auto note = [&](const char* code, std::string text) {
    result.notes.push_back({.code = code, .text = std::move(text)});
  };
  add_stray_note(r.found, result.notes);
  if (r.failed > 0)
    note("no_way_across",
         fmt::format("{} cannot be filled without an edge that is there already", counted(r.failed, "hole")));
  if (r.ends > 0) result.notes.push_back(ends_note(r));
  if (const std::size_t wide = wide_fillings(r); wide > 0)
    note("wide", fmt::format("{} wider than a tenth of the surrounding component: the filling has no data there",
                             wide == 1 ? "1 hole that was filled is" : grouped(wide) + " holes that were filled are"));
  if (r.islands > 0)
    note("islands", fmt::format("{} are in or near fillings, and stay there", counted(r.islands, "separate piece")));
  if (joined.seams > 0)
    note("seams", fmt::format("{} at the same place as another, with other colours or attributes: seams, but no holes",
                              joined.seams == 1 ? "1 vertex is" : grouped(joined.seams) + " vertices are"));
  return result;
}

const ReportSchema& HolesResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<&HolesResult::triangles>({.name = "input.triangles", .text = "Triangles of the mesh"}),
      reported<&HolesResult::joined_vertices>(
          {.name = "input.joined_vertices", .text = "Vertices merged with a coincident one"}),
      reported_inline<&HolesResult::holes>()};
  return report_schema<rows>();
}

const ReportSchema& FillResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<&FillResult::triangles>({.name = "input.triangles", .text = "Triangles of the original"}),
      reported<&FillResult::joined_vertices>(
          {.name = "input.joined_vertices", .text = "Vertices merged with a coincident one"}),
      reported_inline<&FillResult::report>()};
  return report_schema<rows>();
}

std::vector<std::string> summary_of(const HoleLoops& holes, std::size_t most) {
  std::vector<std::string> lines{
      fmt::format("{} with {}", counted(holes.loops.size(), "hole"), counted(holes.border_edges, "border edge"))};
  for (std::size_t i = 0; i < std::min(most, holes.loops.size()); ++i) {
    const HoleLoop& h = holes.loops[i];
    const std::string_view word = h.outcome ? kOutcomeWords[static_cast<std::size_t>(*h.outcome)] : "";
    lines.push_back(fmt::format("{:>6} edges, diameter {:<9} ({:.0f} % of its piece), perimeter {:<9} at {}{}{}",
                                grouped(h.vertices.size()), length_words(h.diameter), 100 * h.share,
                                length_words(h.perimeter), point_words(h.middle), word.empty() ? "" : ": ", word));
  }
  if (holes.loops.size() > most)
    lines.push_back(fmt::format("and {} smaller ones", grouped(holes.loops.size() - most)));
  return lines;
}

std::vector<std::string> summary_of(const FillResult& made, std::size_t most) {
  const FillReport& r = made.report;
  std::vector<std::string> lines = summary_of(r.found, most);
  lines.push_back(fmt::format("filled {}, left {} open; added {} and {} vertices, area {}", grouped(r.filled),
                              grouped(r.too_large + r.failed + r.ends), counted(r.triangles, "triangle"),
                              grouped(r.vertices), length_words(r.area)));
  lines.push_back(fmt::format("now {}, {}", counted(made.mesh.triangles.size(), "triangle"),
                              border_words(measure_topology(made.mesh))));
  return lines;
}

}  // namespace sansmesh::inline v1
