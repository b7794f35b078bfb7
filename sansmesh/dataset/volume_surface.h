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
#include "sansmesh/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/placement.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct VolumeSurfaceOptions {
  enum class Kind {
    isovalue,  ///< ω₁ = exp(−((v − f_i)/β₁)²): where the quantity has a value
    high_gradient  ///< ω₂ = exp(−((‖∇f_i‖/‖∇f‖_max − 1)/β₂)²): where it changes most, borders of materials
  } kind = Kind::isovalue;
  double value = 0;  ///< v (unit of the array; isovalue only)
  /// β₁ (unit of the array, > 0) or β₂ (share, 0.01..1). Default of β₁: what the quantity changes by over a spacing
  /// around each sample, so that the layer of samples that count is equally thick at steep and at flat places; of β₂:
  /// 0.35.
  std::optional<double> beta;
  /// h of the corrector's weights, and half the radius of the predictor's, in spacings, 0.5..20. Default: 2, more with
  /// noise.
  std::optional<double> smoothing;
  /// high_gradient: ‖∇f‖_max is the largest across the border around the sample, so that faint borders count like
  /// strong ones; else the largest of the volume as in the source, a thousandth of the samples left out.
  bool local_maximum = true;
  /// high_gradient: least ‖∇f‖ of a border (unit of the array per length). Default: what stands out from noise, a
  /// seventh of the largest at least.
  std::optional<double> least_gradient;
  bool predictor = true, corrector = true;  ///< as in LayerOptions, like what follows
  bool alternating = false, line_search = false;
  bool separate_sheets = true;
  /// field() asks the projection itself at every place, not the paraboloids at the feet of the samples: the definition
  /// to the letter, for two (meshes) to ten (pictures) times the time.
  bool exact = false;

  /// Without `value`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct VolumeSurfaceReport {
  std::size_t samples = 0;     ///< that count
  double spacing = 0;          ///< of those, on the median (length)
  double smoothing = 0;        ///< h over the spacing
  double slope = 0;            ///< of the quantity at the surface, on the median (unit of the array per length)
  double noise = 0;            ///< of the values (unit of the array)
  double noise_distance = 0;   ///< what that moves an isosurface by (length)
  double least_gradient = 0;   ///< high_gradient
  std::optional<double> beta;  ///< where one holds everywhere

  static const ReportSchema& schema();
};

/// The surface as a projection, in coordinates of its own.
class VolumeSurface {
 public:
  ~VolumeSurface();
  VolumeSurface(VolumeSurface&&) noexcept;
  VolumeSurface& operator=(VolumeSurface&&) noexcept;

  const SampledVolume& volume() const;
  const Placement& place() const;
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
