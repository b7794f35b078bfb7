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

#include "sansmesh/affine_map.h"
#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// What follows turns and scales about this, unless it says so itself: "about".
struct SANSMESH_API AboutStep {
  std::optional<Vec3> place = {};  ///< default: 0
  bool center = false;             ///< the middle of the box as it then is
  static const OptionSchema& schema();
};
/// By a map or its inverse: "transform", "inverse_transform".
struct SANSMESH_API TransformStep {
  AffineMap map = {};
  bool inverse = false;
  static const OptionSchema& schema();  ///< a row a field
};

/// Loses no digit, however far: "translate".
struct SANSMESH_API TranslateStep {
  Vec3 by = {};
  static const OptionSchema& schema();  ///< a row a field
};

/// The middle of the box around everything goes to 0: "center".
struct SANSMESH_API CenterStep {
  static const OptionSchema& schema();  ///< a row a field
};

/// About an axis, counter-clockwise: "rotate".
struct SANSMESH_API RotateStep {
  Vec3 axis = {0, 0, 1};
  double degrees = 0;
  std::optional<Vec3> about = {};       ///< what stays where it is; default: 0
  bool about_center = false;            ///< the middle of the box as it then is
  static const OptionSchema& schema();  ///< a row a field
};

/// By a factor for each axis, none of them 0; negative ones mirror, and turn faces over: "scale".
struct SANSMESH_API ScaleStep {
  Vec3 factors = {1, 1, 1};
  std::optional<Vec3> about = {};  ///< as in RotateStep
  bool about_center = false;
  static const OptionSchema& schema();  ///< a row a field
};

/// "y,x,z" swaps two (a mirror image), "x,-z,y" turns y up into z up: "axes".
struct SANSMESH_API AxesStep {
  std::string axes = "x,y,z";
  static const OptionSchema& schema();  ///< a row a field
};

enum class StepUp : std::uint8_t { y, z };

/// To z: what pointed up along y points up along z; to y: the other way: "up".
struct SANSMESH_API UpStep {
  StepUp to = StepUp::z;
  static const OptionSchema& schema();  ///< a row a field
};

/// Units of lengths, of before and after: um, mm, cm, m, km, in, ft, us-ft: "to_unit".
struct SANSMESH_API UnitStep {
  std::string from = {};  ///< default: ConvertOptions::unit
  std::string to = "m";
  static const OptionSchema& schema();  ///< a row a field
};

/// What lies in the box, or outside of it; meshes are cut along it: "crop", "crop_out".
struct SANSMESH_API CropStep {
  Box3 box = {};
  bool inside = true;
  static const OptionSchema& schema();  ///< a row a field
};

/// Fewer points: no two closer than this, and none missing that would be farther from all (length, > 0): "spacing".
struct SANSMESH_API SpacingStep {
  double distance = 0;
  static const OptionSchema& schema();  ///< a row a field
};

/// Fewer points: so many, drawn by chance, always the same ones: "count".
struct SANSMESH_API CountStep {
  std::size_t count = 0;
  static const OptionSchema& schema();  ///< a row a field
};

/// Fewer points: the first of every so many: "every".
struct SANSMESH_API EveryStep {
  std::size_t every = 0;
  static const OptionSchema& schema();  ///< a row a field
};

/// Of normals, colors and attributes only these, or all but these: "keep", "drop".
struct SANSMESH_API ChooseStep {
  std::vector<std::string> names = {};
  bool keep = true;
  static const OptionSchema& schema();  ///< a row a field
};

/// Vertices (or points) no farther from each other than this become one (length; 0: at the same place): "weld".
struct SANSMESH_API WeldStep {
  double distance = 0;
  static const OptionSchema& schema();  ///< a row a field
};

/// Faces turned over, normals turned round: "flip", "flip_faces", "flip_normals".
struct SANSMESH_API FlipStep {
  bool faces = true, normals = true;
  static const OptionSchema& schema();  ///< a row a field
};

using ConvertStep =
    std::variant<AboutStep, TransformStep, TranslateStep, CenterStep, RotateStep, ScaleStep, AxesStep, UpStep, UnitStep,
                 CropStep, SpacingStep, CountStep, EveryStep, ChooseStep, WeldStep, FlipStep>;

/// What may be done, as the options of a list of steps.
SANSMESH_API std::span<const OptionRow> convert_step_rows();

/// "crop_out".
SANSMESH_API std::string_view step_name(const ConvertStep& step);

