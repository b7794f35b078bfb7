// Conversion of clouds and meshes: moves, crops, thins, welds and splits them in a sequence of steps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/image.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Sets the fixed point of later rotations and scalings that have none themselves: "about".
struct SANSMESH_API AboutStep {
  std::optional<Vec3> fixed_point = {};  ///< default: 0; schema name: "place"
  bool center = false;                   ///< the centre of the current bounding box is fixed instead
  static const OptionSchema& schema();   ///< option rows, one per field
};

/// Applies an affine map or its inverse to everything: "transform", "inverse_transform".
struct SANSMESH_API TransformStep {
  AffineMap map = {};                   ///< map of positions; normals, scanners and directions follow
  bool inverse = false;                 ///< apply the inverse; ArgumentError if the map has none
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Translates everything without any loss of precision: "translate".
struct SANSMESH_API TranslateStep {
  Vec3 by = {};                         ///< translation (length)
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Moves the centre of the bounding box to 0: "center".
struct SANSMESH_API CenterStep {
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Rotates everything about an axis, counter-clockwise if the axis points towards the viewer: "rotate".
struct SANSMESH_API RotateStep {
  Vec3 axis = {0, 0, 1};                ///< any length but 0
  double degrees = 0;                   ///< angle
  std::optional<Vec3> about = {};       ///< fixed point; default: 0
  bool about_center = false;            ///< the centre of the current bounding box is fixed instead
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Scales by one factor per axis, none of them 0. An odd number of negative factors mirrors and flips faces: "scale".
struct SANSMESH_API ScaleStep {
  Vec3 factors = {1, 1, 1};             ///< factors of x, y and z
  std::optional<Vec3> about = {};       ///< as in RotateStep
  bool about_center = false;            ///< as in RotateStep
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Permutes the axes: "y,x,z" swaps two (a mirror image), "x,-z,y" rotates y up into z up: "new_axes".
struct SANSMESH_API AxesStep {
  std::string axes = "x,y,z";           ///< axes in the syntax of axes_map
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Axis that points up.
enum class StepUp : std::uint8_t { y, z };

/// Changes the up axis. To z: what pointed up along y points up along z. To y: the reverse: "up".
struct SANSMESH_API UpStep {
  StepUp to = StepUp::z;                ///< up axis afterwards
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Converts lengths between units; both are one of um, mm, cm, m, km, in, ft and us-ft: "to_unit".
struct SANSMESH_API UnitStep {
  std::string from = {};                ///< unit of the input; default: ConvertOptions::unit
  std::string to = "m";                 ///< unit of the result
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Keeps the part inside or outside a box; meshes are cut along its sides: "box", "outside_box".
struct SANSMESH_API CropStep {
  Box3 box = {};                        ///< box in the current coordinates of the data; must not be empty
  bool inside = true;                   ///< keep the inside; otherwise the outside
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Thins points so that no two are closer than a distance and each removed point is that close to a kept one:
/// "point_spacing".
struct SANSMESH_API SpacingStep {
  double distance = 0;                  ///< length, > 0
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Thins points to a given number, drawn at random with a fixed seed: "point_count".
struct SANSMESH_API CountStep {
  std::size_t count = 0;                ///< number of points that remain, 1..2·10⁹
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Thins points to every n-th, starting with the first: "every".
struct SANSMESH_API EveryStep {
  std::size_t every = 0;                ///< n, 1..2·10⁹
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Keeps only the named normals, colors and attributes, or all others: "keep", "drop".
struct SANSMESH_API ChooseStep {
  std::vector<std::string> names = {};  ///< "normals", "colors", names of attributes
  bool keep = true;                     ///< keep only these; otherwise drop these
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Merges vertices (or points) that are no farther apart than a distance: "weld".
struct SANSMESH_API WeldStep {
  double distance = 0;                  ///< length, >= 0; 0 merges coincident ones only
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Reverses the orientation of faces and normals: "flip", "flip_faces", "flip_normals".
struct SANSMESH_API FlipStep {
  bool faces = true;                    ///< reverse faces
  bool normals = true;                  ///< reverse normals
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// Finds the ground of an airborne survey and stores it as class 2 of the attribute "classification", all else as
/// class 1. Points of other classes keep them; with ground among these, nothing changes: "classify_ground".
struct SANSMESH_API ClassifyGroundStep {
  static const OptionSchema& schema();  ///< option rows, one per field
};

/// One step of a conversion.
using ConvertStep =
    std::variant<AboutStep, TransformStep, TranslateStep, CenterStep, RotateStep, ScaleStep, AxesStep, UpStep, UnitStep,
                 CropStep, SpacingStep, CountStep, EveryStep, ChooseStep, WeldStep, FlipStep, ClassifyGroundStep>;

/// All steps, as the options of a list of steps.
SANSMESH_API std::span<const OptionRow> convert_step_rows();

/// Name of a step, as quoted in the comments above: "outside_box".
SANSMESH_API std::string_view step_name(const ConvertStep& step);

/// Throws ArgumentError for values out of range.
SANSMESH_API void validate_step(const ConvertStep& step);

/// Parses "x,-z,y": the axes whose coordinates become the new x, y and z. Throws ArgumentError.
SANSMESH_API AffineMap axes_map(std::string_view axes);

/// Length of a unit in metres: um, mm, cm, m, km, in, ft or us-ft. Throws ArgumentError that lists them.
SANSMESH_API double meters_of_unit(std::string_view unit);

/// The vertices of a mesh as a cloud, with all their attributes.
SANSMESH_API PointSet vertices_of(TriangleMesh mesh);

/// A cloud, or a mesh.
struct SANSMESH_API CloudOrMesh {
  bool is_mesh = false;  ///< which of the two it is
  PointSet points;       ///< points of a cloud
  TriangleMesh mesh;     ///< mesh, if is_mesh
  /// Attributes of three reals that transformations left unchanged, since they may not be directions.
  std::vector<std::string> untransformed;
  /// Reference system of the input, if the coordinates were moved out of it.
  std::shared_ptr<const ReferenceSystem> former_reference;
  /// Edges with three or more triangles that welding made.
  std::size_t nonmanifold_edges_of_weld = 0;

