#include "sansmesh/deform/cuts/open_mesh.h"

#include <cmath>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/deform/cuts/cut_faces.h"
#include "sansmesh/deform/cuts/slit.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kFaceEdges = 3;  // over the mean length: faces are flat, and finer where they meet the mesh

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0, n = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a >= mesh.vertices.size() || b >= mesh.vertices.size()) continue;
      const double length = norm(Vec3(mesh.vertices[b]) - Vec3(mesh.vertices[a]));
      if (std::isfinite(length)) sum += length, n += 1;
    }
  return n > 0 ? sum / n : 0;
}

/// Moves the origin to the mesh's centre along axes along which the mesh is farther from its origin than its size:
/// vertices keep their exact positions, and new ones are rounded less.
void bring_origin_near(TriangleMesh& mesh) {
  const Box3 box = finite_bounds({}, mesh.vertices);
  if (box.empty()) return;
  Vec3f by;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(box.center()[k]) > box.diagonal()) by[k] = static_cast<float>(box.center()[k]);
  if (by == Vec3f{}) return;
  mesh.origin += Vec3(by);
  for (Vec3f& v : mesh.vertices) v = v - by;
}

}  // namespace

void OpenMeshOptions::validate() const {
  if (refinements < 0 || refinements > 12) throw ArgumentError("`refinements` must lie in 0..12");
  if (face_edges && !(*face_edges > 0 && std::isfinite(*face_edges)))
    throw ArgumentError("`face_edges` must be a positive length, not " + std::to_string(*face_edges));
}

TriangleMesh open_along_cuts(TriangleMesh mesh, std::span<const std::shared_ptr<const Occluder>> cuts,
                             const OpenMeshOptions& options, OpenMeshReport* report) {
  options.validate();
  OpenMeshReport own;
  OpenMeshReport& r = report ? *report : own;
  r = {};
  const bool solid = options.close && measure_topology(mesh).closed();
  const double length = options.face_edges.value_or(solid ? kFaceEdges * mean_edge(mesh) : 0);
  const bool inward = solid && measure_size(mesh).volume < 0;
  bool closed = solid;  // the mesh is still closed
  if (!cuts.empty()) bring_origin_near(mesh);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const std::shared_ptr<const Occluder>& cut = cuts[i];
    const Slit slit = open_slit(mesh, cuts.first(i + 1), options.refinements);
    r.edges += slit.edges.size(), r.doubled += slit.doubled, r.unopened += slit.unopened;
    if (!options.close || slit.edges.empty()) continue;
    const auto* const planar = dynamic_cast<const PlanarOccluder*>(cut.get());
    const std::size_t added = solid && planar ? add_cut_faces(mesh, slit, *planar, length, inward) : 0;
    r.faces += added;
    const bool whole = added > 0 && (!closed || measure_topology(mesh).closed());
    closed = closed && whole, r.unclosed += !whole;
    if (added > 0) mesh.normals.clear();
  }
  return mesh;
}

namespace {

constexpr ReportRow kOpenMeshReportRows[] = {
    reported<&OpenMeshReport::edges>({.text = "Edges along which the mesh was opened"}),
    reported<&OpenMeshReport::faces>({.text = "Triangles of cut faces"}),
    reported<&OpenMeshReport::unopened>({.text = "Triangles that could not be opened"}),
    reported<&OpenMeshReport::unclosed>({.text = "Cuts that left the mesh open"})};

}  // namespace

const ReportSchema& OpenMeshReport::schema() {
  static constexpr ReportSchema schema{kOpenMeshReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
