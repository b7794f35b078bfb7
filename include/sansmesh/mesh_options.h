// Options of meshes, whatever field or solid they are cut out of, and what became of them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Which connected components of the surface are kept.
struct ComponentChoice {
  /// How it is chosen.
  enum class Kind {
    automatic,  ///< of fitted surfaces those that enough samples stand for; of solids those of enough area
    all,        ///< every one
    count       ///< the `count` largest
  };
  Kind kind = Kind::automatic;  ///< how it is chosen
  int count = 1;                ///< for Kind::count: this many of the largest
};

/// The choice in a word: "auto", "all", "largest", "3".
SANSMESH_API std::string text_of_option(const ComponentChoice& choice);

/// Reads such a word. Throws ArgumentError.
SANSMESH_API void option_of_text(std::string_view word, ComponentChoice& choice);

/// How the surface is cut out of the blocks.
enum class Mesher {
  automatic,  ///< a fit as the sources have it is walked; whole blocks for all else
  blocks,     ///< whole blocks, clustered, smoothed and simplified
  walk        ///< the sources' walk from simplex to simplex, which knows no enhancement but `displacement`
};

/// What a mesh of a surface should be like. All optional lengths are in the unit of the input; where absent they are
/// derived from the field.
struct SANSMESH_API MeshOptions {
  Mesher mesher = Mesher::automatic;      ///< of fitted functions; other surfaces are cut out of whole blocks
  std::optional<double> mesh_error = {};  ///< accepted mean distance between mesh and surface (length)
  /// At most this many triangles, at least 4 (needs `enhance`); the mesh error then follows from it.
  std::optional<std::size_t> triangles = {};
  /// Where the surface ends with its samples (it bounds no solid): holes up to so wide are closed (length); default:
  /// what the samples' local spacing leaves between them, such as gaps between the lines of a scanner.
  std::optional<double> fill_holes = {};
  std::optional<double> trim =
      {};  ///< cut the surface farther than this from any sample (length); 0 = choose from data
  ComponentChoice components = {};  ///< parts to keep
  bool carry_colors = true;         ///< vertices get the colour of the nearest sample, where there are some
  /// Whether the vertices get the attributes `distance` (to the nearest sample, length) and `confidence`
  /// (0..1: 1 amid samples, 0 far from all of them); default: where some of the surface is open.
  std::optional<bool> confidence = {};
  bool enhance = true;  ///< few, well-shaped triangles: clustering, smoothing, simplification
  /// Without `enhance`, or with a walk: α of METHODS 3.3, 0 ≤ α < 1: lattice vertices step back from the surface before
  /// it is cut out, by up to α times a quarter of the local block edge.
  double displacement = 0;
  bool measure_quality = false;  ///< fill in the report's aspect ratios (costs a second, unenhanced extraction)
  std::optional<Box3> box = {};  ///< only what lies in this box (input coordinates), cut off straight and open there
  /// Deepest level of the blocks that the surface is cut out of, 2..14: coarser.
  std::optional<int> block_depth = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the option.
  void validate() const;
  /// The same for what is meshed by a walk: also where an option means nothing to it.
  void validate_walk() const;
};

/// Numbers of a mesh of a surface. Lengths in the unit of the input.
struct SANSMESH_API MeshReport {
  std::size_t simplices = 0;           ///< that a walk went through; 0 without one
  std::size_t blocks = 0;              ///< leaf blocks
  int block_depth = 0;                 ///< deepest level of the tree of blocks
  int components = 0;                  ///< of the mesh written
  double aspect_mean_before = 0;       ///< aspect ratio of the unenhanced mesh: mean; 0 unless measured
  double aspect_deviation_before = 0;  ///< its standard deviation
  double aspect_mean = 0;              ///< aspect ratio (METHODS 3.3) of the mesh: mean; 0 unless measured
  double aspect_deviation = 0;         ///< its standard deviation
  double mesh_error = 0;               ///< distance between mesh and surface aimed at (length)
  bool open = false;                   ///< some of the surface bounds no solid, and ends where its samples do
  /// Share of the samples farther from the mesh than two spacings and four times the noise: they have no surface.
  double lost = 0;
  std::optional<Vec3> most_lost;      ///< if that is more than one in a hundred: where most of them are
  std::vector<std::string> warnings;  ///< what could not be as it was asked for, a sentence each

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What the mesh of a solid should be like. Lengths in the unit of its expression.
struct SANSMESH_API CsgMeshOptions {
  /// Accepted mean distance between curved parts and their triangles (length); by default a 50,000th of the diagonal of
  /// the box. Of solids that are more than minima and maxima of smooth pieces (deformed ones): as simplification asks
  /// for.
  std::optional<double> mesh_error = std::nullopt;
  /// At most this many triangles, at least 4: the mesh error then follows from it.
  std::optional<std::size_t> triangles = std::nullopt;
  /// Edge of the blocks along curved parts, whatever the error, and of the smallest ones (length). Balls, rods and
  /// tubes thinner than one of them can be lost; a warning says so of those that are known to be thin.
  std::optional<double> cell = std::nullopt;
  /// Instead: such blocks along the longest side of the box, 4..4096. With neither, blocks are as small as the error
  /// and thin parts ask for. Of solids that are more than minima and maxima of smooth pieces: the box's diagonal has
  /// 256, or up to 1024 where functions show more or parts are thin.
  std::optional<int> resolution = std::nullopt;
  /// The solid is cut off at this box. Needed if it has no end otherwise.
  std::optional<Box3> box = std::nullopt;
  /// Collapse edges while the quadric error stays below this (length): few triangles where the surface is flat, and no
  /// difference where it is exactly so. 0 = off; by default as the mesh error asks for, with `cell` about a thousandth
  /// of that.
  std::optional<double> simplify = std::nullopt;

  /// Parts to keep; automatic: those that have at least 1.5 % of the largest one's area. Default: all.
  std::optional<ComponentChoice> components = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the option.
  void validate() const;
};

/// Numbers of a mesh of a solid.
struct SANSMESH_API CsgMeshReport {
  Box3 box;                    ///< in which the surface lies: tight to a thirty-second of the solid's bounds
  double cell = 0;             ///< edge of the smallest blocks
  int depth = 0;               ///< levels of the tree of blocks
  std::size_t blocks = 0;      ///< leaf blocks
  std::size_t components = 0;  ///< of the mesh
  bool closed = false;         ///< and manifold and oriented
  double area = 0;             ///< of the mesh, length²
  double volume = 0;           ///< of the mesh, length³
  double mean_error = 0;       ///< distance of the triangles' middles from the surface: mean over the area (length)
  double largest_error = 0;    ///< distance of the triangles' middles from the surface: largest (length)
  std::vector<std::string> warnings;  ///< what could not be as it was asked for, a sentence each

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
