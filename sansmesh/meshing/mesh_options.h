// What is asked of a mesh, whatever field it is cut out of, and what became of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// Which connected components of the surface are kept.
struct ComponentChoice {
  enum class Kind { automatic, all, count } kind = Kind::automatic;
  int count = 1;  ///< for Kind::count: this many of the largest
};

/// "auto", "all", "largest", "3"
std::string text_of_option(const ComponentChoice& choice);
/// Throws ArgumentError.
void option_of_text(std::string_view word, ComponentChoice& choice);

/// How the surface is cut out of the blocks.
enum class Mesher {
  automatic,  ///< a fit as the sources have it is walked; whole blocks for all else
  blocks,     ///< whole blocks, clustered, smoothed and simplified
  walk        ///< the sources' walk from simplex to simplex, which knows no enhancement but `displacement`
};

/// All optional lengths are in the unit of the input; where absent they are derived from the field.
struct MeshOptions {
  Mesher mesher = Mesher::automatic;      ///< of fitted functions; other surfaces are cut out of whole blocks
  std::optional<double> mesh_error = {};  ///< accepted mean distance between mesh and surface (length)
  /// At most this many triangles, at least 4 (needs `enhance`); the mesh error then follows from it.
  std::optional<std::size_t> triangles = {};
  /// Where the surface ends with its samples (it bounds no solid): holes up to so wide are closed (length); default:
  /// what the samples' local spacing leaves between them, such as gaps between the lines of a scanner.
  std::optional<double> fill_holes = {};
  std::optional<double> trim =
      {};  ///< cut the surface farther than this from any sample (length); 0 = choose from data
  ComponentChoice components = {};
  bool carry_colors = true;
  /// Whether the vertices get the attributes `distance` (to the nearest sample, length) and `confidence` (0..1,
  /// SampleConfidence); default: where some of the surface is open.
  std::optional<bool> confidence = {};
  bool enhance = true;  ///< few, well-shaped triangles: clustering, smoothing, simplification
  /// Without `enhance`, or with a walk: α of METHODS 3.3, 0 ≤ α < 1: lattice vertices step back from the surface before
  /// it is cut out, by up to α times a quarter of the local block edge.
  double displacement = 0;
  bool measure_quality = false;  ///< fill in the report's aspect ratios (costs a second, unenhanced extraction)
  std::optional<Box3> box = {};  ///< only what lies in this box (input coordinates), cut off straight and open there
  /// Deepest level of the blocks that the surface is cut out of, kLeastDepth..kMostDepth: coarser.
  std::optional<int> block_depth = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the option.
  void validate() const;
  /// The same for what is meshed by a walk: also where an option means nothing to it.
  void validate_walk() const;
};

struct MeshReport {
  std::size_t simplices = 0;                                   ///< that a walk went through; 0 without one
  std::size_t blocks = 0;                                      ///< leaf blocks
  int block_depth = 0;                                         ///< deepest level of the tree of blocks
  int components = 0;                                          ///< of the mesh written
  double aspect_mean_before = 0, aspect_deviation_before = 0;  ///< aspect ratio of the unenhanced mesh
  double aspect_mean = 0, aspect_deviation = 0;
  double mesh_error = 0;  ///< distance between mesh and surface aimed at (length)
  bool open = false;      ///< some of the surface bounds no solid, and ends where its samples do
  /// Share of the samples farther from the mesh than two spacings and four times the noise: they have no surface.
  double lost = 0;
  std::optional<Vec3> most_lost;  ///< if that is more than one in a hundred: where most of them are
  std::vector<std::string> warnings;

  static const ReportSchema& schema();
};

}  // namespace sansmesh::inline v1
