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
  exponentiate(nullptr, x, wanted);
}

void ExponentialVolume::evaluate_level(double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  const double of_logarithm = level > 0 ? std::log(level / factor_) : 0;
  exponentiate(level > 0 ? &of_logarithm : nullptr, x, wanted);
}

/// level: of the logarithm; null without.
void ExponentialVolume::exponentiate(const double* level, std::span<const Vec3> x,
                                     const VolumeFieldValues& wanted) const {
  std::vector<double> own;
  VolumeFieldValues inner = wanted;
  if (wanted.values.empty() && !wanted.gradients.empty()) {
    own.resize(x.size());
    inner.values = own;
  }
  const auto* const levels = level ? dynamic_cast<const LevelField*>(field_.get()) : nullptr;
  levels ? levels->evaluate_level(*level, x, inner) : field_->evaluate(x, inner);
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
