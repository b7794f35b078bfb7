// Surfaces in volumes: where a quantity has a value, at one moment or at many, and surfaces straight from the samples.
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

// ---- Of a value --------------------------------------------------------------------------------------------------

/// Which surface of a volume, and its mesh.
struct SANSMESH_API VolumeIsosurfaceOptions {
  std::optional<double> value = {};  ///< default: the middle of the array's range
  /// Other arrays at the vertices, interpolated in the grid's own way: "all", "none", or names with commas between.
  std::string carry = "all";
  IsosurfaceOptions mesh = {};  ///< how it is cut out

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What became of an isosurface.
struct SANSMESH_API VolumeIsosurfaceReport {
  ReconstructionReport reconstruction;  ///< of the field
  double value = 0;                     ///< on the surface
  IsosurfaceReport mesh;                ///< how it was cut out

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// An isosurface as a mesh.
struct VolumeIsosurfaceResult {
  TriangleMesh mesh;              ///< in the input's coordinates
  VolumeIsosurfaceReport report;  ///< what became of it
  /// Those of VolumeModel::field; "mesh": what became of the mesh; "not_carried": an array does not fit into floats.
  std::vector<Note> notes;
};

/// The surface on which a quantity of a volume has a value, as a mesh: of the array that the volume was opened with.
/// Throws as VolumeModel::isosurface, ArgumentError for bad options and where an array of several components needs a
/// value, DataError where nothing is found, Cancelled.
SANSMESH_API VolumeIsosurfaceResult isosurface(const VolumeModel& volume, const VolumeIsosurfaceOptions& options,
                                               Progress& progress);

// ---- At many moments ---------------------------------------------------------------------------------------------

/// Moments of a surface that changes.
struct SANSMESH_API IsosurfaceMomentsOptions {
  std::optional<std::size_t> frames = {};  ///< moments from the first step to the last; default: as many as steps
  /// How long the smallest blocks in space and time last (time, > 0); default: the shortest time between steps.
  std::optional<double> time_cell = {};

  /// The rows of these options.
  static const OptionSchema& schema();
};

/// The mesh of a moment, measured.
struct SANSMESH_API IsosurfaceMoment {
  double time = 0;                                          ///< of the moment
  std::size_t vertices = 0, triangles = 0, components = 0;  ///< how many
  bool closed = true;                                       ///< no edge is open
  double area = 0, volume = 0;                              ///< length², length³

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What became of a surface that changes.
struct SANSMESH_API IsosurfaceMomentsReport {
  ReconstructionReport reconstruction;    ///< of the first step
  double value = 0;                       ///< on the surface
  std::size_t blocks = 0;                 ///< in space and time
  double cell = 0, time_cell = 0;         ///< edge and duration of the smallest blocks
  std::vector<IsosurfaceMoment> moments;  ///< in their order

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// A surface that changes; its meshes were handed over.
struct IsosurfaceMomentsResult {
  IsosurfaceMomentsReport report;  ///< what became of it
  /// Those of VolumeModel::field; "no_surface": nothing is there at a moment; "more_triangles": fewer were asked for.
  std::vector<Note> notes;
};

/// The surface on which a quantity of a volume that changes has a value, in space and time, cut at moments from the
/// first step to the last: closed meshes, one after the other handed to `use` with the number of the moment. Throws as
/// isosurface(), ArgumentError for `carry`, `closed` and `components`, which are not for these.
SANSMESH_API IsosurfaceMomentsResult isosurface_moments(
    const VolumeSeries& series, const VolumeIsosurfaceOptions& options, const IsosurfaceMomentsOptions& moments,
    const std::function<void(std::size_t, const TriangleMesh&)>& use, Progress& progress);
/// Throws what isosurface_moments throws for its options, before anything is read.
SANSMESH_API void check_moments(const VolumeIsosurfaceOptions& options, const IsosurfaceMomentsOptions& moments);
/// Number of moments.
SANSMESH_API std::size_t moment_count(const VolumeSeries& series, const IsosurfaceMomentsOptions& moments);

// ---- Straight from the samples -----------------------------------------------------------------------------------

/// Which surface of the samples.
struct SANSMESH_API SurfaceInVolumeOptions {
  std::optional<double> value = {};   ///< default: the middle of the array's range; not for surfaces of high gradient
  VolumeSurfaceOptions surface = {};  ///< its value is the one above

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A surface that a volume's samples define: of one value, or where the quantity changes most. Cheap to copy.
struct SANSMESH_API SurfaceInVolume {
  std::shared_ptr<const VolumeSurface> surface;  ///< for the jobs below and for pictures
  VolumeSurfaceReport report;                    ///< how it was found
  double value = 0;                              ///< of the array; of high gradient none
  std::string name;                              ///< of the volume, for messages
  /// "resolved": the values are so smooth that an isosurface of the reconstruction is nearer.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Of the array that the volume was opened with: of a component, or lengths of vectors. Throws ArgumentError for bad
/// options and where an array of several components needs a value, DataError where no sample is near such a surface,
/// Cancelled.
SANSMESH_API SurfaceInVolume surface_in_volume(const VolumeModel& volume, const SurfaceInVolumeOptions& options,
                                               Progress& progress);

/// Value, samples and weights, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceInVolume& surface, const VolumeModel& volume,
                                                 Progress& progress);

/// Its mesh.
struct SANSMESH_API MeshInVolumeOptions {
  std::optional<double> mesh_error = {};      ///< as in MeshOptions
  std::optional<std::size_t> triangles = {};  ///< as in MeshOptions
  ComponentChoice components = {};            ///< automatic: those that are larger than the weights are wide

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What became of its mesh.
struct SANSMESH_API MeshInVolumeReport {
  MeshReport mesh;               ///< how it was cut out
  double area = 0;               ///< length²
  std::optional<double> volume;  ///< enclosed, where the mesh is closed

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Its mesh with what there is to say of it.
struct MeshInVolume {
  TriangleMesh mesh;          ///< in the input's coordinates
  MeshInVolumeReport report;  ///< what became of it
  std::vector<Note> notes;    ///< "mesh": what became of the mesh
};

/// The surface as a mesh. Throws ArgumentError for bad options, DataError where nothing is found, Cancelled.
SANSMESH_API MeshInVolume mesh_of_surface(const SurfaceInVolume& surface, const MeshInVolumeOptions& options,
                                          Progress& progress);

/// Points spread evenly over the surface, so far apart (length, at least an eighth of the spacing; default: the
/// spacing), with normals, in the input's coordinates. Throws ArgumentError for other distances.
SANSMESH_API PointSet points_of_surface(const SurfaceInVolume& surface, std::optional<double> distance,
                                        Progress& progress);

}  // namespace sansmesh::inline v1
