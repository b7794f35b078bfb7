#include "sansmesh/meshing/face_csg.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/number_words.h"
#include "sansmesh/csg/face_builder.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/booleans/mesh_booleans.h"
#include "sansmesh/mesh/booleans/thin_seams.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

/// With so many parts, operations on faces are several times as fast.
constexpr std::size_t kManyParts = 100;
/// Seams may move by this many rounding errors of floats.
constexpr double kRoundingSteps = 2;

/// Faces with equal vertices have common ones afterwards.
SolidFaces& join_equal(SolidFaces& faces, const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> first = first_equal_positions(mesh.vertices);
  for (Triangle& t : faces.triangles)
    for (std::uint32_t& v : t) v = first[v];
  std::erase_if(faces.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  return faces;
}

}  // namespace

CsgMesherChoice choose_csg_mesher(const Solid& solid, const CsgMeshOptions& options) {
  if (options.mesher == CsgMesher::function) return {false, "as requested"};
  const FaceSurvey survey = survey_faces(*solid.node());
  const bool must = options.mesher == CsgMesher::faces;
  if (!survey.obstacle.empty()) {
    if (must) throw ArgumentError(fmt::format("`mesher = faces`: {} has no faces", survey.obstacle));
    return {false, survey.obstacle + " has no faces"};
  }
  if (must) return {true, "as requested"};
  for (const auto& [given, name] : {std::pair(options.triangles.has_value(), "triangles"),
                                    {options.cell.has_value(), "cell"},
                                    {options.resolution.has_value(), "resolution"},
                                    {options.simplify.has_value(), "simplify"}})
    if (given) return {false, fmt::format("`{}` is given", name)};
  if (survey.meshes) return {true, "all parts have faces"};
  if (survey.curved && survey.parts < kManyParts) return {false, "curved primitives without a mesh"};
  if (survey.curved) return {true, fmt::format("{} parts", grouped(survey.parts))};
  return {true, "all parts have flat faces"};
}

std::optional<TriangleMesh> mesh_of_faces(const Solid& solid, const CsgMeshOptions& options, Progress& progress,
                                          CsgMeshReport& report) {
  const CancelScope listening(progress);
  options.validate();
  const Box3 box = box_of_solid(solid, options);
  const Solid whole = options.box ? solid_in_box(solid, *options.box) : solid;
  progress.begin("faces");
  const double mesh_error = options.mesh_error.value_or(kCsgMeshError * box.diagonal());
  SolidOfFaces parts = faces_of(*whole.node(), mesh_error, box);
  if (parts.too_many) {
    report.reason = "curved parts would need too many faces for the mesh error";
    return std::nullopt;
  }
  for (std::size_t p = 0; p < parts.parts.size(); ++p)
    if (parts.meshes[p] && !encloses(parts.parts[p]) && !encloses(join_equal(parts.parts[p], *parts.meshes[p]))) {
      report.reason = "a mesh has edges with unpaired faces";
      return std::nullopt;
    }
  BooleanResult made = combine_solids(parts.parts, parts.expression, progress);
  if (!made.closed) {
    report.reason = "intersections of a mesh with itself cannot be resolved";
    return std::nullopt;
  }
  if (made.triangles.empty()) throw DataError("the solid is empty");
  progress.begin("thin seams");
  double farthest = 0;
  for (Vec3& v : made.vertices) {
    v = Vec3(Vec3f(v));
    farthest = std::max({farthest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  const ThinnedSeams thinned = thin_seams(made, kRoundingSteps * 0x1p-24 * farthest);
  TriangleMesh mesh;
  mesh.origin = parts.origin;
  mesh.vertices.reserve(made.vertices.size());
  for (const Vec3& v : made.vertices) mesh.vertices.emplace_back(v);
  mesh.triangles = made.triangles;
  report.box = {};
  for (const Vec3& v : made.vertices) report.box.extend(v + parts.origin);
  report.mesher = CsgMesher::faces;
  report.mean_error = parts.curved ? mesh_error : 0;
  report.cut_faces = made.cut_triangles;
  report.seam_vertices = made.seam_vertices - thinned.removed;
  finish_csg(mesh, options, report);
  return mesh;
}

}  // namespace sansmesh::inline v1
