// Clouds and meshes moved, cropped, thinned, welded and split, a step after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Rotations and scalings after this leave a place where it is, unless they have one of their own: "about".
struct SANSMESH_API AboutStep {
  std::optional<Vec3> place = {};       ///< default: 0
  bool center = false;                  ///< instead: the middle of the box as it then is
  static const OptionSchema& schema();  ///< a row a field
};

/// Moves everything by a map or its inverse: "transform", "inverse_transform".
struct SANSMESH_API TransformStep {
  AffineMap map = {};                   ///< of positions; normals, scanners and directions follow
  bool inverse = false;                 ///< by its inverse; ArgumentError where there is none
  static const OptionSchema& schema();  ///< a row a field
};

/// Moves everything without turning it; loses no digit, however far: "translate".
struct SANSMESH_API TranslateStep {
  Vec3 by = {};                         ///< length
  static const OptionSchema& schema();  ///< a row a field
};

/// Moves the middle of the box around everything to 0: "center".
struct SANSMESH_API CenterStep {
  static const OptionSchema& schema();  ///< a row a field
};

/// Turns everything about an axis, counter-clockwise as the axis points at one's eye: "rotate".
struct SANSMESH_API RotateStep {
  Vec3 axis = {0, 0, 1};                ///< of any length but 0
  double degrees = 0;                   ///< the angle
  std::optional<Vec3> about = {};       ///< what stays where it is; default: 0
  bool about_center = false;            ///< instead: the middle of the box as it then is
  static const OptionSchema& schema();  ///< a row a field
};

/// Scales by a factor for each axis, none of them 0; negative ones mirror, and turn faces over: "scale".
struct SANSMESH_API ScaleStep {
  Vec3 factors = {1, 1, 1};             ///< of x, y and z
  std::optional<Vec3> about = {};       ///< as in RotateStep
  bool about_center = false;            ///< as in RotateStep
  static const OptionSchema& schema();  ///< a row a field
};

/// Exchanges the axes: "y,x,z" swaps two (a mirror image), "x,-z,y" turns y up into z up: "new_axes".
struct SANSMESH_API AxesStep {
  std::string axes = "x,y,z";           ///< as axes_map reads it
  static const OptionSchema& schema();  ///< a row a field
};

/// The axis that is to point up.
enum class StepUp : std::uint8_t { y, z };

/// Turns what is up to another axis. To z: what pointed up along y points up along z; to y: the other way: "up".
struct SANSMESH_API UpStep {
  StepUp to = StepUp::z;                ///< which is up afterwards
  static const OptionSchema& schema();  ///< a row a field
};

/// Converts from one unit of length to another; both are one of um, mm, cm, m, km, in, ft and us-ft:
/// "to_unit".
struct SANSMESH_API UnitStep {
  std::string from = {};                ///< unit of the data as it comes; default: ConvertOptions::unit
  std::string to = "m";                 ///< unit of the data afterwards
  static const OptionSchema& schema();  ///< a row a field
};

/// Keeps what lies in the box, or outside of it; meshes are cut along it: "box", "outside_box".
struct SANSMESH_API CropStep {
  Box3 box = {};                        ///< in the coordinates of the data as they then are; must not be empty
  bool inside = true;                   ///< keep what lies in it; otherwise what lies outside
  static const OptionSchema& schema();  ///< a row a field
};

/// Fewer points: no two closer than a distance, and none missing that would be farther from all: "point_spacing".
struct SANSMESH_API SpacingStep {
  double distance = 0;                  ///< length, > 0
  static const OptionSchema& schema();  ///< a row a field
};

/// Fewer points: so many, drawn by chance, always the same ones: "point_count".
struct SANSMESH_API CountStep {
  std::size_t count = 0;                ///< how many stay, 1..2·10⁹
  static const OptionSchema& schema();  ///< a row a field
};

/// Fewer points: the first of every so many: "every".
struct SANSMESH_API EveryStep {
  std::size_t every = 0;                ///< one of so many stays, 1..2·10⁹
  static const OptionSchema& schema();  ///< a row a field
};

/// Keeps, of normals, colors and attributes, only these, or all but these: "keep", "drop".
struct SANSMESH_API ChooseStep {
  std::vector<std::string> names = {};  ///< "normals", "colors", names of attributes
  bool keep = true;                     ///< only these; otherwise all but these
  static const OptionSchema& schema();  ///< a row a field
};

/// Makes vertices (or points) no farther from each other than a distance one: "weld".
struct SANSMESH_API WeldStep {
  double distance = 0;                  ///< length, >= 0; 0: only those at the same place
  static const OptionSchema& schema();  ///< a row a field
};

/// Turns faces over, and normals round: "flip", "flip_faces", "flip_normals".
struct SANSMESH_API FlipStep {
  bool faces = true;                    ///< turn these over
  bool normals = true;                  ///< turn these round
  static const OptionSchema& schema();  ///< a row a field
};

/// One step of a conversion.
using ConvertStep =
    std::variant<AboutStep, TransformStep, TranslateStep, CenterStep, RotateStep, ScaleStep, AxesStep, UpStep, UnitStep,
                 CropStep, SpacingStep, CountStep, EveryStep, ChooseStep, WeldStep, FlipStep>;

/// All steps that there are, as the options of a list of steps.
SANSMESH_API std::span<const OptionRow> convert_step_rows();

/// Name of a step, as it stands behind the kind above: "outside_box".
SANSMESH_API std::string_view step_name(const ConvertStep& step);

/// Throws ArgumentError for values that are not allowed.
SANSMESH_API void validate_step(const ConvertStep& step);

