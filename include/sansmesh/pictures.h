// Pictures of meshes, points, lines and functions, and of what other jobs found.
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

/// One thing that a picture shows, as a file holds it.
struct PictureObject {
  std::string name = "the object";               ///< in messages
  std::string title = {};                        ///< in the list beside the picture
  PointSet points = {};                          ///< with triangles a mesh
  PolylineSet lines = {};                        ///< of a file of lines; its points are those above
  std::optional<SurfaceFunction> function = {};  ///< in place of all of these
};

/// The kinds of objects.
enum class ObjectKind : std::uint8_t { mesh, points, lines, function };
/// Words for them, in the order of the enumerators.
inline constexpr std::string_view kObjectWords[] = {"mesh", "points", "lines", "function"};

/// Rays at a projection march through the balls around the samples, or start from polynomials stored with these.
enum class RayStart : std::uint8_t { march, stored };

/// Pictures of objects. By themselves meshes and points are drawn as they are, functions by rays; several of them, or
/// translucent ones, each in a colour of its own.
struct SANSMESH_API PictureOptions {
  /// All of it that surfaces without a mesh have; others heed their part.
  SurfaceRenderOptions look = {};
  /// Of one cloud: rays are cast at this surface of the samples.
  std::optional<SurfaceOptions> surface = {};
  CloudPreparation cloud = {};  ///< how the samples of that are prepared
  /// An attribute, of vectors its length; of a surface without a mesh "mean", "gaussian", "k1" or "k2" curvature;
  /// "confidence". Of one object only. Default: the colours that it has.
  std::string color_by = {};
  /// Values with the colours at the ends of the bar, of curvatures −R and R; default: from data.
  std::optional<std::pair<double, double>> color_range = {};
  std::string unit = {};  ///< of lengths, or of the attribute: at the bar
  bool bar = true;        ///< of colours, beside the picture
  // Of the objects, in their order; those that are missing follow by themselves.
  std::vector<std::string> colors = {};  ///< "#rrggbb", a name, "own" or "auto"
  std::vector<double> opacities = {};    ///< 0..1
  std::vector<std::string> names = {};   ///< in the list
  bool legend = true;                    ///< the list of several objects
  std::optional<RayStart> rays = {};     ///< at a projection; default: march
  /// So many points of the surface as splats that blend, not rays, up to 10⁸; 0: as many as suit it.
  std::optional<std::size_t> splats = {};
  std::optional<int> frames = {};  ///< so many pictures from all around, 1..100000; default: one picture

  /// Tells whether any object is translucent.
  bool translucent() const;
  /// All but those of `look`, `surface` and `cloud`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// An object as it was drawn.
struct SANSMESH_API DrawnObject {
  ObjectKind kind = ObjectKind::mesh;  ///< of what
  std::string title;                   ///< in the list
  std::string color;                   ///< "#rrggbb", or "own"
  double opacity = 1;                  ///< 0..1

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Report on pictures of objects.
struct SANSMESH_API RenderReport {
  std::vector<DrawnObject> objects;      ///< where they stand side by side, or are translucent, lines or turned
  std::optional<SurfaceReport> surface;  ///< where a surface is drawn without a mesh
  std::optional<CastCounts> rays;        ///< of that
  std::optional<std::size_t> splats;     ///< in place of rays

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Outcome of render().
struct RenderResult {
  RenderReport report;  ///< in numbers
  /// "surface": what there is to say of a surface without a mesh; "outliers": samples that were left out.
  std::vector<Note> notes;
};

/// A picture, or a turntable of pictures, of meshes, points, lines and functions.
/// Bars of colours and the list of several objects are in the width of the picture. Lines of a cloud are those of a
/// surface of its samples, if they make one. Throws ArgumentError for bad options, and for such as what is drawn would
/// not heed; DataError that begins with a name where there is nothing to draw; Cancelled.
SANSMESH_API RenderResult render(std::vector<PictureObject> objects, const PictureOptions& options,
                                 const UsePicture& use, Progress& progress);

/// Lines as tubes with colours, beside the scale of these.
struct SANSMESH_API LinePictureOptions {
  std::string color_by = {};               ///< an array of the points, of vectors their length; empty: the usual one
  std::string unit = {};                   ///< of that, at the scale
  std::optional<double> tube_radius = {};  ///< length; default: 1/400 of the lines' diagonal
  /// Its width is that of tubes and scale together. Shadows and ground mean nothing: colours are to be read.
  RenderOptions picture = {};
  bool any_view = true;  ///< nobody chose the view: that of a single layer looks straight at it

  /// The rows of these options, those of `picture` among them.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and where the picture is too narrow for its scale. `usual`: what colours are
  /// by if nothing is said.
  void validate(const std::string& usual) const;
  /// Throws ArgumentError unless colours are by one of these arrays.
  void check_color(const std::vector<std::string>& arrays) const;
};

/// Outcome of line_picture().
struct SANSMESH_API LinePicture {
  Image image;                  ///< with its scale
  RenderOptions made_with;      ///< with which it was made
  std::string color_by;         ///< the array
  double lower = 0, upper = 0;  ///< what gets the colours at the ends
  double radius = 0;            ///< of the tubes (length)
  std::size_t triangles = 0;    ///< that the tubes are made of

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Radius of the tubes that lines are drawn as: the given one, or 1/400 of their diagonal. Throws DataError where all
/// points are in one place.
SANSMESH_API double tube_radius(const PolylineSet& lines, const std::optional<double>& radius = {});

/// The lines as tubes. Each value counts for the scale as much as it has of the tubes, a hundredth at each end is left
/// out. Throws ArgumentError for bad options, DataError where there is nothing to draw.
SANSMESH_API LinePicture line_picture(const PolylineSet& lines, const LinePictureOptions& options,
                                      const std::string& usual, Progress& progress);

/// Picture of a surface that was moved onto another one: the moved surface in orange, the fixed one in gray.
SANSMESH_API Image draw_alignment(const AlignResult& aligned, RenderOptions picture, Progress& progress);

/// A picture with a scale or bar beside it.
struct MapPicture {
  Image image;              ///< with the scale
  RenderOptions made_with;  ///< what was drawn beside it
};

/// Picture of curvatures, with the bar if the options ask for one.
SANSMESH_API MapPicture draw_curvature(const CurvatureResult& made, const CurvatureMapOptions& options,
                                       const RenderOptions& picture, Progress& progress);

/// Throws ArgumentError where a picture is too narrow for itself and any scale, whose `unit` is that of lengths.
SANSMESH_API void check_map_picture(const RenderOptions& picture, const std::string& unit);

/// The mesh in the colours of its map, on light gray and without shadows, so that they can be read; its scale, with
/// marks at the tolerance, is in the width of the picture.
SANSMESH_API MapPicture draw_map(const CompareResult& compared, const CompareOptions& options,
                                 const RenderOptions& picture, const std::string& unit, Progress& progress);

/// Pictures of the places of a diagnosis, each from outside and ringed, with its number and what is worst there:
/// pictures as the options have them, in the order of the list, or with `sheet` small ones, all on one. Of no places
/// none. Throws ArgumentError for bad options, and for more places than a sheet holds.
SANSMESH_API std::vector<Image> draw_places(const DiagnoseResult& made, RenderOptions options, bool sheet,
                                            Progress& progress);

}  // namespace sansmesh::inline v1
