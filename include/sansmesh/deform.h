// Deformations of space by handles or by displacement maps, and the objects that they deform.
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

/// Both directions of one deformation.
struct DeformationMaps {
  std::shared_ptr<const SpaceMap>
      backward;  ///< from deformed to original points; fields and volumes are evaluated through it
  std::shared_ptr<const SpaceMap> forward;  ///< from original to deformed points; meshes and clouds are moved by it
};

/// Parses a cut, which handles do not act across. "half-plane(x,y,z; x,y,z; x,y,z)" has a point of its edge, its
/// normal, and the direction in which it extends; "polygon(x,y,z; …)" has "|" before each hole; otherwise the text is
/// the file of a mesh. `domain` contains the handles and the deformed object. Throws ArgumentError, FileError.
SANSMESH_API std::shared_ptr<const Occluder> read_cut(const std::string& text, const Box3& domain);

/// A deformation of space. Cheap to copy: copies share immutable data.
class SANSMESH_API Deformation {
 public:
  /// Moving least squares. `name` appears in messages: the file of the handles, if any. Throws ArgumentError for bad
  /// options and for impossible handles; if there is a name, FileError instead.
  explicit Deformation(std::vector<Handle> handles, const MlsDeformationOptions& options = {},
                       std::vector<std::shared_ptr<const Occluder>> cuts = {}, std::string name = {});
  /// A backward map, inverted by Newton's method.
  explicit Deformation(std::shared_ptr<const SpaceMap> backward, std::string name = {});
  /// A backward map of displacements on a lattice, as deformation_map makes them. Throws DataError if the lattice is
  /// not evenly spaced along the axes or lacks the array, ArgumentError if it has no extent.
  explicit Deformation(const GridBlock& displacements, std::string name = {});

  /// The deformation at a share of the way, 0..1. Displacement maps ignore shares other than 1.
  DeformationMaps at(double share) const;
  /// Handles at that share; none for a map.
  std::vector<Handle> handles_at(double share) const;
  /// Whether handles, not a map, define it.
  bool has_handles() const;
  /// Surfaces that handles do not act across.
  const std::vector<std::shared_ptr<const Occluder>>& cuts() const;
  /// Approximate bounding box of the deformed `box`, if known.
  std::optional<Box3> box_of(const DeformationMaps& maps, const Box3& box) const;
  /// Balls and arrows for the handles, for pictures of an object of that size.
  TriangleMesh handle_shapes_at(double share, double size) const;

  /// Name in messages.
  const std::string& name() const;
  /// Options of the moving least squares.
  const MlsDeformationOptions& options() const;
  /// "15 handles, rigid", "by a displacement map"
  std::string words() const;

  static const ReportSchema& schema();  ///< report rows

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

// ---- From files --------------------------------------------------------------------------------------------------

/// Exactly one of `handles`, `handles_from` and `map`.
struct SANSMESH_API DeformationInput {
  std::string handles = {};                      ///< file (docs/formats/handles.md)
  std::vector<std::string> handles_from = {};    ///< two files with corresponding vertices: before, after
  std::vector<std::uint32_t> vertices = {};      ///< vertices of these that are handles
  std::optional<std::size_t> handle_count = {};  ///< alternatively: number of handles, spread evenly; default: 30
  std::string map = {};                          ///< file with a lattice of displacements
  MlsDeformationOptions by = {};                 ///< options for handles
  std::vector<std::string> cuts = {};            ///< cuts in the syntax of read_cut

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError for options that exclude each other.
  void validate() const;
};

/// Throws FileError for bad files, ArgumentError for bad options.
SANSMESH_API Deformation read_deformation(const DeformationInput& input, Progress& progress);

// ---- As a map ----------------------------------------------------------------------------------------------------

/// The lattice of a map of displacements.
struct SANSMESH_API DeformationMapOptions {
  std::optional<int> nodes = {};  ///< nodes along the longest side, 2..1024; default: 64
  std::optional<Box3> box = {};   ///< default: around the deformed object

