// Deformation of space by moving least squares: at each point, the map that best carries the handles to their targets,
// weighted by their distances (tejada2008, 6.4; schaefer2006; cuno2007).
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// Maps points after the deformation back to those before it (weights by distances from the targets). The forward map,
/// for meshes and clouds, is that of reversed(handles). Interpolates: the map is exact at handles and along segments,
/// and for `alpha` above 0.5 its Jacobian is the limit there. Duplicate point handles count twice. All handles of a
/// rigid map may be collinear or coincide; the rotation is then the smallest possible. Positions are NaN where x is not
/// finite.
class MlsDeformation final : public SpaceMap {
 public:
  /// Throws ArgumentError that names the fault of a handle (counted from 1) or of the whole set for this kind, and the
  /// remedy.
  MlsDeformation(const std::vector<Handle>& handles, const MlsDeformationOptions& options,
                 std::vector<std::shared_ptr<const Occluder>> cuts = {});
  ~MlsDeformation() override;

  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override;
  bool has_gaps() const override;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace sansmesh::inline v1
