#include <fmt/core.h>

#include "sansmesh/core/number_words.h"
#include "sansmesh/jobs/solid_parts.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/solids.h"

namespace sansmesh::inline v1 {

CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress) {
  CsgMeshOptions own = options;
  if (!own.components) own.components = solid.default_components();
  CsgResult result;
  result.mesh = mesh_csg(solid.parts().solid, own, progress, &result.report);
  result.notes = solid.open_notes();
  add_notes(result.notes, result.report.notes);
  return result;
}

std::vector<std::string> summary_of(const CsgMeshReport& r) {
  std::string size = area_words(r.area, r.volume);
  if (r.largest_error > 0)
    size += fmt::format("; triangles {} off on average, at most {}", length_words(r.mean_error),
                        length_words(r.largest_error));
  return {
      fmt::format("{}, cells of {}, {}", size_words(r.box.size()), length_words(r.cell), counted(r.blocks, "block")),
      size};
}

}  // namespace sansmesh::inline v1
