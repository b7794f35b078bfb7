// Deformations of space: handles and their options, and what is found where space is folded or meshes are cut.
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

/// A unit direction before and after.
struct TurnedDirection {
  Vec3 before, after;  ///< unit directions
};

/// A point that went from p to q, or a segment from p to *p_end that went to q to *q_end (for `alpha` of 1 and above).
struct Handle {
  Vec3 p, q;                         ///< before, after
  std::optional<Vec3> p_end, q_end;  ///< both or neither

  /// Directions that went with it: one is the normal of a plane through the point, three orthonormal ones are a frame.
  /// They count as points so far from the handle (in both directions) as `reach` says would.
  std::vector<TurnedDirection> directions;
  /// Length, > 0; default: half the mean distance from a handle to the nearest other one, after the deformation
  /// (of the forward map: before it).
  std::optional<double> reach;

  double weight = 1;  ///< multiplies its influence, > 0
  std::string group;  ///< handles of one group turn as one body between poses
};

/// The same the other way round: what was after is before.
inline std::vector<Handle> reversed(std::vector<Handle> handles) {
  for (Handle& h : handles) {
    std::swap(h.p, h.q);
    std::swap(h.p_end, h.q_end);
    for (TurnedDirection& d : h.directions) std::swap(d.before, d.after);
  }
  return handles;
}

/// Maps that moving least squares choose from.
enum class DeformationKind : std::uint8_t {
  affine,      ///< at least 4 handles, not in a plane
  similarity,  ///< turns and scales
  rigid,       ///< turns
  nonlinear,   ///< polynomials of `degree`; bends
};

/// "affine", "similarity", …
SANSMESH_API std::string_view kind_word(DeformationKind kind);

/// Deformation of space by moving least squares: the map that best carries handles to where they went, weighted by
/// their distance from each place (METHODS §7.1; thesis 6.4).
struct SANSMESH_API MlsDeformationOptions {
  DeformationKind kind = DeformationKind::rigid;  ///< of the map at each place
  /// Nonlinear: 2 (9 handles in general position) or 3 (19). With no more than that, or where the handles lie on a
  /// sphere or its like, terms of the highest degree whose Laplacian is not 0 are left out.
  int degree = 2;
  /// Weights are 1 / distance^(2 alpha); 0.5..8, with segments 1..8. At 0.5 the map has creases at handles. Above about
  /// 4 places are seldom within reach of more than two handles as far as double precision goes.
  double alpha = 1;
  /// Influence on the far side of a cut falls with distance / (distance + damping · detour); >= 1.
  double damping = 1;

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

// ---- Reports -----------------------------------------------------------------------------------------------------

/// Neighbouring points of a lattice where the determinant of the map's Jacobian is not above 0.
struct SANSMESH_API Fold {
  Box3 box;          ///< of the cells about its points
  Vec3 center;       ///< mean of its points
  double share = 0;  ///< of the volume looked at
  double least = 0;  ///< determinant

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Where a map of space is folded: several places come from one, inside out in between.
struct SANSMESH_API FoldReport {
  double share = 0;         ///< of the volume looked at: where the map is defined, and no gap
  double least = 0;         ///< determinant anywhere; 1 where nothing is known
  std::vector<Fold> folds;  ///< connected ones, the largest first
  GridBlock determinants;   ///< lattice with an array `determinant` (1 float; NaN outside of that volume)

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// A mesh that was opened along cuts.
struct SANSMESH_API OpenMeshReport {
  std::size_t edges = 0;     ///< along which the mesh was opened
  std::size_t doubled = 0;   ///< vertices that were added for them
  std::size_t faces = 0;     ///< triangles of cut faces, both sides together
  std::size_t unopened = 0;  ///< triangles that a cut crosses in too complicated a way, after all refinements
  std::size_t unclosed = 0;  ///< cuts that left something open: meshes as cuts, open meshes

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
