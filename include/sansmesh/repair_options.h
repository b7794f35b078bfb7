// Options and reports of mesh repair: hole filling, smoothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Result of filling a hole.
enum class HoleOutcome : std::uint8_t {
  filled,     ///< closed
  too_large,  ///< left open, as the options require
  failed,     ///< every triangulation would reuse an existing edge
  end         ///< left open: the open end of a tube or vessel
};
/// Words for the outcomes, in the order of the enumerators.
inline constexpr std::string_view kOutcomeWords[] = {"filled", "left open", "no way across", "steep, left open"};

/// Closed loop of boundary edges. Lengths in the mesh's unit.
struct SANSMESH_API HoleLoop {
  /// Vertices in the order of triangles that fill it, opposite to the boundary's. For coincident vertices, those of the
  /// boundary.
  std::vector<std::uint32_t> vertices;
  Vec3 middle;           ///< centre of the edges, in world coordinates
  double perimeter = 0;  ///< length of the loop
  double diameter = 0;   ///< diagonal of its bounding box
  /// Diameter over the diagonal of the bounding box of its component: near 1 for the outer boundary of the component.
  double share = 0;
  /// Mean steepness of the mesh against the plane of the loop, 0..1: 0 for a hole in a plane, 1 for a cut tube.
  double steepness = 0;
  std::optional<HoleOutcome> outcome = {};  ///< result of filling

  static const ReportSchema& schema();  ///< a row per reported value
};

/// All closed loops of boundary edges of a mesh.
struct SANSMESH_API HoleLoops {
  std::vector<HoleLoop> loops;        ///< in descending order of diameter
  std::size_t border_edges = 0;       ///< edges of one triangle
  std::size_t stray_edges = 0;        ///< boundary edges in no loop: the boundary ends at non-manifold edges
  std::size_t nonmanifold_edges = 0;  ///< edges of three or more triangles

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Options of hole filling.
struct SANSMESH_API FillOptions {
  /// Fill holes of at most this diameter (length, > 0). Default: holes of at most `share` of their component.
  std::optional<double> largest = {};
  /// Fill holes of at most this number of edges (3 or more).
  std::optional<std::size_t> edges = {};
  /// Largest relative diameter, 0..1, if neither of the above is given. Outer boundaries of components and large
  /// openings stay open. So do ends: openings larger than a fiftieth of their component that the mesh leaves at more
  /// than 45°, as of a vessel or a cup.
  double share = 0.2;
  /// Fill every loop, including outer boundaries.
  bool all = false;
  /// Refine the filling to the triangle size around the hole.
  bool refine = true;
  /// Fair the filling so that it continues its surroundings smoothly; otherwise it has least area. Has no effect
  /// without `refine`.
  bool fair = true;

  static const OptionSchema& schema();  ///< a row per field
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Result of hole filling.
struct SANSMESH_API FillReport {
  HoleLoops found;            ///< loops of the original mesh, with outcomes
  std::size_t filled = 0;     ///< filled loops
  std::size_t too_large = 0;  ///< loops left open by the options
  std::size_t failed = 0;     ///< loops without a valid triangulation
  std::size_t ends = 0;       ///< open ends, left open
  std::size_t triangles = 0;  ///< added triangles
  std::size_t vertices = 0;   ///< added vertices
  double area = 0;            ///< added area, length²
  /// Components whose centre is closer to a filling than a quarter of the hole's diameter: they stay, and are now in
  /// front of, behind or across it.
  std::size_t islands = 0;

  static const ReportSchema& schema();  ///< a row per reported value
};

/// Options of mesh smoothing.
struct SANSMESH_API SmoothOptions {
  /// Pairs of steps, 1..10000; with `creases`, rounds over the normals. Default: derived from `shorter_than`,
  /// else from the noise.
  std::optional<int> iterations = {};
  /// Fraction of the way to the mean of the neighbours per step, above 0, up to 0.65: longer steps amplify waves of two
  /// edges.
  double strength = 0.6;
  /// Cut-off wavelength (length, > 0): details of this wavelength are halved, shorter ones vanish, wavelengths from
  /// twice this on hardly change. Not with `iterations` or `creases`.
  std::optional<double> shorter_than = {};
  /// Preserve creases: filter triangle normals, then fit the vertices to them.
  bool creases = false;
  /// With `creases`: largest angle between triangle normals that are averaged (degrees, 1..90). Default: from the noise
  /// of the normals.
  std::optional<double> crease_angle = {};
  /// Smooth boundary vertices along the boundary; otherwise they are fixed.
  bool borders = false;

  static const OptionSchema& schema();  ///< a row per field
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Result of mesh smoothing, over the vertices that triangles use. Lengths in the mesh's unit.
struct SANSMESH_API SmoothReport {
  std::size_t vertices = 0;             ///< used by a triangle; coincident vertices count once
  std::size_t fixed = 0;                ///< fixed vertices: on boundaries or non-manifold edges
  double mean_edge = 0;                 ///< mean edge length before smoothing
  double noise = 0;                     ///< estimated noise along the normals (standard deviation, length)
  double rms_move = 0;                  ///< displacement of the vertices, root mean square
  double largest_move = 0;              ///< largest displacement of a vertex
  int iterations = 0;                   ///< iterations used
  double crease_angle = 0;              ///< crease angle used, degrees
  bool shortened = false;               ///< `shorter_than` would have needed more than the largest number of iterations
  double area_before = 0;               ///< length²
  double area_after = 0;                ///< length²
  std::optional<double> volume_before;  ///< length³; only if the mesh is closed and oriented
  std::optional<double> volume_after;   ///< length³; only if the mesh is closed and oriented

  static const ReportSchema& schema();  ///< a row per reported value
};

}  // namespace sansmesh::inline v1
