// Surfaces of volumes without a mesh: moving least squares on voxels, weighted by how close their value is to the
// iso-value or by the norm of their gradient (tejada2008, 5.2).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// The surface as a projection, in local coordinates.
class VolumeSurface {
 public:
  ~VolumeSurface();
  VolumeSurface(VolumeSurface&&) noexcept;
  VolumeSurface& operator=(VolumeSurface&&) noexcept;

  const SampledVolume& volume() const;
  const LocalFrame& frame() const;
  const Projection& projection() const;
  /// Approximate signed distance, negative where the quantity is larger: FootField, or with `exact` the distance to the
  /// foot of the query point itself. Where the projection is undefined the nearest sample determines the side.
  const ScalarField& field() const;
  const BallUnion& balls() const;
  /// Spacing of the samples around the balls' centres.
  std::span<const float> spacing() const;
  /// The samples next to the surface, with a ball around each, and their spacing.
  const BallUnion& sample_balls() const;
  std::span<const float> sample_spacing() const;
  const VolumeDomain& domain() const;
  /// Feet of the samples next to the surface, at least 0.75 spacings apart, with normals: the basis of curvatures and
  /// sharp normals.
  PointSet feet() const;
  const VolumeSurfaceOptions& options() const;
  const VolumeSurfaceReport& report() const;

  /// Blocks for polygonisation: as fine as the samples near the surface.
  BlockTree blocks() const;

 private:
  friend VolumeSurface make_volume_surface(std::shared_ptr<const SampledVolume>, std::span<const double>, double,
                                           const VolumeSurfaceOptions&, Progress&,
                                           const std::function<std::optional<std::vector<double>>()>&);
  struct State;
  explicit VolumeSurface(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// `values`: one per sample, finite; `noise`: their standard deviation (unit of the array, >= 0) where known. Throws
/// ArgumentError for bad options, DataError if the value does not occur (naming the range) or no sample is near such a
/// surface.
///
/// `smoothed` makes the values without noise, or nothing if they stay as they are. It is only called where noise moves
/// isosurfaces so far that weights of the largest width do not average it: from a quarter of the spacing on in part,
/// from half of it on the surface is that of the smoothed values. Where noise is less, smoothing first would move the
/// surface by more than the weights do.
VolumeSurface make_volume_surface(std::shared_ptr<const SampledVolume> volume, std::span<const double> values,
                                  double noise, const VolumeSurfaceOptions& options, Progress& progress,
                                  const std::function<std::optional<std::vector<double>>()>& smoothed = {});

}  // namespace sansmesh::inline v1
