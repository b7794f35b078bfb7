// Surfaces of volumes without a mesh: moving least squares on voxels that weigh in by how near their value is to that
// of an isosurface, or how steep the volume is there (METHODS §5.1).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// The surface as a projection, in coordinates of its own.
class VolumeSurface {
 public:
  ~VolumeSurface();
  VolumeSurface(VolumeSurface&&) noexcept;
  VolumeSurface& operator=(VolumeSurface&&) noexcept;

  const SampledVolume& volume() const;
  const LocalFrame& frame() const;
  const Projection& projection() const;
  /// About the signed distance, negative where the quantity is larger: FootField, or with `exact` the distance to the
  /// foot of the place itself. Where nothing is projected the nearest sample tells the side.
  const ScalarField& field() const;
  const BallUnion& balls() const;
  /// Of the samples around the balls' centres.
  std::span<const float> spacing() const;
  /// Feet of the samples next to the surface, no closer to each other than 0.75 spacings, with normals: what curvatures
  /// and sharp normals are told from.
  PointSet feet() const;
  const VolumeSurfaceOptions& options() const;
  const VolumeSurfaceReport& report() const;

  /// Blocks for polygonisation: as fine as the samples near the surface.
  BlockTree blocks() const;

 private:
  friend VolumeSurface make_volume_surface(std::shared_ptr<const SampledVolume>, std::span<const double>, double,
                                           const VolumeSurfaceOptions&, Progress&);
  friend TriangleMesh mesh_volume_surface(const VolumeSurface&, const MeshOptions&, Progress&, MeshReport*);
  friend PointSet sample_volume_surface(const VolumeSurface&, std::optional<double>, Progress&);
  struct State;
  explicit VolumeSurface(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// `values`: one a sample, finite; `noise`: their standard deviation, where it is known to be noise (unit of the array,
/// >= 0). Throws ArgumentError for bad options, DataError where values do not have that value (naming their range) or
/// no sample is near such a surface.
VolumeSurface make_volume_surface(std::shared_ptr<const SampledVolume> volume, std::span<const double> values,
                                  double noise, const VolumeSurfaceOptions& options, Progress& progress);

/// A mesh of it in the input's coordinates, closed where the surface is; vertex normals point to where the quantity is
/// smaller. Of `meshing` the options of samples (trim, colours, confidence) mean nothing; `components` automatic leaves
/// out, with a warning, what is smaller than the weights are wide. Throws DataError where nothing is found.
TriangleMesh mesh_volume_surface(const VolumeSurface& surface, const MeshOptions& meshing, Progress& progress,
                                 MeshReport* report = nullptr);

/// Points spread evenly over it, so far apart (length, at least an eighth of the spacing; default: the spacing), with
/// normals: splats, in the input's coordinates. Throws ArgumentError for other distances.
PointSet sample_volume_surface(const VolumeSurface& surface, std::optional<double> distance, Progress& progress);

}  // namespace sansmesh::inline v1
