// Options and reports of meshes of fields and of solids.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Connected components of a surface that the mesh keeps.
struct ComponentChoice {
  /// Selection rule.
  enum class Kind {
    automatic,  ///< fitted surfaces: components that enough samples support; solids: components of enough area
    all,        ///< all components
    count       ///< the `count` largest
  };
  Kind kind = Kind::automatic;  ///< selection rule
  int count = 1;                ///< for Kind::count: number of components to keep
};

/// The choice as a word: "auto", "all", "largest", "3".
SANSMESH_API std::string text_of_option(const ComponentChoice& choice);

/// Parses such a word. Throws ArgumentError.
SANSMESH_API void option_of_text(std::string_view word, ComponentChoice& choice);

/// Algorithm that extracts the mesh.
enum class Mesher {
  automatic,  ///< `walk` for a fit by the source's method; `blocks` otherwise
  blocks,     ///< marching over whole blocks, then clustering, smoothing and simplification
  walk        ///< the source's walk from simplex to simplex; of the enhancements it supports only `displacement`
};

/// Options of a mesh of a surface. Optional lengths are in the unit of the input; absent ones are derived from the
/// field.
struct SANSMESH_API MeshOptions {
  Mesher mesher = Mesher::automatic;      ///< applies to fitted functions; other surfaces always use `blocks`
  std::optional<double> mesh_error = {};  ///< accepted mean distance between mesh and surface (length)
  /// Largest number of triangles, at least 4 (needs `enhance`); the mesh error then follows from it.
  std::optional<std::size_t> triangles = {};
  /// Open surfaces: holes up to this width (length) are closed. Default: the width of gaps that the local spacing of
  /// the samples explains, such as gaps between scan lines.
  std::optional<double> fill_holes = {};
  std::optional<double> trim =
      {};  ///< cut the surface farther than this from any sample (length); 0 = choose from data
  ComponentChoice components = {};  ///< components to keep
  /// Cuts and caps handles and tunnels about as narrow as the spacing, or as the noise, whose walls no samples support.
  bool close_handles = true;
  bool carry_colors = true;  ///< vertices take the colour of the nearest samples, if these have colours
  /// Adds the vertex attributes `distance` (to the nearest sample, length) and `confidence` (1 amid samples, 0 far from
  /// all of them). Default: only where part of the surface is open.
  std::optional<bool> confidence = {};
  bool enhance = true;  ///< few, well-shaped triangles: clustering, smoothing, simplification
  /// Without `enhance`, or with a walk: α of tejada2008, 4.4.3, 0 ≤ α < 1. Before extraction, lattice vertices move
  /// away from the surface by up to α times a quarter of the local block edge.
  double displacement = 0;
  bool measure_quality = false;  ///< report the aspect ratios (costs a second, unenhanced extraction)
  std::optional<Box3> box = {};  ///< clip to this box (input coordinates); the mesh is open at the cuts
  /// Deepest level of the blocks, 2..14; a smaller value gives a coarser mesh.
  std::optional<int> block_depth = {};

  static const OptionSchema& schema();  ///< one row per field
  /// Throws ArgumentError naming the option.
  void validate() const;
  /// Checks of the options for a walk; also rejects options that a walk does not use.
  void validate_walk() const;
};

/// Figures of a mesh of a surface. Lengths are in the unit of the input.
struct SANSMESH_API MeshReport {
  std::size_t simplices = 0;  ///< simplices visited by a walk; 0 without one
  std::size_t blocks = 0;     ///< leaf blocks
  int block_depth = 0;        ///< deepest level of the tree of blocks
  int components = 0;         ///< connected components of the mesh
  /// Handles of all components; empty if not measured.
  std::optional<std::size_t> genus = {};
  std::size_t closed_handles = 0;  ///< handles without samples that were cut (MeshOptions::close_handles)
  /// Remaining handles narrower than two spacings or four times the noise, or without samples around them.
  std::size_t narrow_handles = 0;
  std::optional<Vec3> narrowest_handle;  ///< centre of the shortest loop around one of them
  double aspect_mean_before = 0;         ///< mean aspect ratio of the unenhanced mesh; 0 unless measured
  double aspect_deviation_before = 0;    ///< its standard deviation
  /// Mean aspect ratio l_max P / (4√3 S) of the mesh's triangles (1: equilateral); 0 unless measured.
  double aspect_mean = 0;
  double aspect_deviation = 0;  ///< its standard deviation
  double mesh_error = 0;        ///< target distance between mesh and surface (length)
  bool open = false;            ///< part of the surface bounds no solid and ends where its samples end
  /// Share of the samples without a surface: farther from the mesh than two spacings and four times the noise.
  double lost = 0;
  std::optional<Vec3> most_lost;  ///< location of most of these samples, if their share exceeds 0.01
  std::vector<Note> notes;        ///< requests that could not be met, and samples without a surface

