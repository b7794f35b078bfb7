#include "sansmesh/attribute_table.h"
#include "sansmesh/mesh/fill_holes.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/mesh/place_edges.h"

namespace sansmesh::inline v1 {
namespace {

/// Share of a piece from which on a hole that was filled by default is told of.
constexpr double kWideShare = 0.1;

void add_stray_note(const HoleLoops& found, std::vector<Note>& notes) {
  if (found.stray_edges == 0) return;
  notes.push_back({.code = "stray_border",
                   .text = fmt::format(
                       "{} of the border run to edges of three triangles or more, and around no hole: they stay open",
                       counted(found.stray_edges, "edge")),
                   .remedy = {}});
}

/// The widest of the openings that stay, and what closes it.
Note ends_note(const FillReport& r) {
  double widest = 0;
  for (std::size_t i = 0; i < r.outcome.size(); ++i)
    if (r.outcome[i] == FillReport::Outcome::end) widest = std::max(widest, r.found.loops[i].diameter);
  const char* const them = r.ends == 1 ? "it" : "them";
  return {.code = "ends",
          .text = fmt::format("{} open: the surface runs into {} steeply, as at the end of a tube",
                              r.ends == 1 ? "1 opening stays" : grouped(r.ends) + " openings stay", them),
          .remedy = fmt::format("`largest = {}` closes {}, `all` everything", length_words(widest * 1.01), them)};
}

std::size_t wide_fillings(const FillReport& r) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < r.outcome.size(); ++i)
    count += r.outcome[i] == FillReport::Outcome::filled && r.found.loops[i].share > kWideShare;
  return count;
}

}  // namespace

HolesResult list_holes(TriangleMesh mesh, Progress& progress) {
  HolesResult result;
  result.triangles = mesh.triangles.size();
  result.joined_vertices = join_places(mesh).joined;
  progress.begin("find holes");
  result.holes = find_holes(mesh);
  add_stray_note(result.holes, result.notes);
  return result;
}

FillResult fill(TriangleMesh mesh, const FillOptions& options, Progress& progress) {
  options.validate();
  FillResult result;
  result.triangles = mesh.triangles.size();
  const JoinedPlaces places = join_places(mesh);
  result.joined_vertices = places.joined;
  result.mesh = std::move(mesh);
  const FillReport& r = result.report = fill_holes(result.mesh, options, progress);
  const auto note = [&](const char* code, std::string text) {
    result.notes.push_back({.code = code, .text = std::move(text), .remedy = {}});
  };
  add_stray_note(r.found, result.notes);
  if (r.failed > 0)
    note("no_way_across",
         fmt::format("{} cannot be filled without an edge that is there already", counted(r.failed, "hole")));
  if (r.ends > 0) result.notes.push_back(ends_note(r));
  if (const std::size_t wide = wide_fillings(r); wide > 0)
    note("wide", fmt::format("{} wider than a tenth of the piece around: what lies across is invented",
                             wide == 1 ? "1 hole that was filled is" : grouped(wide) + " holes that were filled are"));
  if (r.islands > 0)
    note("islands",
         fmt::format("{} lie in or near what was filled, and stay there", counted(r.islands, "separate piece")));
  if (places.seams > 0)
    note("seams", fmt::format("{} at the same place as another, with other colours or attributes: seams, but no holes",
                              places.seams == 1 ? "1 vertex is" : grouped(places.seams) + " vertices are"));
  return result;
}

}  // namespace sansmesh::inline v1
