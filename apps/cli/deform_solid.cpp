// sansmesh deform: functions and solids, as fields that are never sampled before they are deformed.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "deform.h"
#include "sansmesh/core/error.h"
#include "sansmesh/deform/open_mesh.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/deformed_field.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io/io.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/measure/section_text.h"
#include "sansmesh/mesh/deformed_mesh.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/surface_caster.h"
#include "solid_input.h"

namespace sansmesh::cli {
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

struct SolidSource {
  SolidInput input;
  std::shared_ptr<const ScalarField> field;         ///< what is deformed
  std::shared_ptr<const SurfaceFunction> function;  ///< the whole of it, if it is one
};

SolidSource open_source(const DeformArguments& a, Console& console) {
  SolidInput input = open_solid(a.input.files[0], console);
  SolidSource source{std::move(input), {}, {}};
  source.field = std::make_shared<const Solid>(source.input.solid);
  if (source.input.functions.size() == 1 && source.input.functions.begin()->first == a.input.files[0]) {
    source.function = source.input.functions.begin()->second;
    // Sections are those of the function itself, which ends where its samples end.
    struct Placed {
      std::shared_ptr<const SurfaceFunction> function;
      PlacedField field;
    };
    if (a.to_section()) {
      auto placed = std::make_shared<const Placed>(
          Placed{source.function, PlacedField(source.function->field, source.function->place)});
      source.field = std::shared_ptr<const ScalarField>(placed, &placed->field);
    }
  }
  return source;
}

/// Where it is cut off, and what that leaves of endless solids.
CsgMeshOptions mesh_options(const DeformArguments& a, const SolidSource& source) {
  CsgMeshOptions options = a.mesh;
  options.components = a.components.value_or(source.input.usual_components());
  return options;
}

/// The mesh of a surface that bounds no solid, its vertices carried by the inverse of the map that fields are seen by.
TriangleMesh open_mesh(const SurfaceFunction& function, const OpenDeformation& deformation, const DeformationMaps& maps,
                       Console& console) {
  TriangleMesh mesh = mesh_function(function, {}, console.progress());
  if (!deformation.cuts().empty())
    return deform_mesh(open_along_cuts(std::move(mesh), deformation.cuts()), *maps.forward);
  const double size = static_cast<double>(bounds(mesh).diagonal());
  MeshDeformReport report;
  mesh = deform_mesh(std::move(mesh), InverseMap(maps.backward, kVertexShare * size, maps.forward), {}, &report);
  if (report.undefined > 0)
    console.warn({fmt::format("{} vertices stay where they are: nothing comes to them", grouped(report.undefined))});
  return mesh;
}

/// The surface itself, found by rays within balls around the vertices of a mesh of it.
Image exact_picture(const DeformedField& field, const TriangleMesh& mesh, const DeformArguments& a,
                    const OpenDeformation& deformation, double share, std::vector<Vec3> places,
                    const TriangleMesh& folds, Progress& progress) {
  const NearField near(field, mesh.origin);
  const SurfaceCaster caster(near, balls_of(mesh), {});
  Placement place;
  place.origin = mesh.origin;
  SurfaceRenderOptions look;
  static_cast<RenderOptions&>(look) = deform_look(a);
  return picture_beside({surface_in_picture(caster, place, nullptr, look)}, a, deformation, share, std::move(places),
                        folds, progress);
}

/// A mesh of it, or the surface itself where that is asked for.
Image solid_picture(const DeformArguments& a, const OpenDeformation& deformation, const DeformedField& field,
                    const SolidSource& source, double share, std::vector<Vec3> places, const TriangleMesh& folds,
                    Progress& progress) {
  CsgMeshOptions options = mesh_options(a, source);
  const bool exact = a.exact || source.function;  // functions of scans have hardly a crease: rays are quicker
  if (exact) {
    if (!options.cell && !options.resolution) options.resolution = kPictureCells;
    options.simplify = 0;
  }
  const TriangleMesh mesh = mesh_csg(field, options, progress);
  if (places.empty())
    for (const Vec3f& v : mesh.vertices) places.push_back(mesh.origin + Vec3(v));
  if (exact) return exact_picture(field, mesh, a, deformation, share, std::move(places), folds, progress);
  return picture_beside({surface_in_picture(mesh, deform_look(a))}, a, deformation, share, std::move(places), folds,
                        progress);
}

}  // namespace

