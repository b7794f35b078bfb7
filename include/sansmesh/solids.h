// Solids of functions, meshes, volumes and primitives, and their meshes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SolidParts;

/// A solid with all that it needs. Cheap to copy: what it holds is shared and never changes.
class SANSMESH_API SolidModel {
 public:
  explicit SolidModel(SolidParts parts);

  const std::string& expression() const;
  /// That the expression names.
  const std::vector<std::string>& files() const;
  /// Around it, in the coordinates of the input; infinite where it has no end.
  Box3 bounds() const;
  /// "read", "volume", "reconstruction": of files; "mesh_solid": what was done to a mesh.
  const std::vector<Note>& notes() const;
  /// Parts of its mesh that are kept where nobody says: functions of scans may have small sheets far from their
  /// surface.
  ComponentChoice usual_components() const;
  /// "open": functions whose surface bounds no solid.
  std::vector<Note> open_notes() const;

  /// For the library's own sources.
  const SolidParts& parts() const { return *parts_; }

  static const ReportSchema& schema();

 private:
  std::shared_ptr<const SolidParts> parts_;
};

/// Function files, isosurfaces (data.vtu[Temp=300]) and what parse_csg knows. Throws FileError, ArgumentError,
/// DataError that begins with the name of a volume.
SANSMESH_API SolidModel read_solid(const std::string& expression, Progress& progress);

struct CsgResult {
  TriangleMesh mesh;
  CsgMeshReport report;
  /// "open": functions whose surface bounds no solid; "mesh": what there is to say of the mesh.
  std::vector<Note> notes;
};

/// By mesh_csg; of solids with functions parts too small to count are left out by default, of others none. Throws
/// ArgumentError for bad options, and for solids without an end; DataError where there is no surface; Cancelled.
SANSMESH_API CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