  /// Takes what a file contains: a mesh if it has triangles. Several files or scans are numbered in an attribute
  /// "source" of the samples.
  explicit CloudOrMesh(PointSet read);

  /// Number of points or vertices.
  std::size_t size() const { return is_mesh ? mesh.vertices.size() : points.size(); }
  /// "1,234 points", or "1,234 vertices, 2,345 triangles".
  std::string size_words() const;
  /// Origin of the positions: world position = origin + position.
  const Vec3& origin() const { return is_mesh ? mesh.origin : points.origin; }
  /// Box around the points or vertices, in the coordinates of the file.
  Box3 bounds() const;
  /// Attributes of the points or vertices.
  const AttributeTable& attributes() const { return is_mesh ? mesh.attributes : points.attributes; }
  /// ", with normals, colours, intensity and 3 more": names of the attributes, except lost ones.
  std::string attribute_words(const std::vector<std::string>& lost) const;
  /// Drops the triangles of a mesh; its vertices become the points.
  void make_points();
};

/// Steps of a conversion.
struct SANSMESH_API ConvertOptions {
  bool vertices_only = false;  ///< uses only the vertices of a mesh
  std::string unit = {};       ///< unit of the input's lengths, for UnitStep; default: that of its reference system
  std::vector<ConvertStep> steps = {};  ///< steps in order

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError.
  void validate() const;
};

/// State after a step.
struct SANSMESH_API ConvertStepReport {
  std::string_view step;                 ///< name of the step
  std::string remark;                    ///< effect of the step as text; may be empty
  std::size_t size = 0;                  ///< number of points or vertices
  std::optional<std::size_t> triangles;  ///< number of triangles of a mesh