  /// Option rows, one per field.
  static const OptionSchema& schema();
};

// ---- Options -----------------------------------------------------------------------------------------------------

/// Result of a deformation: an object of the same kind (a mesh for a solid), its sections, or a picture.
enum class DeformAim : std::uint8_t { shape, sections, picture };
/// Contents of a file by its ending: a picture (.png), sections (.svg, .csv), or else a shape.
SANSMESH_API DeformAim deform_aim(const std::string& file);

/// Options of deformations of any object.
struct SANSMESH_API DeformOptions {
  std::optional<int> frames = {};  ///< number of poses from before to after, 2 or more; default: the last one only

  std::optional<double> refine = {};  ///< for meshes: first halves edges that bend by more than this (length)
  bool cut_open = false;              ///< leaves closed meshes open along cuts

  std::optional<int> resolution = {};  ///< for solids: CsgMeshOptions::resolution; for sections: squares of the lattice
  std::optional<double> cell = {};     ///< for solids: CsgMeshOptions::cell (length)
  std::optional<double> simplify = {};             ///< for solids: CsgMeshOptions::simplify (length)
  std::optional<ComponentChoice> components = {};  ///< default: automatic if there are functions, else all
  std::vector<CutPlane> planes = {};               ///< planes of sections; default: three through the middle
  std::optional<Box3> box = {};                    ///< box after the deformation; the result ends at its sides

  ResampleOptions lattice = {};  ///< for volumes: `size` and `outside` of the result

  /// For pictures of volumes: nodes along the longest side of the map through which they are sampled, 8..512.
  int map_nodes = 96;
  bool exact_deformation = false;  ///< in pictures: evaluates the deformation exactly, for solids without a mesh
  bool draw_handles = false;       ///< in pictures: draws handles as balls and arrows
  bool draw_folds = false;         ///< in pictures: draws the regions where space folds
  VolumePictureOptions look = {};  ///< for pictures; for objects other than volumes only its RenderOptions
  bool default_view = true;        ///< no view was chosen: the view of a thin volume is perpendicular to it

  /// Option rows without `look`.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options and for options that do not apply to the aim.
  void validate(DeformAim aim) const;
  /// Also throws ArgumentError for options that do not apply to the deformation.
  void validate(DeformAim aim, const Deformation& deformation) const;
  /// Number of poses, 1 or more.
  int poses() const { return frames.value_or(1); }
  /// Share of the way at a pose.
  double share(int pose) const { return frames ? static_cast<double>(pose) / (*frames - 1) : 1; }
};

/// Picture of a pose.
struct DeformedPicture {
  Image image;  ///< picture with the colour bar
  int bar = 0;  ///< number of pixel columns on the right that the colour bar takes
};

/// A cloud, a mesh, sections of a solid, a lattice, or a picture.
using DeformedPose = std::variant<PointSet, TriangleMesh, std::vector<Section>, GridBlock, DeformedPicture>;

/// Writes a pose; `unit` (mm, cm, in) makes drawings of sections true to scale. Throws FileError.
SANSMESH_API void write_pose(const std::string& file, const DeformedPose& pose, bool ascii, const std::string& unit);

/// Called once for each pose, in order.
using UsePose = std::function<void(int pose, const DeformedPose& deformed)>;

/// Report of a deformation.
struct SANSMESH_API DeformReport {
  FoldReport folds;  ///< folds of the pose with the most
  // Of the last pose:
  std::size_t vertices = 0;            ///< vertices or points
  std::size_t triangles = 0;           ///< triangles; 0 for clouds
  std::size_t added = 0;               ///< triangles added at edges that bend
  bool fine = true;                    ///< false: the limit of triangles left edges that bend unrefined
  std::size_t undefined = 0;           ///< vertices and points outside the domain of the map; they do not move
  std::size_t turned = 0;              ///< vertices and points where the map reverses orientation
  std::optional<OpenMeshReport> cut;   ///< for meshes with cuts
  bool mesh_of_open = false;           ///< the mesh of a function was deformed, since its surface bounds no solid
  std::optional<CsgMeshReport> solid;  ///< for the mesh of a solid
  std::vector<Section> sections;       ///< sections, if requested
  std::array<std::size_t, 3> size{};   ///< size of a lattice
  std::optional<double> inside;        ///< share of lattice points inside the volume
  std::uint64_t rays = 0;              ///< for pictures of volumes
  std::uint64_t evaluations = 0;       ///< evaluations of the volume along these rays

