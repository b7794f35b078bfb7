// Holes of a mesh, found and filled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A closed curve along the border of a mesh. Lengths in its unit.
/// What became of a hole.
enum class HoleOutcome : std::uint8_t { filled, too_large, failed, end };
/// In the order of the enumerators.
inline constexpr std::string_view kOutcomeWords[] = {"filled", "left open", "no way across", "steep, left open"};

struct HoleLoop {
  /// Vertices in the order in which triangles that fill it run: the border's own run the other way. Where vertices
  /// repeat at a place, the ones that the border has.
  std::vector<std::uint32_t> vertices;
  Vec3 middle;  ///< of its edges, in the coordinates of the world
  double perimeter = 0;
  double diameter = 0;  ///< diagonal of its box
  /// The same over the diagonal of the box of the piece that it is in: near 1 it is the outer border of that piece.
  double share = 0;
  /// How steeply the mesh leaves the plane of the loop, 0..1, on the mean: 0 of a hole in a plane, 1 of a tube that is
  /// cut off.
  double steepness = 0;
  std::optional<HoleOutcome> outcome = {};  ///< of filling it

  static const ReportSchema& schema();
};

struct HoleLoops {
  std::vector<HoleLoop> loops;        ///< by falling diameter
  std::size_t border_edges = 0;       ///< of one triangle
  std::size_t stray_edges = 0;        ///< of these, in no loop: the border ends at edges that are not manifold
  std::size_t nonmanifold_edges = 0;  ///< of three triangles or more

  static const ReportSchema& schema();
};

/// All loops; vertices at the same place are one. Where loops touch at a vertex, each is a loop of its own.
HoleLoops find_holes(const TriangleMesh& mesh);

struct FillOptions {
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

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct FillReport {
  HoleLoops found;  ///< with what became of each
  std::size_t filled = 0, too_large = 0;
  /// No triangles go across it without an edge that is there already.
  std::size_t failed = 0;
  /// Left open because they look like the ends of something that goes on.
  std::size_t ends = 0;
  std::size_t triangles = 0, vertices = 0;  ///< added
  double area = 0;                          ///< added, length²
  /// Pieces of the mesh whose middle lies near a filling (nearer than a quarter of the hole's diameter): they stay, and
  /// now lie before, behind or across it.
  std::size_t islands = 0;

  static const ReportSchema& schema();
};

/// Triangulates each hole so that the largest angle between triangles, and then the area, is least [liepa2003], adds
/// vertices, and places these where the Laplacian of the Laplacian vanishes: the filling has the tangents of its
/// surroundings. Colours, normals and attributes of new vertices are means of those of the border, by distance; of new
/// triangles they are unknown. The same for any number of threads.
FillReport fill_holes(TriangleMesh& mesh, const FillOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
