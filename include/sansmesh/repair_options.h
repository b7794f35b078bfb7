// Options and reports of mesh repair: holes, smoothing.
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
  filled,     ///< it is closed
  too_large,  ///< left open, as the options say
  failed,     ///< no triangles go across it without an edge that is there already
  end         ///< left open because it looks like the end of something that goes on
};
/// Words for them, in the order of the enumerators.
inline constexpr std::string_view kOutcomeWords[] = {"filled", "left open", "no way across", "steep, left open"};

/// A closed curve along the border of a mesh. Lengths in its unit.
struct SANSMESH_API HoleLoop {
  /// Vertices in the order in which triangles that fill it run: the border's own run the other way. Where vertices
  /// repeat at a place, the ones that the border has.
  std::vector<std::uint32_t> vertices;
  Vec3 middle;           ///< of its edges, in the coordinates of the world
  double perimeter = 0;  ///< length of the loop
  double diameter = 0;   ///< diagonal of its box
  /// The same over the diagonal of the box of the piece that it is in: near 1 it is the outer border of that piece.
  double share = 0;
  /// How steeply the mesh leaves the plane of the loop, 0..1, on the mean: 0 of a hole in a plane, 1 of a tube that is
  /// cut off.
  double steepness = 0;
  std::optional<HoleOutcome> outcome = {};  ///< of filling it

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// All closed curves along the borders of a mesh.
struct SANSMESH_API HoleLoops {
  std::vector<HoleLoop> loops;        ///< by falling diameter
  std::size_t border_edges = 0;       ///< of one triangle
  std::size_t stray_edges = 0;        ///< of these, in no loop: the border ends at edges that are not manifold
  std::size_t nonmanifold_edges = 0;  ///< of three triangles or more

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Which holes are filled, and how.
struct SANSMESH_API FillOptions {
  /// Fill holes of at most this diameter (length, > 0). Default: those of at most `share` of their piece.
  std::optional<double> largest = {};
  /// Fill holes of at most so many edges (3 or more).
  std::optional<std::size_t> edges = {};
  /// Used where neither is given, 0..1: outer borders of pieces, and large openings, stay; so do ends: openings that
  /// the mesh leaves at more than 45°, larger than a fiftieth of their piece, as those of a vessel or a cup.
  double share = 0.2;
  /// Fill every loop, outer borders too.
  bool all = false;
  /// Add vertices until triangles are as small as those around the hole.
  bool refine = true;
  /// Move these vertices so that the filling goes on as smoothly as its surroundings; otherwise it is the smallest
  /// one. Means nothing without `refine`.
  bool fair = true;

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What became of the holes.
struct SANSMESH_API FillReport {
  HoleLoops found;            ///< in the original, with what became of each
  std::size_t filled = 0;     ///< loops by outcome
  std::size_t too_large = 0;  ///< loops by outcome
  std::size_t failed = 0;     ///< loops by outcome
  std::size_t ends = 0;       ///< loops by outcome
  std::size_t triangles = 0;  ///< added
  std::size_t vertices = 0;   ///< added
  double area = 0;            ///< added, length²
  /// Pieces of the mesh whose middle lies near a filling (nearer than a quarter of the hole's diameter): they stay, and
  /// now lie before, behind or across it.
  std::size_t islands = 0;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// How far a mesh is smoothed, and what is kept.
struct SANSMESH_API SmoothOptions {
  /// Pairs of steps, 1..10000; with `creases` rounds over the normals. Default: what `shorter_than` asks for; else 10,
  /// with `creases` 8.
  std::optional<int> iterations = {};
  /// How far a step goes towards the mean of the neighbours, above 0, up to 0.65: longer steps blow up waves of two
  /// edges.
  double strength = 0.6;
  /// Details of this wavelength become half as high, shorter ones vanish, ones of twice the length and more hardly
  /// change (length, > 0). Not with `iterations` or `creases`.
  std::optional<double> shorter_than = {};
  /// Keep creases: means of the normals of triangles, then vertices that follow them.
  bool creases = false;
  /// With `creases`: triangles whose normals differ by much more than this do not blur (degrees, 1..90). Default: from
  /// the noise of the normals.
  std::optional<double> crease_angle = {};
  /// Vertices of borders move along with the two beside them on the border; otherwise they stay.
  bool borders = false;

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What became of it, over the vertices that triangles use. Lengths in the unit of the mesh.
struct SANSMESH_API SmoothReport {
  std::size_t vertices = 0;             ///< used by a triangle; those at the same place count once
  std::size_t fixed = 0;                ///< of these stayed: on borders, or where edges have three triangles or more
  double mean_edge = 0;                 ///< before
  double rms_move = 0;                  ///< distance that vertices moved, root mean square
  double largest_move = 0;              ///< distance that vertices moved
  int iterations = 0;                   ///< as used
  double crease_angle = 0;              ///< as used, degrees
  bool shortened = false;               ///< `shorter_than` would have taken more iterations than there may be
  double area_before = 0;               ///< length²
  double area_after = 0;                ///< length²
  std::optional<double> volume_before;  ///< length³; nothing unless the mesh is closed and oriented
  std::optional<double> volume_after;   ///< length³; nothing unless the mesh is closed and oriented

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
