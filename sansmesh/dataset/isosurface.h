// Surfaces on which a quantity of a volume has one value: as fields like those of implicit surfaces, as solids, as
// meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/dataset/value_ranges.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// Where the volume is: negative inside, about the distance to its boundary (with the sign of the locator). In
/// coordinates of its own.
class VolumeDomain : public ScalarField {
 public:
  /// What is passed must outlive it.
  VolumeDomain(const SampledVolume& volume, const LocalFrame& frame);
  ~VolumeDomain() override;

  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;
  /// 1 for those of x in the volume, 0 for the others: quicker than distances. Sizes must agree.
  void locate(std::span<const Vec3> x, std::span<std::uint8_t> inside) const;

 private:
  struct Boundary;
  const SampledVolume& volume_;
  LocalFrame frame_;
  Box3 bounds_;
  std::unique_ptr<const Boundary> boundary_;  ///< none of a lattice
};

/// {f = value} as an implicit surface: negative where f is larger, in coordinates of its own (`place`), scaled so that
/// its gradient has norm 1 about the surface (on the median).
class Isosurface : public ScalarField {
 public:
  /// `field` has one component; `sample_value(i)` is that of sample i. Throws DataError where no cell of the volume
  /// has the value between those of its samples, naming the range of the data.
  Isosurface(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeField> field,
             const std::function<double(std::size_t)>& sample_value, double value);

  const LocalFrame& frame() const { return frame_; }
  double value() const { return value_; }
  /// Whether the volume is more than a box, so that the surface ends at its boundary.
  bool has_boundary() const { return !volume_->lattice.has_value(); }
  const VolumeDomain& domain() const { return domain_; }
  const SampledVolume& volume() const { return *volume_; }

  Box3 bounds() const override { return domain_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;
  /// From the samples around (ValueRanges).
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;
  /// Whether the surface may pass within `radius` of each of x (1; else 0): as ranges() would tell, but quicker.
  void may_pass(std::span<const Vec3> x, double radius, std::span<std::uint8_t> answers) const;
  /// Distance between samples: on the median, and around x.
  double median_spacing() const { return frame_.from_input(volume_->facts.median_spacing); }
  void spacing(std::span<const Vec3> x, std::span<double> found) const;

 private:
  std::vector<Vec3> in_input(std::span<const Vec3> x) const;

  std::shared_ptr<const SampledVolume> volume_;
  std::shared_ptr<const VolumeField> field_;
  LocalFrame frame_;
  double value_, slope_ = 1;
  VolumeDomain domain_;
  ValueRanges ranges_;
};

/// The surface as a mesh in the input's coordinates: it ends at the volume's boundary unless it is to be closed. Vertex
/// normals point to where the quantity is smaller. Throws DataError where nothing is found.
TriangleMesh mesh_isosurface(const Isosurface& surface, const IsosurfaceOptions& options, Progress& progress,
                             IsosurfaceReport* report = nullptr);

/// {f > value} as a solid in the input's coordinates, which ends at the volume's boundary.
Solid isosurface_solid(const std::shared_ptr<const Isosurface>& surface);

}  // namespace sansmesh::inline v1
