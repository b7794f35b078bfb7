// Functions and solids, deformed as fields that are never sampled before.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/deform/open_mesh.h"
#include "sansmesh/error.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/deformed_field.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/image.h"
#include "sansmesh/jobs/deform_parts.h"
#include "sansmesh/jobs/solid_parts.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/repair.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kPictureCells = 128;     // of the mesh that says where rays have to look
constexpr double kBallRoom = 1.5;      // radius of balls, in longest edges at a vertex
constexpr double kVertexShare = 1e-9;  // of the box: to which vertices are carried back

/// A field seen from a place of its own, so that floats suffice.
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

/// Balls around the vertices of a mesh of the surface, each as large as its triangles.
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

/// All that the poses of one solid share.
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
        field_(std::make_shared<const Solid>(solid.parts().solid)) {
    // Sections are those of the function itself, which ends where its samples end.
    if (function_ && aim == DeformAim::sections) field_ = function_->field();
    before_ = field_->bounds();
    if (aim == DeformAim::picture) framed_ = places_of_poses(deformation, before_, options, false);
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
    for (const std::string& line : r.solid->warnings) note_once("mesh", line);
    r.vertices = mesh.vertices.size(), r.triangles = mesh.triangles.size();
    return mesh;
  }

  DeformResult result() {
    folds_.add_note(solid_.expression(), result_.notes);
    result_.report.folds = folds_.worst();
    return std::move(result_);
  }

 private:
  /// The box that it is cut off at, which makes endless solids finite.
  CsgMeshOptions mesh_options() const {
    CsgMeshOptions o = {
        .cell = options_.cell, .resolution = options_.resolution, .box = options_.box, .simplify = options_.simplify};
    o.components = options_.components.value_or(solid_.usual_components());
    return o;
  }

  /// The mesh of a surface that bounds no solid, its vertices carried by the inverse of the map that fields are seen
  /// by.
  TriangleMesh mesh_of_open(const DeformationMaps& maps) {
    TriangleMesh mesh = mesh_function(function_->fitted(), {}, progress_);
    if (!deformation_.cuts().empty())
      return deform_mesh(open_along_cuts(std::move(mesh), deformation_.cuts()), *maps.forward);
    const double size = static_cast<double>(bounds(mesh).diagonal());
    MeshDeformReport report;
    mesh = deform_mesh(std::move(mesh), InverseMap(maps.backward, kVertexShare * size, maps.forward), {}, &report);
    if (report.undefined > 0)
      note_once("undefined",
                fmt::format("{} vertices stay where they are: nothing comes to them", grouped(report.undefined)));
    return mesh;
  }

  /// Poses that have the same to say say it once.
  void note_once(const char* code, const std::string& text) {
    std::vector<Note>& notes = result_.notes;
    if (std::none_of(notes.begin(), notes.end(), [&](const Note& n) { return n.text == text; }))
      notes.push_back({.code = code, .text = text, .remedy = {}, .of = solid_.expression()});
  }

  DeformedPose of_open(const DeformationMaps& maps, double share) {
    TriangleMesh mesh = mesh_of_open(maps);
    DeformReport& r = result_.report;
    r.mesh_of_open = true, r.vertices = mesh.vertices.size(), r.triangles = mesh.triangles.size();
    if (aim_ != DeformAim::picture) return mesh;
    std::vector<Vec3> places = framed_;
    if (places.empty()) add_vertices(mesh, places);
    return DeformedPicture{picture_of_pose({surface_in_picture(mesh, options_.look.picture)}, options_, deformation_,
                                           share, std::move(places), {}, progress_)};
  }

  std::vector<Section> sections_of(const DeformedField& field) {
    FieldSectionOptions lattice;
    if (options_.resolution) lattice.resolution = *options_.resolution;
    lattice.box = options_.box;
    const Box3 box = options_.box.value_or(field.bounds());
    if (!is_finite(box.lower) || !is_finite(box.upper))
      throw ArgumentError("the solid has no end: `box` says where to cut it off");
    const std::vector<CutPlane> planes = options_.planes.empty() ? middle_planes(box) : options_.planes;
    return result_.report.sections = section_field(field, planes, lattice, progress_);
  }

  /// A mesh of it, or the surface itself, found by rays within balls around the vertices of a mesh, where that is asked
  /// for.
  Image picture_of(const DeformedField& field, const TriangleMesh& folded, double share) {
    CsgMeshOptions o = mesh_options();
    const bool exact =
        options_.exact_deformation || function_;  // functions of scans have hardly a crease: rays are quicker
    if (exact) {
      if (!o.cell && !o.resolution) o.resolution = kPictureCells;
      o.simplify = 0;
    }
    const TriangleMesh mesh = mesh_csg(field, o, progress_);
    std::vector<Vec3> places = framed_;
    if (places.empty()) add_vertices(mesh, places);
    const auto with = [&](PictureSurface surface) {
      return picture_of_pose({std::move(surface)}, options_, deformation_, share, std::move(places), folded, progress_);
    };
    if (!exact) return with(surface_in_picture(mesh, options_.look.picture));
    const NearField near(field, mesh.origin);
    const SurfaceCaster caster(near, balls_of(mesh), {});
    LocalFrame frame;
    frame.origin = mesh.origin;
    SurfaceRenderOptions look;
    look.picture = options_.look.picture;
    return with(surface_in_picture(caster, frame, nullptr, look));
  }

  const SolidModel& solid_;
  const Deformation& deformation_;
  DeformAim aim_;
  const DeformOptions& options_;
  Progress& progress_;
  const SurfaceFunction* function_;           ///< null of other solids
  std::shared_ptr<const ScalarField> field_;  ///< what is deformed
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
  if (options.refine) throw ArgumentError("`refine` is for meshes: functions are cut out as fine as they need");
  SolidPoses poses(solid, deformation, aim, options, progress);
  for (int k = 0; k < options.poses(); ++k) use(k, with_name(solid.expression(), [&] { return poses.at(k); }));
  return poses.result();
}

}  // namespace sansmesh::inline v1
