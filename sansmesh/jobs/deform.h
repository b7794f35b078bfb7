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
#include "sansmesh/deform.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/image.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/solids.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

/// What is made of a thing that is deformed: the same kind of thing (of a solid a mesh), its sections, or a picture.
enum class DeformAim : std::uint8_t { shape, sections, picture };

/// Options of deformations, whatever is deformed.
struct DeformOptions {
  std::optional<int> frames = {};  ///< so many poses from before to after, 2 or more; default: that after it alone

  std::optional<double> refine = {};  ///< of meshes: edges are cut in half first that bend by more than this (length)
  bool cut_open = false;              ///< closed meshes stay open along cuts

  std::optional<int> resolution = {};  ///< of solids, as CsgMeshOptions has it; of sections squares
  std::optional<double> cell = {}, simplify = {};
  std::optional<ComponentChoice> components = {};  ///< default: automatic with functions, else all
  std::vector<CutPlane> planes = {};               ///< of sections; default: three through the middle
  std::optional<Box3> box = {};                    ///< after the deformation: what ends there

  ResampleOptions lattice = {};  ///< of volumes: its `size` and `outside`

  /// Of volumes in pictures: nodes along the longest side of the map that they are seen through, 8..512.
  int map_nodes = 96;
  bool exact_deformation = false;  ///< in pictures: straight through the deformation, and of solids without a mesh
  bool draw_handles = false, draw_folds = false;
  VolumePictureOptions look = {};  ///< of pictures: all but of volumes its RenderOptions alone
  bool any_view = true;            ///< nobody chose the view: that of a thin volume looks straight at it

  /// Without `look`.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and for such as mean nothing to the aim.
  void validate(DeformAim aim) const;
  int poses() const { return frames.value_or(1); }
  /// Of the way, at a pose.
  double share(int pose) const { return frames ? static_cast<double>(pose) / (*frames - 1) : 1; }
};

/// A picture of a pose.
struct DeformedPicture {
  Image image;
  int bar = 0;  ///< so many columns of it on the right are a colour bar
};

/// A cloud, a mesh, sections of a solid, a lattice, or a picture.
using DeformedPose = std::variant<PointSet, TriangleMesh, std::vector<Section>, GridBlock, DeformedPicture>;
/// Called once for each pose, in their order.
using UsePose = std::function<void(int pose, const DeformedPose& deformed)>;

/// What became of what was deformed.
struct DeformReport {
  FoldReport folds;  ///< of the pose that is folded most
  // Of the last pose:
  std::size_t vertices = 0, triangles = 0;
  std::size_t added = 0;      ///< triangles, where edges bend
  bool fine = true;           ///< false: there were too many triangles to cut all edges that bend
  std::size_t undefined = 0;  ///< vertices and points where the map is not defined: they stay where they are
  std::size_t turned = 0;     ///< vertices and points at which space is turned inside out
  OpenMeshReport cut;         ///< of meshes
  bool mesh_of_open = false;  ///< a function whose surface bounds no solid: its mesh was deformed
  std::optional<CsgMeshReport> solid;
  std::vector<Section> sections;
  std::array<std::size_t, 3> size{};  ///< of a lattice
  double inside = 1;                  ///< share of its points that are in the volume
  std::uint64_t rays = 0, evaluations = 0;
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
};

/// Of a volume the array that it was opened with, for pictures as a scalar, or `all` arrays of the same samples. Throws
/// as VolumeModel::field.
DeformableVolume deformable_volume(const VolumeModel& volume, DeformAim aim, bool all, Progress& progress,
                                   std::vector<Note>& notes);

/// A volume, resampled or seen through the deformation. The same errors, and where values do not fit into
/// floats or nothing comes to be anywhere.
DeformResult deform(const DeformableVolume& volume, const Deformation& deformation, DeformAim aim,
                    const DeformOptions& options, const UsePose& use, Progress& progress);

}  // namespace sansmesh::inline v1
