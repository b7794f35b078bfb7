#include "sansmesh/field/scaled_volume.h"

#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

ScaledVolume::ScaledVolume(std::shared_ptr<const VolumeField> field, std::vector<double> factors)
    : field_(std::move(field)), factors_(std::move(factors)) {
  if (factors_.size() != field_->components()) throw ArgumentError("`factors` needs one value per component");
}

void ScaledVolume::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  field_->evaluate(x, wanted);
  const std::size_t n = factors_.size();
  parallel_for(0, wanted.values.size(), 1 << 14, [&](std::size_t i) { wanted.values[i] *= factors_[i % n]; });
  parallel_for(0, wanted.gradients.size(), 1 << 14, [&](std::size_t i) { wanted.gradients[i] *= factors_[i % n]; });
}

void ScaledVolume::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  field_->ranges(boxes, found);
  for (ValueRange& r : found) r = {r.least * factors_[0], r.most * factors_[0]};
}

}  // namespace sansmesh::inline v1
