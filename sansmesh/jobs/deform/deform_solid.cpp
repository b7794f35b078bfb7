// Deformation of functions and solids as fields, without sampling them first.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/deform/cuts/open_mesh.h"
#include "sansmesh/error.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/deformed_field.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/image.h"
#include "sansmesh/jobs/deform/deform_parts.h"
#include "sansmesh/jobs/meshes/solid_parts.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kPictureCells = 128;     // cells of the mesh that bounds ray casting
constexpr double kBallRoom = 1.5;      // ball radius in units of the longest edge at a vertex
constexpr double kVertexShare = 1e-9;  // accuracy of inverted vertices, as a share of the box

/// A field in a shifted frame, in which floats suffice.
class NearField final : public ScalarField {
 public:
  NearField(const ScalarField& field, const Vec3& origin) : field_(field), origin_(origin) {}
  Box3 bounds() const override {
    const Box3 box = field_.bounds();
    return {box.lower - origin_, box.upper - origin_};
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    field_.evaluate(moved(x), values, gradients);
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    field_.evaluate_in_domain(moved(x), values, gradients, inside);
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    field_.ranges(moved(x), radius, found);
  }

 private:
  std::vector<Vec3> moved(std::span<const Vec3> x) const {
    std::vector<Vec3> y(x.begin(), x.end());
    for (Vec3& p : y) p += origin_;
    return y;
  }
  const ScalarField& field_;
  Vec3 origin_;
};

/// Balls around the vertices of a mesh, as large as their triangles.
BallUnion balls_of(const TriangleMesh& mesh) {
  BallUnion balls;
  balls.centers = mesh.vertices;
  balls.radii.assign(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const float edge = static_cast<float>(kBallRoom) * norm(mesh.vertices[a] - mesh.vertices[b]);
      balls.radii[a] = std::max(balls.radii[a], edge), balls.radii[b] = std::max(balls.radii[b], edge);
    }
  return balls;
}

/// Data that all poses of a solid share.
class SolidPoses {
 public:
  SolidPoses(const SolidModel& solid, const Deformation& deformation, DeformAim aim, const DeformOptions& options,
             Progress& progress)
      : solid_(solid),
        deformation_(deformation),
        aim_(aim),
        options_(options),
        progress_(progress),
        function_(solid.parts().whole_function()),
        field_(std::make_shared<const Solid>(solid.parts().solid())) {
    // Sections use the function itself, which ends with its samples.
    if (function_ && aim == DeformAim::sections) field_ = function_->field();
    before_ = field_->bounds();
    if (aim == DeformAim::picture) framed_ = points_of_poses(deformation, before_, options, false);
    open_ = function_ && is_open(*function_) && !options.box;
    if (!open_) result_.notes = solid.open_notes();
  }

  DeformedPose at(int k) {
    const double share = options_.share(k);
    const DeformationMaps maps = deformation_.at(share);
    if (open_ && aim_ != DeformAim::sections) return of_open(maps, share);
    const DeformedField field(field_, maps.backward, deformation_.box_of(maps, before_));
    const TriangleMesh folded = folds_.look(*maps.backward, options_.box.value_or(field.bounds()), progress_);
    if (aim_ == DeformAim::sections) return sections_of(field);
    if (aim_ == DeformAim::picture) return DeformedPicture{picture_of(field, folded, share)};
    DeformReport& r = result_.report;
    TriangleMesh mesh = mesh_csg(field, mesh_options(), progress_, &r.solid.emplace());
    for (const Note& note : r.solid->notes) note_once(note);
    r.vertices = mesh.vertices.size(), r.triangles = mesh.triangles.size();
    return mesh;
  }

  DeformResult result() {
    folds_.add_note(solid_.expression(), result_.notes);
    result_.report.folds = folds_.worst();
    return std::move(result_);
  }

 private:
  /// Options with the box that makes unbounded solids finite.
  CsgMeshOptions mesh_options() const {
    CsgMeshOptions o = {
        .cell = options_.cell, .resolution = options_.resolution, .box = options_.box, .simplify = options_.simplify};
    o.components = options_.components.value_or(solid_.default_components());
    return o;
  }

