// Isosurfaces of volumes as implicit surfaces, solids and meshes.
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

/// Signed distance function of the volume's domain, approximate: negative inside, with the sign of the locator. Uses
/// local coordinates.
class VolumeDomain : public ScalarField {
 public:
  /// The arguments must outlive it.
  VolumeDomain(const SampledVolume& volume, const LocalFrame& frame);
  ~VolumeDomain() override;

  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;
  /// 1 for each x in the volume, 0 for the others; faster than distances. Sizes must agree.
  void locate(std::span<const Vec3> x, std::span<std::uint8_t> inside) const;

 private:
  struct Boundary;
  const SampledVolume& volume_;
  LocalFrame frame_;
  Box3 bounds_;
  std::unique_ptr<const Boundary> boundary_;  ///< null for a lattice
};

/// {f = value} as an implicit surface: negative where f is larger, in the local coordinates `frame`, scaled to a median
/// gradient norm of 1 at the surface. Of an ExponentialVolume it is the level set of the logarithm.
class Isosurface : public ScalarField {
 public:
  /// `field` has one component; `sample_value(i)` is the value of sample i. Throws DataError that names the range of
  /// the data if no cell of the volume has the value between those of its samples.
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
  /// Bounds by the samples around (ValueRanges).
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;
  /// Whether the surface may pass within `radius` of each x (1; else 0): the answer of ranges(), but faster.
  void may_pass(std::span<const Vec3> x, double radius, std::span<std::uint8_t> answers) const;
  /// Distance between samples: median, and around x.
  double median_spacing() const { return frame_.from_input(volume_->facts.median_spacing); }
  void spacing(std::span<const Vec3> x, std::span<double> found) const;

 private:
  struct Leveled;
  static Leveled leveled(std::shared_ptr<const VolumeField> field, double value);
  Isosurface(std::shared_ptr<const SampledVolume> volume, const Leveled& leveled,
             const std::function<double(std::size_t)>& sample_value, double value);
  std::vector<Vec3> in_input(std::span<const Vec3> x) const;

  std::shared_ptr<const SampledVolume> volume_;
  std::shared_ptr<const VolumeField> field_;  // the logarithm, where it is reconstructed
  LocalFrame frame_;
  double value_, level_, slope_ = 1;  // value of the array and of `field_`
  VolumeDomain domain_;
  ValueRanges ranges_;
};

/// The surface as a mesh in input coordinates. It ends at the volume's boundary unless the options close it. Vertex
/// normals point to smaller values. Throws DataError if the surface is empty.
TriangleMesh mesh_isosurface(const Isosurface& surface, const IsosurfaceOptions& options, Progress& progress,
                             IsosurfaceReport* report = nullptr);

/// {f > value} as a solid in input coordinates, bounded by the volume's boundary.
Solid isosurface_solid(const std::shared_ptr<const Isosurface>& surface);

}  // namespace sansmesh::inline v1
