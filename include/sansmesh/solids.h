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
  /// For the library's own sources: programs get solids from read_solid.
  explicit SolidModel(SolidParts parts);

  /// Text that the solid was made from.
  const std::string& expression() const;
  /// Files that the expression names.
  const std::vector<std::string>& files() const;
  /// Box around it, in the coordinates of the input; infinite where it has no end.
  Box3 bounds() const;
  /// Notes of making it. "read", "volume", "reconstruction": of files; "mesh_solid": what was done to a mesh.
  const std::vector<Note>& notes() const;
  /// Parts of its mesh that are kept where nobody says: functions of scans may have small sheets far from their
  /// surface.
  ComponentChoice usual_components() const;
  /// "open": functions whose surface bounds no solid.
  std::vector<Note> open_notes() const;

  /// For the library's own sources.
  const SolidParts& parts() const { return *parts_; }

  static const ReportSchema& schema();  ///< a row for each thing that it tells

 private:
  std::shared_ptr<const SolidParts> parts_;
};

/// The solid of an expression (grammar: docs/methods/csg.md) of primitives, meshes, function files and isosurfaces
/// (data.vtu[Temp=300]). Throws ArgumentError "expression at N: …" for text that does not follow the grammar, N
/// counting characters from 1; FileError; DataError that begins with the name of a volume; Cancelled.
SANSMESH_API SolidModel read_solid(const std::string& expression, Progress& progress);

/// Mesh of a solid.
struct CsgResult {
  TriangleMesh mesh;     ///< in the coordinates of the expression
  CsgMeshReport report;  ///< what became of it
  /// "open": functions whose surface bounds no solid; "mesh": what there is to say of the mesh.
  std::vector<Note> notes;
};

/// The boundary of the solid as a mesh with exact creases. Of solids with functions parts too small to count are left
/// out by default, of others none. Throws ArgumentError for bad options, and for solids without an end; DataError where
/// there is no surface; Cancelled.
SANSMESH_API CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress);

/// Size and cells, and how large and near the mesh is; in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const CsgMeshReport& report);

}  // namespace sansmesh::inline v1
