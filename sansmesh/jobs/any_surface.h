// A surface, whatever says where it is: triangles, points, a function, or a value in a volume.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Cheap to copy: what it holds is shared and never changes.
class AnySurface {
 public:
  enum class Kind : std::uint8_t { mesh, points, function, isosurface };

  /// `name` stands in messages: its file. A mesh without triangles is points.
  AnySurface(TriangleMesh mesh, std::string name);
  AnySurface(std::shared_ptr<const SurfaceFunction> function, std::string name);
  AnySurface(std::shared_ptr<const Isosurface> isosurface, std::string name);

  const std::string& name() const { return name_; }
  Kind kind() const { return kind_; }
  /// "mesh", "points", "function" or "isosurface".
  const char* kind_word() const;
  /// The function or isosurface in the input's coordinates; null for meshes and points.
  const ScalarField* field() const { return field_.get(); }
  /// The mesh or the points; of a function or isosurface its mesh, which is made at every call and whose warnings are
  /// added to `notes` with the code "mesh". Throws DataError that begins with the name.
  std::shared_ptr<const TriangleMesh> mesh(Progress& progress, std::vector<Note>& notes) const;
  /// Around mesh, points or the samples of a function (its own box if it has none).
  Box3 bounds() const;
  /// Of the function itself; else of the mesh or the points. An isosurface is measured by its mesh: values of a volume
  /// are no distances, and go on beyond its boundary. Throws DataError that begins with the name.
  std::shared_ptr<const SignedDistance> distance(Progress& progress, std::vector<Note>& notes) const;

 private:
  std::string name_;
  Kind kind_;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::shared_ptr<const SurfaceFunction> function_;
  std::shared_ptr<const Isosurface> isosurface_;
  std::shared_ptr<const ScalarField> field_;  ///< with all that it needs
};

}  // namespace sansmesh::inline v1
