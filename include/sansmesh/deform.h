// Deformations of space with all that they need: by handles, or by a map of displacements.
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

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/image.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/solids.h"
#include "sansmesh/space_map.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

class Occluder;

/// Both ways through one deformation.
struct DeformationMaps {
  std::shared_ptr<const SpaceMap> backward;  ///< from places after to places before: fields and volumes are seen by it
  std::shared_ptr<const SpaceMap> forward;   ///< the other way: meshes and clouds are moved by it
};

/// A cut that handles do not reach through, as users write it. "half-plane(x,y,z; x,y,z; x,y,z)": a point of its edge,
/// its normal, and where it extends to; "polygon(x,y,z; …)" with "|" before each hole; or the name of a mesh. `domain`
/// holds handles and what is deformed. Throws ArgumentError, FileError.
SANSMESH_API std::shared_ptr<const Occluder> read_cut(const std::string& text, const Box3& domain);

/// A deformation of space. Cheap to copy: what it holds is shared and never changes.
class SANSMESH_API Deformation {
 public:
  /// By moving least squares. `name` stands in messages: the file of the handles, if there is one. Throws
  /// ArgumentError for bad options, and for handles that cannot be; FileError in its place where there is a name.
  explicit Deformation(std::vector<Handle> handles, const MlsDeformationOptions& options = {},
                       std::vector<std::shared_ptr<const Occluder>> cuts = {}, std::string name = {});
  /// By a backward map, whose inverse is found by Newton's method.
  explicit Deformation(std::shared_ptr<const SpaceMap> backward, std::string name = {});
  /// The same of displacements on a lattice, as deformation_map makes them. Throws DataError where it is no lattice of
  /// even spacing along the axes, or lacks the array, ArgumentError where it has no size.
  explicit Deformation(const GridBlock& displacements, std::string name = {});

  /// As far as it has come at a share of the way, 0..1; other than 1 means nothing to a map of displacements.
  DeformationMaps at(double share) const;
  /// The handles there; none of a map.
  std::vector<Handle> handles_at(double share) const;
  /// By handles, not by a map.
  bool has_handles() const;
  /// Where handles do not reach through.
  const std::vector<std::shared_ptr<const Occluder>>& cuts() const;
  /// About where what lies in `box` comes to lie; nothing where that is not known.
  std::optional<Box3> box_of(const DeformationMaps& maps, const Box3& box) const;
  /// Balls and arrows of the handles there, for pictures of something so large.
  TriangleMesh handle_shapes_at(double share, double size) const;

  /// What it is called in messages.
  const std::string& name() const;
  /// Of handles.
  const MlsDeformationOptions& options() const;
  /// "15 handles, rigid", "by a displacement map"
  std::string words() const;

  static const ReportSchema& schema();  ///< a row for each thing that it tells

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

// ---- From files --------------------------------------------------------------------------------------------------

/// One of `handles`, `handles_from` and `map`.
struct SANSMESH_API DeformationInput {
  std::string handles = {};                      ///< file (docs/formats/handles.md)
  std::vector<std::string> handles_from = {};    ///< two files whose vertices correspond: before, after
  std::vector<std::uint32_t> vertices = {};      ///< of these, which are handles
  std::optional<std::size_t> handle_count = {};  ///< instead: so many, far from each other; default: 30
  std::string map = {};                          ///< file of a lattice of displacements
  MlsDeformationOptions by = {};                 ///< of handles
  std::vector<std::string> cuts = {};            ///< each as read_cut reads it

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError for what does not go together.
  void validate() const;
};

/// Throws FileError for bad files, ArgumentError for bad options.
SANSMESH_API Deformation read_deformation(const DeformationInput& input, Progress& progress);

// ---- As a map ----------------------------------------------------------------------------------------------------

/// The lattice of a map of displacements.
struct SANSMESH_API DeformationMapOptions {
  std::optional<int> nodes = {};  ///< along the longest side, 2..1024; default: 64
  std::optional<Box3> box = {};   ///< default: around where what is deformed comes to lie

