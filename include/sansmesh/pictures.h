// Pictures of meshes, points, lines and functions, and of results of other jobs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "sansmesh/report.h"
#include "sansmesh/surface_function.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

struct AlignResult;
struct CompareOptions;
struct CompareResult;
struct DiagnoseResult;

/// Object in a picture, as read from a file.
struct PictureObject {
  std::string name = "the object";               ///< name in messages
  std::string title = {};                        ///< title in the legend
  PointSet points = {};                          ///< a mesh if it has triangles
  PolylineSet lines = {};                        ///< lines of a file of lines; their points are those above
  std::optional<SurfaceFunction> function = {};  ///< replaces all of these
};

/// Kinds of objects.
enum class ObjectKind : std::uint8_t { mesh, points, lines, function };
/// Names in the order of the enumerators.
inline constexpr std::string_view kObjectWords[] = {"mesh", "points", "lines", "function"};

/// Ray casting at a projection marches through the balls around the samples, or starts at polynomials stored with
/// these.
enum class RayStart : std::uint8_t { march, stored };

/// Options of pictures. A single opaque mesh or cloud is drawn as it is, a function by ray casting; several or
/// translucent objects each have their own colour.
struct SANSMESH_API PictureOptions {
  /// Look. Surfaces without a mesh use all of it, other objects only their part.
  SurfaceRenderOptions look = {};
  /// For one cloud: casts rays at this surface of the samples.
  std::optional<SurfaceOptions> surface = {};
  CloudPreparation cloud = {};  ///< preparation of the samples of that surface
  /// An attribute (the length if it is a vector), "confidence", or for a surface without a mesh "mean", "gaussian",
  /// "k1" or "k2" curvature. For a single object only. Default: the object's own colours.
  std::string color_by = {};
  /// Values at the ends of the colour bar (−R and R for curvatures); default: from the data.
  std::optional<std::pair<double, double>> color_range = {};
  std::string unit = {};  ///< unit of lengths, or of the attribute, at the bar
  bool bar = true;        ///< draws a colour bar beside the picture
  // One entry per object, in order; missing entries have defaults.
  std::vector<std::string> colors = {};  ///< "#rrggbb", a name, "own" or "auto"
  std::vector<double> opacities = {};    ///< 0..1
  std::vector<std::string> names = {};   ///< titles in the legend
  bool legend = true;                    ///< draws a legend of several objects
  std::optional<RayStart> rays = {};     ///< start of rays at a projection; default: march
  /// Draws this number of points of the surface as blended splats instead of rays, up to 10⁸; 0: derived from the size.
  std::optional<std::size_t> splats = {};
  std::optional<int> frames = {};  ///< number of pictures of a turntable, 1..100000; default: one picture

  /// Whether any object is translucent.
  bool translucent() const;
  /// Option rows without those of `look`, `surface` and `cloud`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// An object as drawn.
struct SANSMESH_API DrawnObject {
  ObjectKind kind = ObjectKind::mesh;  ///< kind of the object
  std::string title;                   ///< title in the legend
  std::string color;                   ///< "#rrggbb", or "own"
  double opacity = 1;                  ///< 0..1

  static const ReportSchema& schema();  ///< report rows
};

/// Report of pictures of objects.
struct SANSMESH_API RenderReport {
  std::vector<DrawnObject> objects;      ///< for several, translucent, line or rotating objects
  std::optional<SurfaceReport> surface;  ///< for a surface drawn without a mesh
  std::optional<CastCounts> rays;        ///< rays cast at that surface
  std::optional<std::size_t> splats;     ///< number of splats, instead of rays