  static const ReportSchema& schema();  ///< report rows
};

/// Report of convert().
struct SANSMESH_API ConvertReport {
  std::string size_words;                ///< size of the input: "1,234 points"
  std::size_t size = 0;                  ///< points or vertices of the input
  std::size_t triangles = 0;             ///< triangles of the input; 0 for a cloud
  std::vector<ConvertStepReport> steps;  ///< state after each step

  static const ReportSchema& schema();  ///< report rows
};

/// Converted cloud or mesh.
struct ConvertResult {
  CloudOrMesh data;      ///< data after the last step
  ConvertReport report;  ///< effects of the steps
  /// "nonmanifold_weld": welding made edges with three or more triangles; "unturned": attributes of three numbers that
  /// may or may not be directions.
  std::vector<Note> notes;
};

/// Throws FileError early if the file can hold neither a mesh nor points. `points`: the result is points.
SANSMESH_API void check_converted(const std::string& file, bool points);
/// Turns a mesh into points if the file format has no faces: "no_faces". Throws FileError if a cloud is to be written
/// to a format for meshes.
SANSMESH_API std::vector<Note> fit_to_format(CloudOrMesh& data, const std::string& file);

/// Parts that the file format cannot hold: "normals", names of attributes.
SANSMESH_API std::vector<std::string> left_out(const std::string& file, const CloudOrMesh& data);
/// Writes a cloud or a mesh that fits the format. `ascii`: as text if the format allows both. Throws FileError.
SANSMESH_API void write_converted(const std::string& file, const CloudOrMesh& data, bool ascii = false);

/// Applies all steps in order to the contents of a file. Throws ArgumentError for bad options, DataError with the name
/// of a step that fails or leaves nothing, Cancelled.
SANSMESH_API ConvertResult convert(PointSet read, const ConvertOptions& options, Progress& progress);

/// Remarks on the effects of the steps, one line each.
SANSMESH_API std::vector<std::string> summary_of(const ConvertReport& report);

/// Height grid of a terrain, with contour lines.
struct SANSMESH_API HeightGridOptions {
  /// Edge of the cells (length, > 0). Default: the spacing of the ground, rounded up to 1, 2 or 5 times a power of ten.
  std::optional<double> cell = {};
  /// Gaps between the samples of the ground up to this width are filled (length, >= 0). Default: 40 spacings.
  std::optional<double> gap = {};
  /// Difference in height of contour lines (length, > 0). Default: a fifteenth of the range of heights, rounded.
  std::optional<double> interval = {};

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError.
  void validate() const;
};

/// Report of make_height_grid().
struct SANSMESH_API HeightGridReport {
  std::size_t samples = 0;                     ///< samples of the ground or of chosen classes; 0 for meshes
  std::optional<std::size_t> breaklines = {};  ///< given breaklines that lie over the samples
  std::size_t columns = 0, rows = 0;           ///< cells
  double cell = 0;                             ///< edge of the cells (length)
  double unknown = 0;                          ///< share of the cells without a height, 0..1
  double lowest = 0, highest = 0;              ///< range of heights (lengths)
  double interval = 0;                         ///< interval of contour lines (length)

  static const ReportSchema& schema();  ///< report rows
};

/// Height grid, with its report.
struct HeightGridResult {
  HeightGrid grid;          ///< heights
  HeightGridReport report;  ///< measures
  /// "ground_found": nothing was classified; "breaklines_outside": breaklines without samples.
  std::vector<Note> notes;
};

/// Samples of a terrain.
struct TerrainSamples {
  PointSet points;          ///< samples; a reconstruction may take them
  double spacing = 0;       ///< edge of the square of covered area per sample (length); 0 if they cover no area
  std::size_t count = 0;    ///< number of samples
  std::vector<Note> notes;  ///< "ground_found": nothing was classified
};

/// The samples of class 2 or, if none is classified, those that the ground filter finds; all samples if there are other
/// classes only, or if `all`. Throws DataError if there are none, Cancelled.
SANSMESH_API TerrainSamples terrain_samples(PointSet points, bool all, Progress& progress);

/// Tiles and breaklines of a height grid.
struct SANSMESH_API HeightGridUse {
  std::optional<double> tile_size = {};  ///< tiles of this size (length, > 0) are to have whole cells
  /// For clouds: lines at which height or slope jumps, in the coordinates of the cloud. Both sides have surfaces of
  /// their own. Lines whose heights are all 0 have none; those of others are samples.
  PolylineSet breaklines = {};