  static const ReportSchema& schema();  ///< one row per reported value
};

/// Algorithm that makes the mesh of a solid.
enum class CsgMesher {
  automatic,  ///< `faces` for solids with meshes, and of boxes and planes, whose parts all have faces; else `function`
  faces,      ///< exact Boolean operations on triangles: faces that no others cut stay as they are
  function    ///< a mesh of the zero set of the solid's function
};

/// Options of a mesh of a solid. Lengths are in the unit of its expression.
struct SANSMESH_API CsgMeshOptions {
  /// Options of blocks (`cell`, `resolution`, `simplify`) and `triangles` need `function`.
  CsgMesher mesher = CsgMesher::automatic;
  /// Accepted mean distance between curved parts and their triangles (length). Default: a 50,000th of the box's
  /// diagonal. For solids that are not minima and maxima of smooth functions (deformed solids), the default follows
  /// from `simplify`.
  std::optional<double> mesh_error = std::nullopt;
  /// Largest number of triangles, at least 4; the mesh error then follows from it.
  std::optional<std::size_t> triangles = std::nullopt;
  /// Edge of the smallest blocks and of all blocks along curved parts, independent of the error (length). Balls, rods
  /// and tubes thinner than one block can be lost; a warning reports those that are known to be thin.
  std::optional<double> cell = std::nullopt;
  /// Alternative to `cell`: number of such blocks along the longest side of the box, 4..4096. With neither, the error
  /// and thin parts determine the size. For solids that are not minima and maxima of smooth functions, the box's
  /// diagonal has 256 blocks, or up to 1024 where functions have finer detail or parts are thin.
  std::optional<int> resolution = std::nullopt;
  /// Clips the solid. Required if the solid is unbounded.
  std::optional<Box3> box = std::nullopt;
  /// Edges are collapsed while the quadric error stays below this (length), so that flat parts have few triangles;
  /// exactly flat parts keep their shape. 0 = off. Default: derived from the mesh error; with `cell`, about a
  /// thousandth of it.
  std::optional<double> simplify = std::nullopt;

  /// Components to keep. Automatic: those of at least 1.5 % of the largest one's area. Default: all.
  std::optional<ComponentChoice> components = {};

  static const OptionSchema& schema();  ///< one row per field
  /// Throws ArgumentError naming the option.
  void validate() const;
};

/// Figures of a mesh of a solid.
struct SANSMESH_API CsgMeshReport {
  CsgMesher mesher = CsgMesher::function;  ///< algorithm used; never `automatic`
  std::string reason = "a function";       ///< why this one
  Box3 box;                                ///< contains the surface; tight to a thirty-second of the solid's bounds
  double cell = 0;                         ///< edge of the smallest blocks
  int depth = 0;                           ///< levels of the tree of blocks
  std::size_t blocks = 0;                  ///< leaf blocks
  std::size_t components = 0;              ///< connected components of the mesh
  bool closed = false;                     ///< closed, manifold and oriented
  double area = 0;                         ///< area of the mesh, length²
  double volume = 0;                       ///< volume of the mesh, length³
  double mean_error = 0;          ///< mean distance from triangle centroids to the surface, weighted by area (length)
  double largest_error = 0;       ///< largest distance from a triangle centroid to the surface (length)
  std::size_t cut_faces = 0;      ///< with `faces`: faces of the parts that others cut or touch
  std::size_t seam_vertices = 0;  ///< with `faces`: vertices where faces intersect
  std::vector<Note> notes;        ///< requests that could not be met

  static const ReportSchema& schema();  ///< one row per reported value
};

}  // namespace sansmesh::inline v1
