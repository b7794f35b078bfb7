// Surfaces straight from the samples of a volume: of one value, or where it changes most.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/dataset/volume_surface.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SurfaceInVolumeOptions {
  std::optional<double> value = {};   ///< default: the middle of the array's range; not for surfaces of high gradient
  VolumeSurfaceOptions surface = {};  ///< its value is the one above

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SurfaceInVolume {
  VolumeSurface surface;  ///< with its report
  double value = 0;       ///< of the array; of high gradient none
  /// "resolved": the values are so smooth that an isosurface of the reconstruction is nearer.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Of the array that the volume was opened with: of a component, or lengths of vectors. Throws ArgumentError for bad
/// options and where an array of several components needs a value, DataError where no sample is near such a surface,
/// Cancelled.
SurfaceInVolume surface_in_volume(VolumeModel& volume, const SurfaceInVolumeOptions& options, Progress& progress);

struct MeshInVolumeOptions {
  std::optional<double> mesh_error = {};      ///< as in MeshOptions
  std::optional<std::size_t> triangles = {};  ///< as in MeshOptions
  ComponentChoice components = {};            ///< automatic: those that are larger than the weights are wide

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct MeshInVolumeReport {
  MeshReport mesh;
  double area = 0;
  std::optional<double> volume;  ///< enclosed, where the mesh is closed

  static const ReportSchema& schema();
};

struct MeshInVolume {
  TriangleMesh mesh;
  MeshInVolumeReport report;
  std::vector<Note> notes;  ///< "mesh": what became of the mesh
};

/// The surface as a mesh. Throws ArgumentError for bad options, DataError where nothing is found, Cancelled.
MeshInVolume mesh_of_surface(const VolumeModel& volume, const SurfaceInVolume& surface,
                             const MeshInVolumeOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