  /// The rows of these options.
  static const OptionSchema& schema();
};

// ---- Options -----------------------------------------------------------------------------------------------------

/// What is made of a thing that is deformed: the same kind of thing (of a solid a mesh), its sections, or a picture.
enum class DeformAim : std::uint8_t { shape, sections, picture };
/// What a file is to hold, by its ending: a picture (.png), sections (.svg, .csv), or else a shape.
SANSMESH_API DeformAim deform_aim(const std::string& file);

/// Options of deformations, whatever is deformed.
struct SANSMESH_API DeformOptions {
  std::optional<int> frames = {};  ///< so many poses from before to after, 2 or more; default: that after it alone

  std::optional<double> refine = {};  ///< of meshes: edges are cut in half first that bend by more than this (length)
  bool cut_open = false;              ///< closed meshes stay open along cuts

  std::optional<int> resolution = {};              ///< of solids, as CsgMeshOptions has it; of sections squares
  std::optional<double> cell = {};                 ///< of solids, as CsgMeshOptions has it (length)
  std::optional<double> simplify = {};             ///< of solids, as CsgMeshOptions has it (length)
  std::optional<ComponentChoice> components = {};  ///< default: automatic with functions, else all
  std::vector<CutPlane> planes = {};               ///< of sections; default: three through the middle
  std::optional<Box3> box = {};                    ///< after the deformation: what ends there

  ResampleOptions lattice = {};  ///< of volumes: its `size` and `outside`

  /// Of volumes in pictures: nodes along the longest side of the map that they are seen through, 8..512.
  int map_nodes = 96;
  bool exact_deformation = false;  ///< in pictures: straight through the deformation, and of solids without a mesh
  bool draw_handles = false;       ///< in pictures: handles as balls and arrows
  bool draw_folds = false;         ///< in pictures: places where space is folded
  VolumePictureOptions look = {};  ///< of pictures: all but of volumes its RenderOptions alone
  bool any_view = true;            ///< nobody chose the view: that of a thin volume looks straight at it

