// Where a quantity of a volume that changes in time has one value: as a field in space and time.
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

/// A moment at which a volume is known.
struct IsosurfaceStep {
  double time = 0;
  std::shared_ptr<const SampledVolume> volume;
  std::shared_ptr<const VolumeField> field;         ///< of one component
  std::function<double(std::size_t)> sample_value;  ///< of sample i, asked for when the field is made
};

/// {f(x, t) = value}, f linear in time between the steps: negative where f is larger, in coordinates of its own
/// (`place`), scaled so that its gradient in space has norm 1 about the surface (on the median). Grids may differ from
/// step to step; the volume is that of the first, and nothing outside of it is inside the surface. All steps are kept.
class IsosurfaceInTime final : public TimeField {
 public:
  /// Throws ArgumentError unless there are two steps at least, their times increase and all fields have one component;
  /// DataError where the value does not occur at any step.
  IsosurfaceInTime(std::vector<IsosurfaceStep> steps, double value);
  ~IsosurfaceInTime() override;

  const LocalFrame& frame() const { return frame_; }
  double value() const { return value_; }
  double median_spacing() const;  ///< distance between samples of the first step on the median (own length)
  double shortest_step() const;   ///< least time between two steps

  Box3 bounds() const override { return domain_.bounds(); }
  TimeRange times() const override { return {steps_.front().time, steps_.back().time}; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const override;
  /// From the samples of the steps around (ValueRanges).
  void ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
              std::span<ValueRange> found) const override;

 private:
  std::size_t interval_of(double t) const;

  std::vector<IsosurfaceStep> steps_;
  LocalFrame frame_;
  double value_, slope_ = 1;
  VolumeDomain domain_;
  std::vector<std::unique_ptr<const ValueRanges>> ranges_;
};

}  // namespace sansmesh::inline v1
