// Deformation of space by moving least squares: the map that best carries handles to where they went, weighted by their
// distance from each place (METHODS §7.1; thesis 6.4; Schaefer et al. 2006; Cuno et al. 2007).
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/deform/handles.h"
#include "sansmesh/deform/occluder.h"
#include "sansmesh/field/space_map.h"

namespace sansmesh {

enum class DeformationKind {
  affine,      ///< at least 4 handles, not in a plane
  similarity,  ///< turns and scales
  rigid,       ///< turns
  nonlinear,   ///< polynomials of `degree`
};

struct MlsDeformationOptions {
  DeformationKind kind = DeformationKind::rigid;
  int degree = 2;    ///< nonlinear: 2 (9 handles in general position) or 3 (19)
  double alpha = 1;  ///< weights are 1 / distance^(2 alpha); 0.5..8
  /// Influence on the far side of a cut falls with distance / (distance + damping · detour); >= 1.
  double damping = 1;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// From places after the deformation back to those before it (weights by distances from where the handles went). The
/// forward map, for meshes and clouds, is that of reversed(handles). Interpolates: at handles it is exact.
class MlsDeformation final : public SpaceMap {
 public:
  /// Throws ArgumentError naming what is wrong with which handle (counted from 1), or with all of them for the kind,
  /// and the remedy.
  MlsDeformation(std::vector<Handle> handles, const MlsDeformationOptions& options,
                 std::vector<std::shared_ptr<const Occluder>> cuts = {});
  ~MlsDeformation() override;

  void map(std::span<const Vec3> x, const MapAnswers& wanted) const override;
  bool has_gaps() const override;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace sansmesh