  /// Without `look`.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and for such as mean nothing to the aim.
  void validate(DeformAim aim) const;
  /// The same, and for such as mean nothing to the deformation.
  void validate(DeformAim aim, const Deformation& deformation) const;
  /// Number of poses, 1 or more.
  int poses() const { return frames.value_or(1); }
  /// Of the way, at a pose.
  double share(int pose) const { return frames ? static_cast<double>(pose) / (*frames - 1) : 1; }
};

/// A picture of a pose.
struct DeformedPicture {
  Image image;  ///< with the bar
  int bar = 0;  ///< so many columns of it on the right are a colour bar
};

/// A cloud, a mesh, sections of a solid, a lattice, or a picture.
using DeformedPose = std::variant<PointSet, TriangleMesh, std::vector<Section>, GridBlock, DeformedPicture>;

/// Writes a pose; `unit` (mm, cm, in) makes drawings of sections true to scale. Throws FileError.
SANSMESH_API void write_pose(const std::string& file, const DeformedPose& pose, bool ascii, const std::string& unit);

/// Called once for each pose, in their order.
using UsePose = std::function<void(int pose, const DeformedPose& deformed)>;

/// What became of what was deformed.
struct SANSMESH_API DeformReport {
  FoldReport folds;  ///< of the pose that is folded most
  // Of the last pose:
  std::size_t vertices = 0;            ///< or points
  std::size_t triangles = 0;           ///< 0 of clouds
  std::size_t added = 0;               ///< triangles, where edges bend
  bool fine = true;                    ///< false: there were too many triangles to cut all edges that bend
  std::size_t undefined = 0;           ///< vertices and points where the map is not defined: they stay where they are
  std::size_t turned = 0;              ///< vertices and points at which space is turned inside out
  std::optional<OpenMeshReport> cut;   ///< of meshes with cuts
  bool mesh_of_open = false;           ///< a function whose surface bounds no solid: its mesh was deformed
  std::optional<CsgMeshReport> solid;  ///< of the mesh of a solid
  std::vector<Section> sections;       ///< where they were asked for
  std::array<std::size_t, 3> size{};   ///< of a lattice
  std::optional<double> inside;        ///< share of its points that are in the volume
  std::uint64_t rays = 0;              ///< of pictures of volumes
  std::uint64_t evaluations = 0;       ///< of the volume, along these rays

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What came of a deformation; the poses themselves were handed over.
struct DeformResult {
  DeformReport report;  ///< numbers
  /// "folded": space is folded somewhere; "bends_stay": too many triangles to refine them all; "undefined": what the
  /// map does not know stays; "turned": vertices in folds; "uncut", "cut_open": what cuts left whole or open; "open":
  /// functions that bound no solid; "mesh", "picture": what there is to say of meshes and pictures that were made.
  std::vector<Note> notes;
};

/// What was made, in lines for people; none of pictures of volumes.
SANSMESH_API std::vector<std::string> summary_of(const DeformReport& report);

/// The backward map of a deformation as displacements on a lattice.
struct DeformationMapResult {
  GridBlock block;          ///< arrays `displacement` (3 floats) and, where there are gaps, `gap` (1 float)
  DeformReport report;      ///< folds of the map in its box, and its size
  std::vector<Note> notes;  ///< "folded"
};

/// `before`: the box of what is deformed. Throws ArgumentError for bad options, and where that box has no end;
/// Cancelled.
SANSMESH_API DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before,
                                                  const std::string& name, const DeformationMapOptions& options,
                                                  Progress& progress);

// ---- Things that are deformed ------------------------------------------------------------------------------------

/// A cloud, or a mesh, which is opened along cuts first. `name` stands in notes. Throws ArgumentError for bad options,
/// DataError that begins with the name where there is nothing to draw, Cancelled.
SANSMESH_API DeformResult deform(const PointSet& points, const std::string& name, const Deformation& deformation,
                                 DeformAim aim, const DeformOptions& options, const UsePose& use, Progress& progress);

/// A solid, as a field that is never sampled before it is deformed. Of a function whose surface bounds no solid the
/// mesh. The same errors, and ArgumentError for solids without an end.
SANSMESH_API DeformResult deform(const SolidModel& solid, const Deformation& deformation, DeformAim aim,
                                 const DeformOptions& options, const UsePose& use, Progress& progress);

/// Quantities of one volume.
struct SANSMESH_API DeformableVolume {
  std::string name;                                        ///< stands in notes
  std::shared_ptr<const SampledVolume> samples;            ///< where its values are known
  std::vector<std::shared_ptr<const VolumeField>> fields;  ///< one at least; pictures show the first
  std::vector<std::string> arrays;                         ///< their names

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Of a volume the array that it was opened with, for pictures as a scalar, or `all` arrays of the same samples. Throws
/// as VolumeModel::field.
SANSMESH_API DeformableVolume deformable_volume(const VolumeModel& volume, DeformAim aim, bool all, Progress& progress,
                                                std::vector<Note>& notes);

/// A volume, resampled or seen through the deformation. The same errors, and where values do not fit into
/// floats or nothing comes to be anywhere.
SANSMESH_API DeformResult deform(const DeformableVolume& volume, const Deformation& deformation, DeformAim aim,
                                 const DeformOptions& options, const UsePose& use, Progress& progress);

/// Kinds of things that can be deformed; of the first meshes, too.
enum class DeformKind : std::uint8_t { points, solid, volume };

/// What is named by one file or several, or by the expression of a solid, which is told from names alone. Throws
/// FileError for a file that does not exist.
SANSMESH_API DeformKind deform_kind(const std::vector<std::string>& names);

/// Throws FileError early, before long work, where what is made of a thing of that kind cannot be written.
SANSMESH_API void check_deformed(const std::string& file, DeformKind kind);

/// A thing of any kind, as the functions above take it.
using DeformSubject = std::variant<PointSet, SolidModel, DeformableVolume>;

/// Box around the finite points.
SANSMESH_API Box3 bounds_of(const PointSet& points);
/// Box around a thing of any kind; infinite where it has no end.
SANSMESH_API Box3 bounds_of(const DeformSubject& subject);

/// Calls the one of the functions above that takes it; `name` is that of a cloud.
SANSMESH_API DeformResult deform(const DeformSubject& subject, const std::string& name, const Deformation& deformation,
                                 DeformAim aim, const DeformOptions& options, const UsePose& use, Progress& progress);

}  // namespace sansmesh::inline v1
