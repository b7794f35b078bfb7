#include <fmt/core.h>

#include <optional>
#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/meshes/solid_parts.h"
#include "sansmesh/meshing/face_csg.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/solids.h"

namespace sansmesh::inline v1 {

CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress) {
  CsgMeshOptions own = options;
  if (!own.components) own.components = solid.default_components();
  CsgResult result;
  const CsgMesherChoice choice = choose_csg_mesher(solid.parts().outline, own);
  CsgMeshReport& report = result.report;
  report.reason = choice.reason;
  std::optional<TriangleMesh> made;
  if (choice.faces) made = mesh_of_faces(solid.parts().outline, own, progress, report);
  if (!made) {
    const std::string reason = report.reason;
    if (own.mesher == CsgMesher::faces) throw DataError(fmt::format("`mesher = faces`: {}", reason));
    made = mesh_csg(solid.parts().solid(), own, progress, &report);
    report.reason = reason;
  }
  result.mesh = std::move(*made);
  result.mesh.reference = solid.parts().reference;
  result.notes = solid.open_notes();
  add_notes(result.notes, result.report.notes);
  return result;
}

std::vector<std::string> summary_of(const CsgMeshReport& r) {
  std::string size = area_words(r.area, r.volume);
  if (r.largest_error > 0)
    size += fmt::format("; triangles {} off on average, at most {}", length_words(r.mean_error),
                        length_words(r.largest_error));
  const std::string how = r.mesher == CsgMesher::faces
                              ? fmt::format("exact on faces, {} cut, {} on seams", counted(r.cut_faces, "face"),
                                            counted(r.seam_vertices, "vertex"))
                              : fmt::format("cells of {}, {}", length_words(r.cell), counted(r.blocks, "block"));
  return {fmt::format("{}, {}", size_words(r.box.size()), how), size};
}

}  // namespace sansmesh::inline v1