  static const ReportSchema& schema();  ///< report rows
};

/// Result of render().
struct RenderResult {
  RenderReport report;  ///< counts and measures
  /// Notes on a surface without a mesh; "outliers": samples that were dropped.
  std::vector<Note> notes;
};

/// Draws a picture, or a turntable, of meshes, points, lines and functions. The width of the picture includes colour
/// bars and the legend. Feature lines of a cloud are those of a surface of its samples, if it has one. Throws
/// ArgumentError for bad options and for options that do not apply to the objects; DataError that begins with a name if
/// there is nothing to draw; Cancelled.
SANSMESH_API RenderResult render(std::vector<PictureObject> objects, const PictureOptions& options,
                                 const UsePicture& use, Progress& progress);

/// Lines drawn as coloured tubes, with a colour scale.
struct SANSMESH_API LinePictureOptions {
  std::string color_by = {};               ///< a point array (the length if it is a vector); empty: the default array
  std::string unit = {};                   ///< unit of that array, at the scale
  std::optional<double> tube_radius = {};  ///< length; default: 1/400 of the lines' diagonal
  /// Its width includes the scale. Shadows and ground are not available, since they would alter the colours.
  RenderOptions picture = {};
  bool default_view = true;  ///< no view was chosen: the view of a single layer is perpendicular to it

  /// Option rows, those of `picture` included.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and if the picture is too narrow for its scale. `default_color`: default for
  /// `color_by`.
  void validate(const std::string& default_color) const;
  /// Throws ArgumentError unless `color_by` is one of these arrays.
  void check_color(const std::vector<std::string>& arrays) const;
};

/// Result of line_picture().
struct SANSMESH_API LinePicture {
  Image image;                  ///< picture with its scale
  RenderOptions made_with;      ///< options of the picture
  std::string color_by;         ///< array that colours the tubes
  double lower = 0, upper = 0;  ///< values at the ends of the scale
  double radius = 0;            ///< radius of the tubes (length)
  std::size_t triangles = 0;    ///< triangles of the tubes

  static const ReportSchema& schema();  ///< report rows
};

/// Radius of the tubes: the given one, or 1/400 of the diagonal of the lines. Throws DataError if all points coincide.
SANSMESH_API double tube_radius(const PolylineSet& lines, const std::optional<double>& radius = {});

/// Draws lines as tubes. The scale weights each value by its share of the tubes and clips one hundredth at each end.
/// Throws ArgumentError for bad options, DataError if there is nothing to draw.
SANSMESH_API LinePicture line_picture(const PolylineSet& lines, const LinePictureOptions& options,
                                      const std::string& default_color, Progress& progress);

/// Picture of an alignment: the moved surface in orange, the fixed one in gray.
SANSMESH_API Image draw_alignment(const AlignResult& aligned, RenderOptions picture, Progress& progress);

/// Picture with a scale or bar.
struct MapPicture {
  Image image;              ///< picture with the scale
  RenderOptions made_with;  ///< options of the part without the scale
};

/// Picture of curvatures, with a bar if requested.
SANSMESH_API MapPicture draw_curvature(const CurvatureResult& made, const CurvatureMapOptions& options,
                                       const RenderOptions& picture, Progress& progress);

/// Throws ArgumentError if a picture is too narrow for a scale with lengths in `unit`.
SANSMESH_API void check_map_picture(const RenderOptions& picture, const std::string& unit);

/// The mesh in the colours of its map, on light gray and without shadows, which would alter the colours. The width of
/// the picture includes the scale, which marks the tolerance.
SANSMESH_API MapPicture draw_map(const CompareResult& compared, const CompareOptions& options,
                                 const RenderOptions& picture, const std::string& unit, Progress& progress);

/// Pictures of the regions of a diagnosis, each from outside and ringed, with its number and its worst measure. They
/// are in list order; with `sheet` small pictures are arranged on one sheet. No regions give no pictures. Throws
/// ArgumentError for bad options, and for more regions than a sheet holds.
SANSMESH_API std::vector<Image> draw_regions(const DiagnoseResult& made, RenderOptions options, bool sheet,
                                             Progress& progress);

}  // namespace sansmesh::inline v1