  static const ReportSchema& schema();  ///< report rows
};

/// Result of deform(); the poses were passed to the callback.
struct DeformResult {
  DeformReport report;  ///< counts and measures
  /// "folded": space folds somewhere; "bends_stay": too many triangles to refine all; "undefined": points outside the
  /// domain of the map do not move; "turned": vertices in folds; "uncut", "cut_open": effects of cuts; "open":
  /// functions that bound no solid; "picture": notes on pictures; further ones on meshes.
  std::vector<Note> notes;
};

/// What was made, as lines of text; empty for pictures of volumes.
SANSMESH_API std::vector<std::string> summary_of(const DeformReport& report);

/// Backward map of a deformation as displacements on a lattice.
struct DeformationMapResult {
  GridBlock block;          ///< arrays `displacement` (3 floats) and, where there are gaps, `gap` (1 float)
  DeformReport report;      ///< folds of the map in its box, and size of the lattice
  std::vector<Note> notes;  ///< "folded"
};

/// Samples the backward map. `before`: box of the original object. Throws ArgumentError for bad options and for an
/// infinite box; Cancelled.
SANSMESH_API DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before,
                                                  const std::string& name, const DeformationMapOptions& options,
                                                  Progress& progress);

// ---- Deformed objects --------------------------------------------------------------------------------------------

/// Deforms a cloud or a mesh; a mesh is first opened along cuts. `name` appears in notes. Throws ArgumentError for bad
/// options, DataError that begins with the name if there is nothing to draw, Cancelled.
SANSMESH_API DeformResult deform(const PointSet& points, const std::string& name, const Deformation& deformation,
                                 DeformAim aim, const DeformOptions& options, const UsePose& use, Progress& progress);

/// Deforms a solid as a field, without sampling it first. For a function whose surface bounds no solid, its mesh is
/// deformed. Throws as above, and ArgumentError for unbounded solids.
SANSMESH_API DeformResult deform(const SolidModel& solid, const Deformation& deformation, DeformAim aim,
                                 const DeformOptions& options, const UsePose& use, Progress& progress);

/// Quantities of one volume.
struct SANSMESH_API DeformableVolume {
  std::string name;                                        ///< name in notes
  std::shared_ptr<const SampledVolume> samples;            ///< samples of the volume
  std::vector<std::shared_ptr<const VolumeField>> fields;  ///< at least one; pictures show the first
  std::vector<std::string> arrays;                         ///< names of their arrays

  static const ReportSchema& schema();  ///< report rows
};

/// The array that a volume was opened with, as a scalar for pictures, or `all` arrays of the same samples. Throws as
/// VolumeModel::field.
SANSMESH_API DeformableVolume deformable_volume(const VolumeModel& volume, DeformAim aim, bool all, Progress& progress,
                                                std::vector<Note>& notes);

/// Deforms a volume: resamples it, or draws it through the deformation. Throws as above, and if values do not fit into
/// floats or the result is empty.
SANSMESH_API DeformResult deform(const DeformableVolume& volume, const Deformation& deformation, DeformAim aim,
                                 const DeformOptions& options, const UsePose& use, Progress& progress);

/// Kinds of objects that can be deformed; `points` includes meshes.
enum class DeformKind : std::uint8_t { points, solid, volume };

/// Kind of the files or of the expression of a solid, derived from the names only. Throws FileError if a file does not
/// exist.
SANSMESH_API DeformKind deform_kind(const std::vector<std::string>& names);

/// Throws FileError early if the file cannot hold the result for an object of that kind.
SANSMESH_API void check_deformed(const std::string& file, DeformKind kind);

/// Object of any kind, as accepted by the functions above.
using DeformSubject = std::variant<PointSet, SolidModel, DeformableVolume>;

/// Bounding box of the finite points.
SANSMESH_API Box3 bounds_of(const PointSet& points);
/// Bounding box of any object; infinite for unbounded ones.
SANSMESH_API Box3 bounds_of(const DeformSubject& subject);

/// Calls the matching function above; `name` is that of a cloud.
SANSMESH_API DeformResult deform(const DeformSubject& subject, const std::string& name, const Deformation& deformation,
                                 DeformAim aim, const DeformOptions& options, const UsePose& use, Progress& progress);

}  // namespace sansmesh::inline v1