  /// Mesh of a surface that bounds no solid, with vertices moved by the inverse of the backward map.
  TriangleMesh mesh_of_open(const DeformationMaps& maps) {
    TriangleMesh mesh = mesh_function(function_->fitted(), {}, progress_);
    if (!deformation_.cuts().empty())
      return deform_mesh(open_along_cuts(std::move(mesh), deformation_.cuts()), *maps.forward);
    const double size = static_cast<double>(bounds(mesh).diagonal());
    MeshDeformReport report;
    mesh = deform_mesh(std::move(mesh), InverseMap(maps.backward, kVertexShare * size, maps.forward), {}, &report);
    if (report.undefined > 0)
      note_once(
          {.code = "undefined",
           .text = fmt::format("{} vertices do not move: the map has no inverse there", grouped(report.undefined))});
    return mesh;
  }

  /// Adds a note unless another pose has added it.
  void note_once(Note note) {
    std::vector<Note>& notes = result_.notes;
    if (std::any_of(notes.begin(), notes.end(), [&](const Note& n) { return n.text == note.text; })) return;
    note.of = solid_.expression();
    notes.push_back(std::move(note));
  }

  DeformedPose of_open(const DeformationMaps& maps, double share) {
    TriangleMesh mesh = mesh_of_open(maps);
    DeformReport& r = result_.report;
    r.mesh_of_open = true, r.vertices = mesh.vertices.size(), r.triangles = mesh.triangles.size();
    if (aim_ != DeformAim::picture) return mesh;
    std::vector<Vec3> framed = framed_;
    if (framed.empty()) add_finite_points(mesh.origin, mesh.vertices, framed);
    return DeformedPicture{picture_of_pose({scene_factory(mesh, options_.look.picture)}, options_, deformation_, share,
                                           std::move(framed), {}, progress_)};
  }

  std::vector<Section> sections_of(const DeformedField& field) {
    FieldSectionOptions lattice;
    if (options_.resolution) lattice.resolution = *options_.resolution;
    lattice.box = options_.box;
    const Box3 box = options_.box.value_or(field.bounds());
    if (!is_finite(box.lower) || !is_finite(box.upper))
      throw ArgumentError("the solid is unbounded: `box` cuts it off");
    const std::vector<CutPlane> planes = options_.planes.empty() ? middle_planes(box) : options_.planes;
    return result_.report.sections = section_field(field, planes, lattice, progress_);
  }

  /// A picture of the mesh or, if `exact`, of the surface itself by ray casting within balls around mesh vertices.
  Image picture_of(const DeformedField& field, const TriangleMesh& folded, double share) {
    CsgMeshOptions o = mesh_options();
    const bool exact =
        options_.exact_deformation || function_;  // functions of scans have few creases: ray casting is faster
    if (exact) {
      if (!o.cell && !o.resolution) o.resolution = kPictureCells;
      o.simplify = 0;
    }
    const TriangleMesh mesh = mesh_csg(field, o, progress_);
    std::vector<Vec3> framed = framed_;
    if (framed.empty()) add_finite_points(mesh.origin, mesh.vertices, framed);
    const auto with = [&](SceneFactory surface) {
      return picture_of_pose({std::move(surface)}, options_, deformation_, share, std::move(framed), folded, progress_);
    };
    if (!exact) return with(scene_factory(mesh, options_.look.picture));
    const NearField near(field, mesh.origin);
    const SurfaceCaster caster(near, balls_of(mesh), {});
    LocalFrame frame;
    frame.origin = mesh.origin;
    SurfaceRenderOptions look;
    look.picture = options_.look.picture;
    return with(scene_factory(caster, frame, nullptr, look));
  }

  const SolidModel& solid_;
  const Deformation& deformation_;
  DeformAim aim_;
  const DeformOptions& options_;
  Progress& progress_;
  const SurfaceFunction* function_;           ///< null for other solids
  std::shared_ptr<const ScalarField> field_;  ///< field that is deformed
  Box3 before_;
  std::vector<Vec3> framed_;
  bool open_ = false;
  FoldWatch folds_;
  DeformResult result_;
};

}  // namespace

DeformResult deform(const SolidModel& solid, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress) {
  options.validate(aim, deformation);
  if (options.refine) throw ArgumentError("`refine` is for meshes: functions are meshed as finely as necessary");
  SolidPoses poses(solid, deformation, aim, options, progress);
  for (int k = 0; k < options.poses(); ++k) use(k, with_name(solid.expression(), [&] { return poses.at(k); }));
  return poses.result();
}

}  // namespace sansmesh::inline v1
