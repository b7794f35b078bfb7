#include "sansmesh/field/scaled_volume.h"

#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/field/level_field.h"

namespace sansmesh::inline v1 {
namespace {

class ScaledLevels final : public ScaledVolume, public LevelField {
 public:
  using ScaledVolume::ScaledVolume;
  void evaluate_level(double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    dynamic_cast<const LevelField&>(field()).evaluate_level(level / factor(0), x, wanted);
    scale(wanted);
  }
};

}  // namespace

std::unique_ptr<VolumeField> ScaledVolume::of(std::shared_ptr<const VolumeField> field, std::vector<double> factors) {
  const bool levels = dynamic_cast<const LevelField*>(field.get()) != nullptr;
  if (levels) return std::make_unique<ScaledLevels>(std::move(field), std::move(factors));
  return std::make_unique<ScaledVolume>(std::move(field), std::move(factors));
}

ScaledVolume::ScaledVolume(std::shared_ptr<const VolumeField> field, std::vector<double> factors)
    : field_(std::move(field)), factors_(std::move(factors)) {
  if (factors_.size() != field_->components()) throw ArgumentError("`factors` needs one value per component");
}

void ScaledVolume::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  field_->evaluate(x, wanted);
  scale(wanted);
}

void ScaledVolume::scale(const VolumeFieldValues& wanted) const {
  const std::size_t n = factors_.size();
  parallel_for(0, wanted.values.size(), 1 << 14, [&](std::size_t i) { wanted.values[i] *= factors_[i % n]; });
  parallel_for(0, wanted.gradients.size(), 1 << 14, [&](std::size_t i) { wanted.gradients[i] *= factors_[i % n]; });
}

void ScaledVolume::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  field_->ranges(boxes, found);
  for (ValueRange& r : found) r = {r.least * factors_[0], r.most * factors_[0]};
}

}  // namespace sansmesh::inline v1