/// "x,-z,y": the axes whose coordinates the new x, y and z are. Throws ArgumentError.
SANSMESH_API AffineMap axes_map(std::string_view axes);

/// Length of a unit in metres: of um, mm, cm, m, km, in, ft and us-ft. Throws ArgumentError that names them.
SANSMESH_API double meters_of_unit(std::string_view unit);

/// The vertices of a mesh as a cloud, with all that belongs to them.
SANSMESH_API PointSet vertices_of(TriangleMesh mesh);

/// A cloud, or a mesh.
struct SANSMESH_API CloudOrMesh {
  bool is_mesh = false;  ///< which of the two it is
  PointSet points;       ///< unless it is a mesh
  TriangleMesh mesh;     ///< if it is one
  /// Attributes of three reals that were not turned with everything else: nobody knows whether they are directions.
  std::vector<std::string> unturned;
  /// Edges of three triangles or more that welding has made.
  std::size_t nonmanifold_edges_of_weld = 0;

  /// As it was read: a mesh if it has triangles. Which file or scan each sample is of becomes an attribute, "source",
  /// if there are several.
  explicit CloudOrMesh(PointSet read);

  /// Number of points or vertices.
  std::size_t size() const { return is_mesh ? mesh.vertices.size() : points.size(); }
  /// "1,234 points", or "1,234 vertices, 2,345 triangles".
  std::string size_words() const;
  /// Of the positions: world position = origin + position.
  const Vec3& origin() const { return is_mesh ? mesh.origin : points.origin; }
  /// Box around the points or vertices, in the coordinates of the file.
  Box3 bounds() const;
  /// Of the points or vertices.
  const AttributeTable& attributes() const { return is_mesh ? mesh.attributes : points.attributes; }
  /// ", with normals, colours, intensity and 3 more": what there is but for what is lost.
  std::string belongings(const std::vector<std::string>& lost) const;
  /// Drops the triangles of a mesh: its vertices become the points.
  void make_points();
};

/// Steps of a conversion.
struct SANSMESH_API ConvertOptions {
  bool vertices_only = false;           ///< of a mesh the vertices alone, from the start
  std::string unit = {};                ///< of the input's lengths, for UnitStep
  std::vector<ConvertStep> steps = {};  ///< in their order

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError.
  void validate() const;
};

/// What there was after a step.
struct SANSMESH_API ConvertedBy {
  std::string_view step;                 ///< its name
  std::string remark;                    ///< what became of the data, in words; may be empty
  std::size_t size = 0;                  ///< points or vertices
  std::optional<std::size_t> triangles;  ///< of a mesh

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Numbers of a run of convert().
struct SANSMESH_API ConvertReport {
  std::string size_words;          ///< of what came: "1,234 points"
  std::size_t size = 0;            ///< points or vertices of what came
  std::size_t triangles = 0;       ///< of what came; 0 of a cloud
  std::vector<ConvertedBy> steps;  ///< after each of them

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Converted cloud or mesh.
struct ConvertResult {
  CloudOrMesh data;      ///< after the last step
  ConvertReport report;  ///< what the steps did
  /// "nonmanifold_weld": edges of three triangles or more were made; "unturned": attributes of three numbers that
  /// nobody knows to be directions.
  std::vector<Note> notes;
};

/// Throws FileError early where neither a mesh nor points can be written there. `points`: these are wanted.
SANSMESH_API void check_converted(const std::string& file, bool points);
/// Meshes become points where the format of the file has no faces: "no_faces". Points never become a mesh: throws
/// FileError.
SANSMESH_API std::vector<Note> fit_to_format(CloudOrMesh& data, const std::string& file);

/// Parts that the format of the file has no room for: "normals", names of attributes.
SANSMESH_API std::vector<std::string> left_out(const std::string& file, const CloudOrMesh& data);
/// Writes a cloud or a mesh that fits; `ascii`: as text where the format has both. Throws FileError.
SANSMESH_API void write_converted(const std::string& file, const CloudOrMesh& data, bool ascii = false);

/// Takes what a file held through all steps, in their order. Throws ArgumentError for bad options, DataError naming the
/// step where one cannot be done or leaves nothing,
/// Cancelled.
SANSMESH_API ConvertResult convert(PointSet read, const ConvertOptions& options, Progress& progress);

/// Remarks of the steps on what became of the data, a line each.
SANSMESH_API std::vector<std::string> summary_of(const ConvertReport& report);

/// What counts as connected, and which parts are kept.
struct SANSMESH_API SplitOptions {
  /// Of clouds: points as close as this are connected (length, > 0). Default: 4 spacings.
  std::optional<double> split_distance = {};
  std::size_t min_size = 0;         ///< parts of fewer triangles (or points) are left out
  std::size_t most_parts = 10'000;  ///< more are an error

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError.
  void validate() const;
};

/// Connected parts of a cloud or mesh.
struct SANSMESH_API SplitResult {
  std::vector<CloudOrMesh> parts;  ///< the largest first
  std::size_t found = 0;           ///< parts, those that were left out included
  std::optional<double> distance;  ///< of clouds: `split_distance` as used (length)
  /// "small_parts": parts that were left out; "soup": hardly any triangles share a vertex; "loose_points": vertices of
  /// no triangle were left out.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Takes a cloud or mesh apart into its connected parts. Throws ArgumentError for bad options, DataError where none is
/// large enough or there are too many, Cancelled.
SANSMESH_API SplitResult split(const CloudOrMesh& data, const SplitOptions& options, Progress& progress);

/// How many parts there are, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SplitResult& made);

}  // namespace sansmesh::inline v1