/// Throws ArgumentError.
SANSMESH_API void validate_step(const ConvertStep& step);

/// "x,-z,y": the axes whose coordinates the new x, y and z are. Throws ArgumentError.
SANSMESH_API AffineMap axes_map(std::string_view axes);

/// Of um, mm, cm, m, km, in, ft and us-ft. Throws ArgumentError that names them.
SANSMESH_API double meters_of_unit(std::string_view unit);

/// The vertices of a mesh, with all that belongs to them.
SANSMESH_API PointSet vertices_of(TriangleMesh mesh);

/// A cloud, or a mesh.
struct SANSMESH_API CloudOrMesh {
  bool is_mesh = false;
  PointSet points;    ///< unless it is a mesh
  TriangleMesh mesh;  ///< if it is one
  /// Attributes of three reals that were not turned with everything else: nobody knows whether they are directions.
  std::vector<std::string> unturned;
  /// Edges of three triangles or more that welding has made.
  std::size_t nonmanifold_edges_of_weld = 0;

  /// As it was read: a mesh if it has triangles. Which file or scan each sample is of becomes an attribute, "source",
  /// if there are several.
  explicit CloudOrMesh(PointSet read);

  std::size_t size() const { return is_mesh ? mesh.vertices.size() : points.size(); }
  /// "1,234 points", or "1,234 vertices, 2,345 triangles".
  std::string size_words() const;
  const Vec3& origin() const { return is_mesh ? mesh.origin : points.origin; }
  /// In the coordinates of the file.
  Box3 bounds() const;
  const AttributeTable& attributes() const { return is_mesh ? mesh.attributes : points.attributes; }
  /// ", with normals, colours, intensity and 3 more": what there is but for what is lost.
  std::string belongings(const std::vector<std::string>& lost) const;
  /// Its vertices alone.
  void make_points();
};

struct SANSMESH_API ConvertOptions {
  bool points = false;                  ///< of a mesh the vertices alone, from the start
  std::string unit = {};                ///< of the input's lengths, for UnitStep
  std::vector<ConvertStep> steps = {};  ///< in their order

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError.
  void validate() const;
};

/// What there was after a step.
struct SANSMESH_API ConvertedBy {
  std::string_view step;  ///< its name
  std::string remark;     ///< what became of the data, in words; may be empty
  std::size_t size = 0;   ///< points or vertices
  std::optional<std::size_t> triangles;

  static const ReportSchema& schema();
};

struct SANSMESH_API ConvertReport {
  std::string size_words;               ///< of what came: "1,234 points"
  std::size_t size = 0, triangles = 0;  ///< of what came
  std::vector<ConvertedBy> steps;

  static const ReportSchema& schema();
};

struct ConvertResult {
  CloudOrMesh data;
  ConvertReport report;
  /// "nonmanifold_weld": edges of three triangles or more were made; "unturned": attributes of three numbers that
  /// nobody knows to be directions.
  std::vector<Note> notes;
};

/// Throws FileError early where neither a mesh nor points can be written there. `points`: these are wanted.
SANSMESH_API void check_converted(const std::string& file, bool points);
/// Meshes become points where the format of the file has no faces: "no_faces". Points never become a mesh: throws
/// FileError.
SANSMESH_API std::vector<Note> fit_to_format(CloudOrMesh& data, const std::string& file);

/// Throws ArgumentError for bad options, DataError naming the step where one cannot be done or leaves nothing,
/// Cancelled.
SANSMESH_API ConvertResult convert(PointSet read, const ConvertOptions& options, Progress& progress);

struct SANSMESH_API SplitOptions {
  /// Of clouds: points as close as this are connected (length, > 0). Default: 4 spacings.
  std::optional<double> split_distance = {};
  std::size_t min_size = 0;         ///< parts of fewer triangles (or points) are left out
  std::size_t most_parts = 10'000;  ///< more are an error

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError.
  void validate() const;
};

struct SANSMESH_API SplitResult {
  std::vector<CloudOrMesh> parts;  ///< the largest first
  std::size_t found = 0;           ///< those that were left out included
  std::optional<double> distance;  ///< of clouds, as used
  /// "small_parts": parts that were left out; "soup": hardly any triangles share a vertex; "loose_points": vertices of
  /// no triangle were left out.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Connected parts. Throws ArgumentError for bad options, DataError where none is large enough or there are too many,
/// Cancelled.
SANSMESH_API SplitResult split(const CloudOrMesh& data, const SplitOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
