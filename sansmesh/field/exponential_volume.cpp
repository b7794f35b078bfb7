#include "sansmesh/field/exponential_volume.h"

#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

ExponentialVolume::ExponentialVolume(std::shared_ptr<const VolumeField> logarithm, double factor)
    : field_(std::move(logarithm)), factor_(factor) {
  if (field_->components() != 1) throw ArgumentError("a logarithm has one component");
}

void ExponentialVolume::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  std::vector<double> own;
  VolumeFieldValues inner = wanted;
  if (wanted.values.empty() && !wanted.gradients.empty()) {
    own.resize(x.size());
    inner.values = own;
  }
  field_->evaluate(x, inner);
  parallel_for(0, inner.values.size(), 1 << 12, [&](std::size_t i) {
    const double value = std::exp(inner.values[i]) * factor_;
    inner.values[i] = value;
    if (!wanted.gradients.empty()) wanted.gradients[i] *= value;
  });
}

void ExponentialVolume::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  field_->ranges(boxes, found);
  for (ValueRange& r : found) r = {std::exp(r.least) * factor_, std::exp(r.most) * factor_};
}

}  // namespace sansmesh::inline v1