DeformResult deform_solid(const DeformArguments& a, const OpenDeformation& deformation, Console& console) {
  require(!a.bend, "--refine is for meshes: functions are cut out as fine as they need");
  if (!a.to_picture() && !a.to_section()) check_writable(a.output, "mesh");
  Progress& progress = console.progress();
  std::vector<CutPlane> planes;
  planes.reserve(a.planes.size());
  for (const std::string& text : a.planes) planes.push_back(parse_plane(text));
  const SolidSource source = open_source(a, console);
  const bool open = source.function && is_open(*source.function) && !a.mesh.box;
  if (!open) source.input.warn_of_open(console);
  const Box3 before = source.field->bounds();
  std::vector<Vec3> framed;
  if (a.to_picture() && a.frames > 0)
    for (const double share : {0.0, 0.5, 1.0})
      if (const auto box = deformation.box_of(deformation.at(share), before)) add_corners(*box, framed);

  DeformResult result;
  FoldWatch folds;
  result.input = {{"expression", a.input.files[0]}, {"files", source.input.files}};
  for (int k = 0; k < a.poses(); ++k) {
    const DeformationMaps maps = deformation.at(a.share(k));
    result.files.push_back(a.file(k));
    const std::string& file = result.files.back();
    if (open && !a.to_section()) {
      const TriangleMesh mesh = open_mesh(*source.function, deformation, maps, console);
      if (a.to_picture()) {
        std::vector<Vec3> places = framed;
        if (places.empty())
          for (const Vec3f& v : mesh.vertices) places.push_back(mesh.origin + Vec3(v));
        a.picture.write(file,
                        picture_beside({surface_in_picture(mesh, deform_look(a))}, a, deformation, a.share(k),
                                       std::move(places), {}, progress),
                        deform_look(a));
      } else {
        write_mesh(file, mesh, {a.ascii});
      }
      result.lines = {fmt::format("{}, its surface bounds no solid: its mesh was deformed",
                                  counted(mesh.triangles.size(), "triangle"))};
      continue;
    }
    const DeformedField field(source.field, maps.backward, deformation.box_of(maps, before));
    const TriangleMesh folded = folds.look(*maps.backward, a.mesh.box.value_or(field.bounds()), progress);
    if (a.to_section()) {
      FieldSectionOptions options;
      if (a.mesh.resolution) options.resolution = *a.mesh.resolution;
      if (a.mesh.box) options.box = a.mesh.box;
      const Box3 box = options.box.value_or(field.bounds());
      require(is_finite(box.lower) && is_finite(box.upper), "the solid has no end: --box says where to cut it off");
      const std::vector<Section> sections =
          section_field(field, planes.empty() ? middle_planes(box) : planes, options, progress);
      write_text(file, file.ends_with(".svg") ? section_svg(sections, {.unit = a.unit}) : section_csv(sections));
      result.lines.clear();
      Json list = Json::array();
      for (const Section& s : sections) {
        result.lines.push_back(fmt::format("{:<20} length {:<11.6g} area {:<11.6g} {}", equation(s.plane), s.length,
                                           s.area,
                                           s.curves.empty() ? "nothing there" : counted(s.curves.size(), "curve")));
        list.push_back(
            {{"equation", equation(s.plane)}, {"curves", s.curves.size()}, {"length", s.length}, {"area", s.area}});
      }
      result.output = {{"sections", list}};
    } else if (a.to_picture()) {
      a.picture.write(file, solid_picture(a, deformation, field, source, a.share(k), framed, folded, progress),
                      deform_look(a));
    } else {
      CsgMeshReport report;
      const TriangleMesh mesh = mesh_csg(field, mesh_options(a, source), progress, &report);
      progress.begin("write");
      write_mesh(file, mesh, {a.ascii});
      console.warn(file, report.warnings);
      result.lines = {fmt::format("{}, {} vertices in {}{}", counted(mesh.triangles.size(), "triangle"),
                                  grouped(mesh.vertices.size()), counted(report.components, "component"),
                                  report.closed ? ", closed" : ", not closed"),
                      fmt::format("area {:.6g}, volume {:.6g}", report.area, report.volume)};
      result.output = {{"vertices", mesh.vertices.size()},
                       {"triangles", mesh.triangles.size()},
                       {"components", report.components},
                       {"closed", report.closed},
                       {"cell", report.cell},
                       {"area", report.area},
                       {"volume", report.volume}};
    }
  }
  folds.report(a.input.files[0], result, console);
  return result;
}

}  // namespace sansmesh::cli
