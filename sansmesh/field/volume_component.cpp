#include "sansmesh/field/volume_component.h"

#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"

namespace sansmesh {

VolumeComponent::VolumeComponent(std::shared_ptr<const VolumeField> field, std::optional<std::size_t> component)
    : field_(std::move(field)), component_(component) {}

void VolumeComponent::evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const {
  const std::size_t n = field_->components();
  std::vector<double> values(n * x.size());
  std::vector<Vec3> gradients(wanted.gradients.empty() ? 0 : n * x.size());
  field_->evaluate(x, {values, gradients, wanted.inside, wanted.degrees});
  parallel_for(0, x.size(), 4096, [&](std::size_t i) {
    const std::span<const double> v = std::span<const double>(values).subspan(i * n, n);
    double value = 0;
    if (component_) {
      value = v[*component_];
    } else {
      for (const double c : v) value += c * c;
      value = std::sqrt(value);
    }
    if (!wanted.values.empty()) wanted.values[i] = value;
    if (gradients.empty()) return;
    Vec3& g = wanted.gradients[i];
    g = {};
    if (component_) {
      g = gradients[i * n + *component_];
    } else if (value > 0) {
      for (std::size_t c = 0; c < n; ++c) g += gradients[i * n + c] * (v[c] / value);
    }
  });
}

}  // namespace sansmesh
