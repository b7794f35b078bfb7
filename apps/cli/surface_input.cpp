#include "surface_input.h"

#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io/io.h"
#include "sansmesh/measure/field_signed_distance.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/meshing/mesh_options.h"

namespace sansmesh::cli {

SurfaceInput::SurfaceInput(CloudInput input, Console& console)
    : input_(std::move(input)), file_(input_.name()), console_(console) {
  console.progress().begin("read");
  if (const auto name = input_.files.size() == 1 ? parse_isosurface_name(file_) : std::nullopt) {
    isosurface_ = open_isosurface(*name, console);
    placed_.emplace(*isosurface_->surface, isosurface_->surface->place());
    return;
  }
  if (input_.is_function()) {
    function_.emplace(read_function(file_));
    placed_.emplace(function_->field, function_->place);
    return;
  }
  mesh_ = to_mesh(input_.read(console, read_));
  made_ = true;
}

Json SurfaceInput::json() const {
  Json json = isosurface_ ? isosurface_->json : input_.json();
  json["kind"] = kind();
  return json;
}

const char* SurfaceInput::kind() const {
  if (isosurface_) return "isosurface";
  return function_ ? "function" : mesh_.triangles.empty() ? "points" : "mesh";
}

TriangleMesh& SurfaceInput::mesh() {
  if (made_) return mesh_;
  try {
    if (isosurface_) {
      IsosurfaceReport report;
      mesh_ = mesh_isosurface(*isosurface_->surface, {}, console_.progress(), &report);
      console_.warn(file_, report.warnings);
      made_ = true;
      return mesh_;
    }
    MeshReport report;
    mesh_ = mesh_function(*function_, {}, console_.progress(), &report);
    console_.warn(file_, report.warnings);
  } catch (const DataError& error) {
    throw FileError(file_, error.what());
  }
  made_ = true;
  return mesh_;
}

Box3 SurfaceInput::bounds() const {
  if (isosurface_) return placed_->bounds();
  if (function_) {
    const Box3f box = sansmesh::bounds(*function_->samples);
    if (box.empty()) return placed_->bounds();
    return function_->place.to_input(box);
  }
  Box3 box;
  for (const Vec3f& p : mesh_.vertices)
    if (is_finite(p)) box.extend(mesh_.origin + Vec3(p));
  return box;
}

std::unique_ptr<SignedDistance> SurfaceInput::distance() {
  if (placed_ && !isosurface_) return std::make_unique<FieldDistance>(*placed_);
  try {
    // Values of a volume are no distances, and go on beyond its boundary.
    return signed_distance(mesh());
  } catch (const DataError& error) {
    throw FileError(file_, error.what());
  }
}

}  // namespace sansmesh::cli
