#include "sansmesh/attribute_table.h"
#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/functions.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/function/mesh_function.h"

namespace sansmesh::inline v1 {
namespace {

/// Throws DataError unless the mesh is one of the function.
void check_mesh(const EditInput& input) {
  if (input.mesh->triangles.empty()) throw DataError(input.mesh_name + ": has no triangles");
  const MeshMatch match = match_mesh(input.function.fitted(), *input.mesh);
  if (match.belongs()) return;
  throw DataError(
      fmt::format("{}: is not a mesh of {}: {} of {} tested vertices {} on that surface, the farthest "
                  "is about {} off, at {}",
                  input.mesh_name, input.name, grouped(match.on), grouped(match.vertices), match.on == 1 ? "is" : "are",
                  length_words(match.farthest), point_words(match.farthest_at, 9)));
}

}  // namespace

EditedFunction edit(EditInput input, const std::vector<Edit>& edits, bool make_mesh, Progress& progress) {
  if (input.mesh) check_mesh(input);
  std::vector<EditReport> steps;
  FunctionEditor editor(input.function.fitted());
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const std::string step = fmt::format("step {}: ", i + 1);
    try {
      steps.push_back(editor.apply(edits[i], progress));
    } catch (const ArgumentError& error) {
      throw ArgumentError(step + error.what());
    } catch (const DataError& error) {
      throw DataError(input.name + ": " + step + error.what());
    }
  }
  EditedFunction result{.function = SurfaceFunction(editor.function()), .steps = std::move(steps)};
  try {
    if (make_mesh)
      result.mesh = input.mesh ? update_mesh(editor.function(), std::move(*input.mesh), editor.changed(), {}, progress,
                                             &result.update)
                               : mesh_function(editor.function(), {}, progress);
  } catch (const DataError& error) {
    throw DataError(input.name + ": after the edits: " + error.what());
  }
  return result;
}

const ReportSchema& EditedFunction::schema() {
  static constexpr ReportRow rows[] = {
      reported<&EditedFunction::steps>({.text = "Edits in order"}),
      reported<[](const EditedFunction& r) { return r.function.fitted().field.report().functions; }>(
          {.name = "fits", .text = "Local fits of the function"}),
      reported<[](const EditedFunction& r) { return value_if(!r.mesh.triangles.empty(), r.update); }>(
          {.name = "update", .text = "Update of the mesh, if requested"})};
  return report_schema<rows>();
}

std::string words_of(const EditReport& r) {
  if (r.changed.empty()) return r.what;
  const std::size_t apart = separate_sets(r.regions);
  return fmt::format("{}, {}within {}", r.what, apart > 1 ? fmt::format("in {} regions ", grouped(apart)) : "",
                     size_words(r.changed.size()));
}

std::string words_of(const MeshUpdate& update, std::size_t triangles) {
  if (!update.local) return ", all new: " + update.why;
  if (update.regions == 0) return ", unchanged";
  const double kept = 1 - static_cast<double>(update.added) / static_cast<double>(triangles);
  return fmt::format(", of which {} are new{}; {:.1f} % kept", grouped(update.added),
                     update.regions > 1 ? fmt::format(", in {} regions", grouped(update.regions)) : std::string(),
                     std::floor(1000 * kept) / 10);
}

}  // namespace sansmesh::inline v1
