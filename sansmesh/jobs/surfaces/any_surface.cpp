#include "sansmesh/attribute_table.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/inspect.h"
#include "sansmesh/isosurfaces.h"
#include "sansmesh/triangle_mesh.h"

#include <utility>

#include "sansmesh/data/world_points.h"
#include "sansmesh/error.h"
#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/measure/field_signed_distance.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/mesh_options.h"

namespace sansmesh::inline v1 {
namespace {

/// Distance to a mesh, with the mesh.
struct KeptDistance {
  std::shared_ptr<const TriangleMesh> mesh;
  std::unique_ptr<SignedDistance> distance;
};

struct KeptFieldDistance {
  std::shared_ptr<const ScalarField> field;
  FieldDistance distance;
};

}  // namespace

AnySurface::AnySurface(TriangleMesh mesh, std::string name)
    : name_(std::move(name)),
      kind_(mesh.triangles.empty() ? Kind::points : Kind::mesh),
      mesh_(std::make_shared<const TriangleMesh>(std::move(mesh))) {}

AnySurface::AnySurface(SurfaceFunction function, std::string name)
    : name_(std::move(name)), kind_(Kind::function), function_(std::move(function)), field_(function_->field()) {}

AnySurface::AnySurface(std::shared_ptr<const Isosurface> isosurface, std::string name)
    : name_(std::move(name)),
      kind_(Kind::isosurface),
      isosurface_(std::move(isosurface)),
      field_(std::make_shared<const PlacedField>(isosurface_, *isosurface_, isosurface_->frame())) {}

const char* AnySurface::kind_word() const {
  switch (kind_) {
    case Kind::mesh:
      return "mesh";
    case Kind::points:
      return "points";
    case Kind::function:
      return "function";
    case Kind::isosurface:
      return "isosurface";
  }
  return "";
}

std::shared_ptr<const TriangleMesh> AnySurface::mesh(Progress& progress, std::vector<Note>& notes) const {
  if (mesh_) return mesh_;
  return with_name(name_, [&] {
    if (isosurface_) {
      IsosurfaceReport report;
      auto made = std::make_shared<const TriangleMesh>(mesh_isosurface(*isosurface_, {}, progress, &report));
      add_notes(notes, report.notes, name_);
      return made;
    }
    MeshReport report;
    auto made = std::make_shared<const TriangleMesh>(mesh_function(function_->fitted(), {}, progress, &report));
    add_notes(notes, report.notes, name_);
    return made;
  });
}

const ReferenceSystem* AnySurface::reference() const {
  if (function_) return function_->fitted().frame.reference.get();
  return mesh_ ? mesh_->reference.get() : nullptr;
}

Box3 AnySurface::bounds() const {
  if (isosurface_) return field_->bounds();
  if (function_) return function_->bounds();
  return finite_bounds(mesh_->origin, mesh_->vertices);
}

std::shared_ptr<const SignedDistance> AnySurface::distance(Progress& progress, std::vector<Note>& notes) const {
  if (function_) {
    const auto kept = std::make_shared<const KeptFieldDistance>(KeptFieldDistance{field_, FieldDistance(*field_)});
    return {kept, &kept->distance};
  }
  const std::shared_ptr<const TriangleMesh> own = mesh(progress, notes);
  return with_name(name_, [&]() -> std::shared_ptr<const SignedDistance> {
    const auto kept = std::make_shared<const KeptDistance>(KeptDistance{own, signed_distance(*own)});
    return {kept, kept->distance.get()};
  });
}

}  // namespace sansmesh::inline v1
