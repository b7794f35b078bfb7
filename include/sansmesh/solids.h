// Solids composed of functions, meshes, volumes and primitives, and their meshes.
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

/// A solid. Cheap to copy: copies share immutable data.
class SANSMESH_API SolidModel {
 public:
  /// For the library only; programs use read_solid.
  explicit SolidModel(SolidParts parts);

  /// Expression of the solid.
  const std::string& expression() const;
  /// Files in the expression.
  const std::vector<std::string>& files() const;
  /// Bounding box in the coordinates of the input; infinite for unbounded solids.
  Box3 bounds() const;
  /// Notes from reading. "read", "volume", "reconstruction": on files; "mesh_solid": changes to a mesh.
  const std::vector<Note>& notes() const;
  /// Default for the components of its mesh: functions of scans may have small sheets far from their surface.
  ComponentChoice default_components() const;
  /// "open": functions whose surface bounds no solid.
  std::vector<Note> open_notes() const;

  /// For the library only.
  const SolidParts& parts() const { return *parts_; }

  static const ReportSchema& schema();  ///< report rows

 private:
  std::shared_ptr<const SolidParts> parts_;
};

/// Reads a solid from an expression (grammar: docs/methods/csg.md) of primitives, meshes, function files and
/// isosurfaces (data.vtu[Temp=300]). Throws ArgumentError "expression at N: …" for syntax errors, N counting characters
/// from 1; FileError; DataError that begins with the name of a volume; Cancelled.
SANSMESH_API SolidModel read_solid(const std::string& expression, Progress& progress);

/// Result of mesh_of_solid().
struct CsgResult {
  TriangleMesh mesh;     ///< mesh in the coordinates of the expression
  CsgMeshReport report;  ///< how it was made
  /// "open": functions whose surface bounds no solid; notes on the mesh.
  std::vector<Note> notes;
};

/// The boundary of the solid as a mesh with exact creases. By default very small components are dropped if the solid
/// has functions, otherwise none. Throws ArgumentError for bad options and unbounded solids; DataError if there is no
/// surface; Cancelled.
SANSMESH_API CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress);

/// Size, cells and accuracy of the mesh, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const CsgMeshReport& report);

}  // namespace sansmesh::inline v1
