// Deformation of space by moving least squares: the map that best carries handles to where they went, weighted by their
// distance from each place (METHODS §7.1; thesis 6.4; Schaefer et al. 2006; Cuno et al. 2007).
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/deform/occluder.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// From places after the deformation back to those before it (weights by distances from where the handles went). The
/// forward map, for meshes and clouds, is that of reversed(handles). Interpolates: at handles, and all along those that
/// are segments, it is exact, and for `alpha` above 0.5 its Jacobian is the limit. Handles without size that are the
/// same twice count twice. All handles of a rigid map may lie on a line or be one: then nothing turns more than it
/// must. Positions are NaN where x is not finite.
class MlsDeformation final : public SpaceMap {
 public:
  /// Throws ArgumentError naming what is wrong with which handle (counted from 1), or with all of them for the kind,
  /// and the remedy.
  MlsDeformation(const std::vector<Handle>& handles, const MlsDeformationOptions& options,
                 std::vector<std::shared_ptr<const Occluder>> cuts = {});
  ~MlsDeformation() override;

  void map(std::span<const Vec3> x, const MapAnswers& wanted) const override;
  bool has_gaps() const override;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace sansmesh::inline v1