  /// Throws ArgumentError for a size of tiles that is not positive, or not a multiple of a cell that is given.
  void validate(const HeightGridOptions& options) const;
};

/// Heights of the ground of a cloud: of its terrain_samples. Of a mesh: heights of its highest triangles. Throws
/// ArgumentError for bad options, DataError for data without an extent or too many cells, Cancelled.
SANSMESH_API HeightGridResult make_height_grid(const CloudOrMesh& data, const HeightGridOptions& options,
                                               Progress& progress, const HeightGridUse& use = {});

/// Heights of the highest triangles of a surface that was reconstructed from samples, in the cells of the grid of the
/// samples. Throws as above, and ArgumentError for `gap` and breaklines.
SANSMESH_API HeightGridResult make_height_grid(const TriangleMesh& surface, const TerrainSamples& samples,
                                               const HeightGridOptions& options, Progress& progress,
                                               const HeightGridUse& use = {});

/// Square part of a height grid.
struct HeightTile {
  std::string place;  ///< lower left corner, as in SplitResult::places
  HeightGrid grid;    ///< heights; NaN outside of the whole grid
};

/// Squares whose borders are multiples of `tile_size` (length, a multiple of the cell), those without heights left out,
/// from south to north and west to east. Throws DataError for more than 10,000.
SANSMESH_API std::vector<HeightTile> split_height_grid(const HeightGrid& grid, double tile_size);

/// Writes contour lines: .svg, .dxf or a format of lines (.vtp .ply .csv). Returns the number of lines. Throws
/// FileError; ArgumentError for more than 10,000 heights.
SANSMESH_API std::size_t write_contours(const std::string& file, const HeightGrid& grid, double interval);

/// Throws FileError if contour lines cannot be written with that suffix.
SANSMESH_API void check_contours_writable(const std::string& file);

/// Picture of the terrain, lit from the north-west at 45°; transparent where heights are unknown.
SANSMESH_API Image hillshade_of(const HeightGrid& grid);

/// Size and range of heights, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const HeightGridReport& report);

/// Connectivity or tiles, and which parts are kept.
struct SANSMESH_API SplitOptions {
  /// For clouds: square tiles of this size over x and y instead of connected parts (length, > 0). Their borders are
  /// multiples of it; the left and the lower one belong to the tile.
  std::optional<double> tile_size = {};
  /// For clouds: points no farther apart than this are connected (length, > 0). Default: 4 spacings.
  std::optional<double> split_distance = {};
  std::size_t min_size = 0;         ///< parts with fewer triangles (or points) are dropped
  std::size_t most_parts = 10'000;  ///< more parts are an error

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError.
  void validate() const;
};

/// Connected parts of a cloud or mesh, or tiles.
struct SANSMESH_API SplitResult {
  std::vector<CloudOrMesh> parts;   ///< parts, the largest first; tiles from south to north and west to east
  std::vector<std::string> places;  ///< lower left corners of tiles in the unit of the cloud: "512000_5403000"
  std::optional<double> tile_size;  ///< size of tiles (length)
  std::size_t found = 0;            ///< number of parts, dropped ones included
  std::optional<double> distance;   ///< for clouds: the `split_distance` that was used (length)
  /// "small_parts": parts were dropped; "soup": hardly any triangles share a vertex; "loose_points": vertices without
  /// triangles were dropped.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Splits a cloud or mesh into its connected parts, or a cloud into tiles. Throws ArgumentError for bad options,
/// DataError if no part is large enough or there are too many, or for tiles of a mesh, Cancelled.
SANSMESH_API SplitResult split(const CloudOrMesh& data, const SplitOptions& options, Progress& progress);

/// Number of parts, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SplitResult& made);

}  // namespace sansmesh::inline v1
