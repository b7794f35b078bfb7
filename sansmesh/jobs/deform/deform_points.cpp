// Deformation of clouds and meshes.
#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/deform/cuts/open_mesh.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/deform/deform_parts.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::array<std::uint8_t, 3> kFoldedColor{222, 30, 30}, kDefaultColor{222, 214, 204};

/// Colours vertices red where the map reverses orientation.
void color_folded(TriangleMesh& mesh, const SpaceMap& map) {
  const std::vector<Vec3> x = world_points(mesh.origin, mesh.vertices);
  std::vector<Jacobian> jacobians(x.size());
  map.query({.points = x}, {.gradients = jacobians});
  if (mesh.colors.empty()) mesh.colors.assign(x.size(), kDefaultColor);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Jacobian& j = jacobians[i];
    if (dot(j[0], cross(j[1], j[2])) <= 0) mesh.colors[i] = kFoldedColor;
  }
}

std::string number_of(std::size_t n, bool vertices) { return counted(n, vertices ? "vertex" : "point"); }

void report_moves(const MeshDeformReport& moves, DeformReport& r) {
  r.added = moves.added, r.fine = moves.fine, r.undefined = moves.undefined, r.turned = moves.turned;
}

void add_mesh_notes(const DeformReport& r, bool mesh, const std::string& name, std::vector<Note>& notes) {
  const auto note = [&](const char* code, std::string text, const char* remedy = "") {
    notes.push_back({.code = code, .text = std::move(text), .remedy = remedy, .of = name});
  };
  if (!r.fine) note("bends_stay", "too many triangles to refine all edges that bend", "a larger `refine`");
  if (r.undefined > 0)
    note("undefined", fmt::format("{} do not move: the map is not defined there", number_of(r.undefined, mesh)));
  if (r.turned > 0)
    note("turned", fmt::format("{} of {} are where space folds", grouped(r.turned), number_of(r.vertices, mesh)));
  if (r.cut && r.cut->unopened > 0)
    note("uncut",
         fmt::format("{} were not cut: a cut crosses them in too many places", counted(r.cut->unopened, "triangle")));
  if (r.cut && r.cut->unclosed > 0)
    note("cut_open", "the mesh stays open along a cut: only half-planes and polygons are closed by faces");
}

}  // namespace

DeformResult deform(const PointSet& points, const std::string& name, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress) {
  options.validate(aim, deformation);
  const bool mesh = !points.triangles.empty(), picture = aim == DeformAim::picture;
  if (aim == DeformAim::sections) throw ArgumentError("sections need functions or solids");
  if (!mesh && options.refine) throw ArgumentError("`refine` is for meshes: the input has no faces");
  MeshDeformOptions bent;
  bent.bend = options.refine;
  const Box3 before = bounds_of(points);
  const std::vector<Vec3> framed = picture ? points_of_poses(deformation, before, options, true) : std::vector<Vec3>();
  DeformResult result;
  DeformReport& r = result.report;
  TriangleMesh opened;  // along cuts; clouds do not change
  if (mesh || picture) opened = to_mesh(points);
  if (mesh && !deformation.cuts().empty()) {
    progress.begin("open");
    OpenMeshOptions open;
    open.close = !options.cut_open && measure_topology(opened).closed();
    opened = open_along_cuts(std::move(opened), deformation.cuts(), open, &r.cut.emplace());
  }
  FoldWatch folds;
  for (int k = 0; k < options.poses(); ++k) {
    const DeformationMaps maps = deformation.at(options.share(k));
    folds.look(*maps.forward, before, progress);
    progress.begin("deform");
    if (!mesh && !picture) {
      MeshDeformReport moves;
      PointSet cloud = deform_points(points, *maps.forward, &moves);
      report_moves(moves, r);
      r.vertices = cloud.size();
      use(k, std::move(cloud));
      continue;
    }
    TriangleMesh moved = opened;
    if (options.draw_folds) color_folded(moved, *maps.forward);
    MeshDeformReport moves;
    moved = deform_mesh(std::move(moved), *maps.forward, bent, &moves);
    report_moves(moves, r);
    r.vertices = moved.vertices.size(), r.triangles = moved.triangles.size();
    if (!picture) {
      use(k, std::move(moved));
      continue;
    }
    std::vector<Vec3> points_in_view = framed;
    if (points_in_view.empty()) add_finite_points(moved.origin, moved.vertices, points_in_view);
    use(k, with_name(name, [&] {
          return DeformedPicture{picture_of_pose({scene_factory(moved, options.look.picture)}, options, deformation,
                                                 options.share(k), std::move(points_in_view), {}, progress)};
        }));
  }
  add_mesh_notes(r, mesh, name, result.notes);
  folds.add_note(name, result.notes);
  r.folds = folds.worst();
  return result;
}

}  // namespace sansmesh::inline v1
