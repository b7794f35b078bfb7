// Pictures of meshes, points, lines and functions: what is asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/model/surface_model.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::inline v1 {

/// One thing that a picture shows, as a file holds it.
struct PictureObject {
  std::string name = "the object";  ///< in messages
  std::string title = {};           ///< in the list beside the picture
  PointSet points = {};             ///< with triangles a mesh
  PolylineSet lines = {};           ///< of a file of lines; its points are those above
  std::optional<SurfaceFunction> function = {};
};

enum class ObjectKind : std::uint8_t { mesh, points, lines, function };
/// In the order of the enumerators.
inline constexpr std::string_view kObjectWords[] = {"mesh", "points", "lines", "function"};

/// The attribute, and what `color_by` calls it.
inline constexpr const char* kConfidence = "confidence";
inline constexpr const char *kAutoColor = "auto", *kOwnColor = "own";

/// Rays at a projection march through the balls around the samples, or start from polynomials stored with these.
enum class RayStart : std::uint8_t { march, stored };

/// By themselves meshes and points are drawn as they are, functions by rays; several of them, or translucent ones, each
/// in a colour of its own.
struct PictureOptions {
  /// All of it that surfaces without a mesh have; others heed their part.
  SurfaceRenderOptions look = {};
  /// Of one cloud: rays are cast at this surface of the samples.
  std::optional<SurfaceOptions> surface = {};
  CloudUse cloud = {};
  /// An attribute, of vectors its length; of a surface without a mesh "mean", "gaussian", "k1" or "k2" curvature;
  /// "confidence". Of one object only. Default: the colours that it has.
  std::string color_by = {};
  std::optional<double> color_range = {};                     ///< curvature with the full colour; default: from data
  std::optional<std::pair<double, double>> value_range = {};  ///< of an attribute: what gets the colours at the ends
  std::string unit = {};                                      ///< of lengths, or of the attribute: at the bar
  bool bar = true;                                            ///< of colours, beside the picture
  // Of the objects, in their order; those that are missing follow by themselves.
  std::vector<std::string> colors = {};  ///< "#rrggbb", a name, "own" or "auto"
  std::vector<double> opacities = {};    ///< 0..1
  std::vector<std::string> names = {};   ///< in the list
  bool legend = true;                    ///< the list of several objects
  std::optional<RayStart> rays = {};
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

}  // namespace sansmesh::inline v1
