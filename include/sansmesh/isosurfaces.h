// Surfaces in volumes: isosurfaces at one or many moments, and surfaces computed straight from the samples.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

class VolumeSurface;

// ---- Isosurfaces -------------------------------------------------------------------------------------------------

/// Options of an isosurface and its mesh.
struct SANSMESH_API VolumeIsosurfaceOptions {
  std::optional<double> value = {};  ///< isovalue; default: the middle of the array's range
  /// Other arrays at the vertices, interpolated as by the grid: "all", "none", or names with commas.
  std::string carry = "all";
  IsosurfaceOptions mesh = {};  ///< how it is meshed

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of an isosurface.
struct SANSMESH_API VolumeIsosurfaceReport {
  VolumeReconstructionReport reconstruction;  ///< report of the field
  double value = 0;                           ///< isovalue
  IsosurfaceReport mesh;                      ///< how it was meshed

  static const ReportSchema& schema();  ///< report rows
};

/// An isosurface as a mesh.
struct VolumeIsosurfaceResult {
  TriangleMesh mesh;              ///< mesh in the input's coordinates
  VolumeIsosurfaceReport report;  ///< how it was made
  /// Notes of VolumeModel::field and on the mesh; "not_carried": an array does not fit into floats.
  std::vector<Note> notes;
};

/// The isosurface of the volume's array as a mesh. Throws as VolumeModel::isosurface, ArgumentError for bad options and
/// if an array of several components needs a value, DataError if nothing is found, Cancelled.
SANSMESH_API VolumeIsosurfaceResult isosurface(const VolumeModel& volume, const VolumeIsosurfaceOptions& options,
                                               Progress& progress);

// ---- At many moments ---------------------------------------------------------------------------------------------

/// Moments of an isosurface that changes in time.
struct SANSMESH_API IsosurfaceMomentsOptions {
  std::optional<std::size_t> frames =
      {};  ///< number of moments from the first step to the last; default: the number of steps
  /// Duration of the smallest blocks in space and time (time, > 0); default: the shortest time between steps.
  std::optional<double> time_cell = {};

  /// Option rows, one per field.
  static const OptionSchema& schema();
};

/// Measures of the mesh of one moment.
struct SANSMESH_API IsosurfaceMoment {
  double time = 0;                                          ///< time of the moment
  std::size_t vertices = 0, triangles = 0, components = 0;  ///< counts
  bool closed = true;                                       ///< no edge is open
  double area = 0, volume = 0;                              ///< length², length³

  static const ReportSchema& schema();  ///< report rows
};

/// Report of an isosurface that changes in time.
struct SANSMESH_API IsosurfaceMomentsReport {
  VolumeReconstructionReport reconstruction;  ///< report of the first step
  double value = 0;                           ///< isovalue
  std::size_t blocks = 0;                     ///< blocks in space and time
  double cell = 0, time_cell = 0;             ///< edge and duration of the smallest blocks
  std::vector<IsosurfaceMoment> moments;      ///< in order

  static const ReportSchema& schema();  ///< report rows
};

/// Result of isosurface_moments(); the meshes were passed to the callback.
struct IsosurfaceMomentsResult {
  IsosurfaceMomentsReport report;  ///< how it was made
  /// Those of VolumeModel::field; "no_surface": a moment has no surface; "more_triangles": more triangles than
  /// requested.
  std::vector<Note> notes;
};

/// The isosurface of a volume that changes, extracted in space and time and cut at moments from the first step to the
/// last. The meshes are closed and passed to `use` in order, with the number of the moment. Throws as isosurface(), and
/// ArgumentError for `carry`, `closed` and `components`, which do not apply here.
SANSMESH_API IsosurfaceMomentsResult isosurface_moments(
    const VolumeSeries& series, const VolumeIsosurfaceOptions& options, const IsosurfaceMomentsOptions& moments,
    const std::function<void(std::size_t, const TriangleMesh&)>& use, Progress& progress);
/// Throws what isosurface_moments throws for its options, before reading anything.
SANSMESH_API void check_moments(const VolumeIsosurfaceOptions& options, const IsosurfaceMomentsOptions& moments);
/// Number of moments.
SANSMESH_API std::size_t moment_count(const VolumeSeries& series, const IsosurfaceMomentsOptions& moments);

// ---- Straight from the samples -----------------------------------------------------------------------------------

/// Options of a surface of the samples.
struct SANSMESH_API SurfaceInVolumeOptions {
  std::optional<double> value =
      {};  ///< default: the middle of the array's range; not used for surfaces of high gradient
  VolumeSurfaceOptions surface = {};  ///< its value is the one above

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Surface that the samples of a volume define: an isosurface, or the surface of steepest change. Cheap to copy.
struct SANSMESH_API SurfaceInVolume {
  std::shared_ptr<const VolumeSurface> surface;  ///< for the jobs below and for pictures
  VolumeSurfaceReport report;                    ///< how it was found
  double value = 0;                              ///< isovalue; not used for high gradients
  std::string name;                              ///< name of the volume in messages
  /// "resolved": the values are so smooth that an isosurface of the reconstruction is more accurate.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Computes a surface of the array that the volume was opened with: of a component, or of the lengths of vectors.
/// Throws ArgumentError for bad options and if an array of several components needs a value, DataError if no sample is
/// near such a surface, Cancelled.
SANSMESH_API SurfaceInVolume surface_in_volume(const VolumeModel& volume, const SurfaceInVolumeOptions& options,
                                               Progress& progress);

/// Value, samples and weights, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceInVolume& surface, const VolumeModel& volume,
                                                 Progress& progress);

/// Options of its mesh.
struct SANSMESH_API MeshInVolumeOptions {
  std::optional<double> mesh_error = {};      ///< as in MeshOptions
  std::optional<std::size_t> triangles = {};  ///< as in MeshOptions
  ComponentChoice components = {};            ///< automatic: components larger than the support of the weights

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of its mesh.
struct SANSMESH_API MeshInVolumeReport {
  MeshReport mesh;               ///< how it was meshed
  double area = 0;               ///< length²
  std::optional<double> volume;  ///< enclosed volume of a closed mesh

  static const ReportSchema& schema();  ///< report rows
};

/// Mesh of a surface of the samples.
struct MeshInVolume {
  TriangleMesh mesh;          ///< mesh in the input's coordinates
  MeshInVolumeReport report;  ///< how it was made
  std::vector<Note> notes;    ///< notes on the mesh
};

/// Meshes the surface. Throws ArgumentError for bad options, DataError if nothing is found, Cancelled.
SANSMESH_API MeshInVolume mesh_of_surface(const SurfaceInVolume& surface, const MeshInVolumeOptions& options,
                                          Progress& progress);

/// Points spread evenly over the surface at a distance (length, at least an eighth of the spacing; default: the
/// spacing), with normals, in the input's coordinates. Throws ArgumentError for other distances.
SANSMESH_API PointSet points_of_surface(const SurfaceInVolume& surface, std::optional<double> distance,
                                        Progress& progress);

}  // namespace sansmesh::inline v1
