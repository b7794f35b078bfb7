// Isosurface of a time-dependent volume as a field in space and time.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/dataset/value_ranges.h"
#include "sansmesh/field/time_field.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// A time step of a volume.
struct IsosurfaceStep {
  double time = 0;
  std::shared_ptr<const SampledVolume> volume;
  std::shared_ptr<const VolumeField> field;         ///< has one component
  std::function<double(std::size_t)> sample_value;  ///< value of sample i; used during construction
};

/// {f(x, t) = value}, f linear in time between the steps: negative where f is larger, in the local coordinates `frame`,
/// scaled to a median gradient norm in space of 1 at the surface. Grids may differ between steps; the domain is the
/// volume of the first step, and all points outside it are outside the surface. All steps stay in memory.
class IsosurfaceInTime final : public TimeField {
 public:
  /// Throws ArgumentError unless there are at least two steps, times increase and all fields have one component;
  /// DataError if the value does not occur at any step.
  IsosurfaceInTime(std::vector<IsosurfaceStep> steps, double value);
  ~IsosurfaceInTime() override;

  const LocalFrame& frame() const { return frame_; }
  double value() const { return value_; }
  double median_spacing() const;  ///< median distance between samples of the first step (local length)
  double shortest_step() const;   ///< shortest time between two steps

  Box3 bounds() const override { return domain_.bounds(); }
  TimeRange times() const override { return {times_.front(), times_.back()}; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const override;
  /// Bounds by the samples of the adjacent steps (ValueRanges).
  void ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
              std::span<ValueRange> found) const override;

 private:
  std::vector<IsosurfaceStep> steps_;
  std::vector<double> times_;
  LocalFrame frame_;
  double value_, slope_ = 1;
  VolumeDomain domain_;
  std::vector<std::unique_ptr<const ValueRanges>> ranges_;
};

}  // namespace sansmesh::inline v1
