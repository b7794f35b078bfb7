// Handles and options of deformations of space, and reports of folds and of meshes opened along cuts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

// ---- Handles -----------------------------------------------------------------------------------------------------

/// A unit direction before and after the deformation.
struct TurnedDirection {
  Vec3 before, after;  ///< unit directions
};

/// A point that moves from p to q, or a segment from p–*p_end to q–*q_end (segments need `alpha` >= 1).
struct Handle {
  Vec3 p, q;                         ///< position before, position after
  std::optional<Vec3> p_end, q_end;  ///< set both or neither

  /// Directions that move with the handle: one is the normal of a plane through the point, three orthonormal ones are a
  /// frame. They act as points at distance `reach` from the handle, in both directions.
  std::vector<TurnedDirection> directions;
  /// Length, > 0. Default: half the mean distance from a handle to its nearest neighbour, after the deformation (for
  /// the forward map: before it).
  std::optional<double> reach;

  double weight = 1;  ///< factor of the handle's influence, > 0
  std::string group;  ///< between poses, handles of one group move as one rigid body
};

/// Handles of the inverse deformation: before and after are exchanged.
inline std::vector<Handle> reversed(std::vector<Handle> handles) {
  for (Handle& h : handles) {
    std::swap(h.p, h.q);
    std::swap(h.p_end, h.q_end);
    for (TurnedDirection& d : h.directions) std::swap(d.before, d.after);
  }
  return handles;
}

/// Class of maps that moving least squares fits.
enum class DeformationKind : std::uint8_t {
  affine,      ///< at least 4 handles, not coplanar
  similarity,  ///< rotation, translation and scale
  rigid,       ///< rotation and translation
  nonlinear,   ///< polynomials of `degree`; can bend space
};

/// Names: "affine", "similarity", …
SANSMESH_API std::string_view kind_word(DeformationKind kind);

/// Options of a deformation of space by moving least squares: at each point, the map that best carries the handles to
/// their targets, weighted by their distances (tejada2008, 6.4).
struct SANSMESH_API MlsDeformationOptions {
  DeformationKind kind = DeformationKind::rigid;  ///< class of the local map
  /// Degree of nonlinear maps: 2 (needs 9 handles in general position) or 3 (needs 19). With exactly that many handles,
  /// or with handles on a quadric such as a sphere, highest-degree terms whose Laplacian is not 0 are left out.
  int degree = 2;
  /// Exponent of the weights 1 / distance^(2 alpha); 0.5..8, with segments 1..8. At 0.5 the map has creases at handles.
  /// Above about 4, double precision seldom resolves the influence of more than two handles at a point.
  double alpha = 1;
  /// Across a cut, influence is multiplied by distance / (distance + damping · detour); >= 1.
  double damping = 1;

  /// One row per field
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

// ---- Reports -----------------------------------------------------------------------------------------------------

/// Connected set of lattice points at which the determinant of the map's Jacobian is not positive.
struct SANSMESH_API Fold {
  Box3 box;          ///< bounds of the cells around its points
  Vec3 center;       ///< mean of its points
  double share = 0;  ///< fraction of the examined volume
  double least = 0;  ///< smallest determinant

  static const ReportSchema& schema();  ///< one row per reported value
};

/// Folds of a map of space: regions that the map turns inside out, so that several points have one image.
struct SANSMESH_API FoldReport {
  double share = 0;         ///< fraction of the examined volume, which is where the map is defined and no gap
  double least = 0;         ///< smallest determinant; 1 if nothing was examined
  std::vector<Fold> folds;  ///< connected folds, in order of decreasing size
  GridBlock determinants;   ///< lattice with an array `determinant` (1 float; NaN outside the examined volume)

  static const ReportSchema& schema();  ///< one row per reported value
};

/// Figures of a mesh that was opened along cuts.
struct SANSMESH_API OpenMeshReport {
  std::size_t edges = 0;     ///< edges along which the mesh was opened
  std::size_t doubled = 0;   ///< vertices added by doubling
  std::size_t faces = 0;     ///< triangles of cut faces, both sides together
  std::size_t unopened = 0;  ///< triangles whose intersection with a cut is too complicated, after all refinements
  std::size_t unclosed = 0;  ///< cuts that left the mesh open: the cut is a mesh, or the mesh was open before

  static const ReportSchema& schema();  ///< one row per reported value
};

}  // namespace sansmesh::inline v1
