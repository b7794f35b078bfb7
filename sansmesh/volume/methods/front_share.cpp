#include "sansmesh/volume/methods/front_share.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

/// Share of the weights from which a front counts alone.
constexpr double kWholeShare = 0.1;
constexpr float kNoFront = 1e-20f;

/// A value with its gradient.
struct Ramp {
  double value = 0;
  Vec3 slope;
};
Ramp operator*(const Ramp& a, const Ramp& b) { return {a.value * b.value, a.slope * b.value + b.slope * a.value}; }
Ramp operator-(const Ramp& a, const Ramp& b) { return {a.value - b.value, a.slope - b.slope}; }
Ramp operator+(const Ramp& a, const Ramp& b) { return {a.value + b.value, a.slope + b.slope}; }
Ramp operator/(const Ramp& a, const Ramp& b) {
  const double q = a.value / b.value;
  return {q, (a.slope - b.slope * q) / b.value};
}

/// The share of the step at a level; 0 where it is (almost) outside of the step.
double level_share(double level, const Ramp& low, const Ramp& high) {
  constexpr double kLeastShareOfStep = 0.02;
  const double share = (level - low.value) / (high.value - low.value);
  return share > kLeastShareOfStep && share < 1 - kLeastShareOfStep ? share : 0;
}

/// ½ (1 + tanh(s)), or for a share in (0, 1) the tangent of this function where it has the share.
Ramp step_of(const Ramp& at, double share) {
  if (share > 0) {
    const double slope = 2 * share * (1 - share);
    return {share + slope * (at.value - std::atanh(2 * share - 1)), at.slope * slope};
  }
  const double tanh = std::tanh(at.value);
  return {0.5 * (1 + tanh), at.slope * (0.5 * (1 - tanh * tanh))};
}

enum Quantity : std::size_t { kWeight, kDistance, kLow, kHigh, kWidth, kQuantities };

}  // namespace

bool FrontShare::any(std::span<const std::uint32_t> supports) const {
  return std::any_of(supports.begin(), supports.end(),
                     [&](std::uint32_t i) { return fronts_.of[i] != CellFronts::kNone; });
}

void FrontShare::apply(std::span<const std::uint32_t> supports, const Request& request, const detail::SupportTile& all,
                       std::span<double> values, std::span<Vec3> gradients, Memory& memory) const {
  const auto& [origin, base, level, n, gradient] = request;
  std::vector<std::uint32_t>& with = memory.with;
  memory.terms.clear(), with.clear();
  for (const std::uint32_t i : supports) {
    if (fronts_.of[i] == CellFronts::kNone) continue;
    with.push_back(i);
    detail::SupportTerm term;
    term.center = Vec3f(volume_.position(i) - origin);
    term.metric = polynomials_.metric(volume_, i);
    term.inverse_square = 1 / (radii_[i] * radii_[i]);
    term.scale = fronts_.fronts[fronts_.of[i]].trust;
    memory.terms.push_back(term);
  }
  constexpr std::size_t kLine = 16, kNumbers = 4;  // points per row of the kernel; a value with its gradient
  const std::size_t filled = (n + kLine - 1) / kLine * kLine;
  memory.sums.resize(kQuantities * kNumbers * n);
  for (std::size_t k = 0; k < 3; ++k) std::copy_n(all.x[k], filled, memory.tile.x[k]);
  const auto sum = [&](std::size_t quantity, std::size_t point) {
    const float* s = memory.sums.data() + (quantity * n + point) * kNumbers;
    return Ramp{static_cast<double>(s[0]), Vec3(Vec3f{s[1], s[2], s[3]})};
  };
  for (std::size_t quantity = kDistance; quantity < kQuantities; ++quantity) {
    for (std::size_t t = 0; t < with.size(); ++t) {
      const CellFront& front = fronts_.fronts[fronts_.of[with[t]]];
      detail::SupportTerm& term = memory.terms[t];
      term.degree = quantity == kDistance ? 2 : 0;
      term.coefficients = quantity == kDistance ? front.g.data() : nullptr;
      term.constant = quantity == kDistance ? front.constant
                      : quantity == kLow    ? static_cast<float>(front.low - base)
                      : quantity == kHigh   ? static_cast<float>(front.high - base)
                                            : front.width;
    }
    detail::sum_supports(memory.terms.data(), memory.terms.size(), filled, gradient, memory.tile);
    for (std::size_t i = 0; i < n; ++i) {
      float* to = memory.sums.data() + (quantity * n + i) * kNumbers;
      float* weight = memory.sums.data() + (kWeight * n + i) * kNumbers;
      to[0] = memory.tile.value[i], weight[0] = memory.tile.weight[i];
      for (std::size_t k = 0; gradient && k < 3; ++k)
        to[k + 1] = memory.tile.value_slope[k][i], weight[k + 1] = memory.tile.weight_slope[k][i];
      if (!gradient) std::fill_n(to + 1, 3, 0.0f), std::fill_n(weight + 1, 3, 0.0f);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Ramp weight = sum(kWeight, i);
    if (!(weight.value > static_cast<double>(kNoFront)) || !(all.weight[i] > kNoFront)) continue;
    Ramp total{static_cast<double>(all.weight[i]), {}};
    if (gradient) total.slope = Vec3(Vec3f{all.weight_slope[0][i], all.weight_slope[1][i], all.weight_slope[2][i]});
    Ramp share = weight / total;
    share.value /= kWholeShare, share.slope = share.slope / kWholeShare;
    if (share.value >= 1) share = {1, {}};
    share = {share.value * share.value * (3 - 2 * share.value), share.slope * (6 * share.value * (1 - share.value))};
    const Ramp low = sum(kLow, i) / weight, high = sum(kHigh, i) / weight;
    const Ramp at = sum(kDistance, i) / sum(kWidth, i);
    const Ramp front = low + (high - low) * step_of(at, level ? level_share(*level - base, low, high) : 0);
    Ramp blend{values[i], gradient ? gradients[i] : Vec3{}};
    blend = blend + share * (front - blend);
    values[i] = blend.value;
    if (gradient) gradients[i] = blend.slope;
  }
}

}  // namespace sansmesh::inline v1
