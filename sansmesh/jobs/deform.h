// Clouds, meshes, functions, solids and volumes, deformed in one pose or in many from before to after.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/folds.h"
#include "sansmesh/deform/open_mesh.h"
#include "sansmesh/error.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/image.h"
#include "sansmesh/jobs/deform_options.h"
#include "sansmesh/jobs/deformation.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/mesh/deformed_mesh.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/solids.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// A cloud, a mesh, sections of a solid, a lattice, or a picture.
using DeformedPose = std::variant<PointSet, TriangleMesh, std::vector<Section>, GridBlock, Image>;
/// Writes a pose; `unit` (mm, cm, in) makes drawings of sections true to scale. Throws FileError.
void write_pose(const std::string& file, const DeformedPose& pose, bool ascii, const std::string& unit);
/// Called once for each pose, in their order.
using UsePose = std::function<void(int pose, const DeformedPose& deformed)>;

struct DeformReport {
  FoldReport folds;  ///< of the pose that is folded most
  // Of the last pose:
  std::size_t vertices = 0, triangles = 0;
  MeshDeformReport mesh;              ///< of clouds and meshes
  std::optional<OpenMeshReport> cut;  ///< of meshes with cuts
  bool mesh_of_open = false;          ///< a function whose surface bounds no solid: its mesh was deformed
  std::optional<CsgMeshReport> solid;
  std::vector<Section> sections;
  std::array<std::size_t, 3> size{};  ///< of a lattice
  double inside = 1;                  ///< share of its points that are in the volume
  std::uint64_t rays = 0, evaluations = 0;

  static const ReportSchema& schema();
};

struct DeformResult {
  DeformReport report;
  /// "folded": space is folded somewhere; "bends_stay": too many triangles to refine them all; "undefined": what the
  /// map does not know stays; "turned": vertices in folds; "uncut", "cut_open": what cuts left whole or open; "open":
  /// functions that bound no solid; "mesh", "picture": what there is to say of meshes and pictures that were made.
  std::vector<Note> notes;
};

/// A cloud, or a mesh, which is opened along cuts first. `name` stands in notes. Throws ArgumentError for bad options,
/// DataError that begins with the name where there is nothing to draw, Cancelled.
DeformResult deform(const PointSet& points, const std::string& name, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress);
/// A solid, as a field that is never sampled before it is deformed. Of a function whose surface bounds no solid the
/// mesh. The same errors, and ArgumentError for solids without an end.
DeformResult deform(const SolidModel& solid, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress);

/// Quantities of one volume.
struct DeformableVolume {
  std::string name;  ///< stands in notes
  std::shared_ptr<const SampledVolume> samples;
  std::vector<std::shared_ptr<const VolumeField>> fields;  ///< one at least; pictures show the first
  std::vector<std::string> arrays;                         ///< their names

  static const ReportSchema& schema();
};

/// Of a volume the array that it was opened with, for pictures as a scalar, or `all` arrays of the same samples. Throws
/// as VolumeModel::field.
DeformableVolume deformable_volume(VolumeModel& volume, DeformAim aim, bool all, Progress& progress,
                                   std::vector<Note>& notes);

/// A volume, resampled or seen through the deformation. The same errors, and where values do not fit into
/// floats or nothing comes to be anywhere.
DeformResult deform(const DeformableVolume& volume, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress);

struct DeformationMapOptions {
  std::optional<int> nodes = {};  ///< along the longest side, 2..1024; default: 64
  std::optional<Box3> box = {};   ///< default: around where what is deformed comes to lie

  static const OptionSchema& schema();
};

struct DeformationMapResult {
  DisplacementMap map;
  FoldReport folds;
  std::vector<Note> notes;  ///< "folded"
};

/// The backward map as displacements on a lattice. `before`: the box of what is deformed. Throws ArgumentError for bad
/// options, and where that box has no end; Cancelled.
DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before, const std::string& name,
                                     const DeformationMapOptions& options, Progress& progress);

/// Finite points.
Box3 bounds_of(const PointSet& points);

}  // namespace sansmesh::inline v1
