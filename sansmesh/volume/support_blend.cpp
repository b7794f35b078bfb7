#include "sansmesh/volume/support_blend.h"
#include "sansmesh/volume/cell_adjacency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/grouped_field.h"
#include "sansmesh/volume/support_index.h"
#include "sansmesh/volume/support_kernels.h"

namespace sansmesh {
namespace {

using detail::SupportTerm;
using detail::SupportTile;

constexpr float kNoSupport = 1e-20f;

class SupportBlend final : public GroupedField {
 public:
  SupportBlend(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
               LocalPolynomials polynomials, SharedArray<float> radii)
      : GroupedField(std::move(volume), std::move(locator), polynomials.components),
        polynomials_(std::move(polynomials)),
        radii_(std::move(radii)) {
    index_ = SupportIndex(this->volume(), polynomials_.metrics.view(), radii_.view());
  }

 private:
  struct Lists final : Memory {
    SupportTile tile;
    SupportIndex::Memory found;
    std::vector<SupportTerm> terms;
    std::vector<float> coefficients;
  };

  std::unique_ptr<Memory> memory() const override { return std::make_unique<Lists>(); }
  bool goes_on_straight() const override { return true; }

  void answer(const Group& group, Memory& memory, const VolumeAnswers& wanted) const override {
    static_assert(SupportTile::kTile == kMostPoints);
    Lists& lists = static_cast<Lists&>(memory);
    SupportTile& tile = lists.tile;
    const std::size_t n = group.size, c = components();
    const bool gradient = !wanted.gradients.empty();
    // All of this depends on the cell alone, so that answers do not depend on the points that share it.
    const Vec3 origin = index_.of_cell(group.cell, lists.found);
    const std::vector<std::uint32_t>& supports = lists.found.supports;
    const std::uint32_t own = lists.found.own;

    constexpr std::size_t kRow = 16;
    const std::size_t filled = (n + kRow - 1) / kRow * kRow;
    for (std::size_t i = 0; i < filled; ++i) {
      const Vec3 d = group.x[std::min(i, n - 1)] - origin;
      for (std::size_t k = 0; k < 3; ++k) tile.x[k][i] = static_cast<float>(d[k]);
    }
    const auto slots = static_cast<std::size_t>(monomial_count(3, LocalPolynomials::kMaxDegree) - 1);
    lists.terms.resize(supports.size());
    for (std::size_t m = 0; m < c; ++m) {
      const double base = polynomials_.constants[own * c + m];
      lists.coefficients.resize(supports.size() * slots);
      for (std::size_t s = 0; s < supports.size(); ++s) {
        const std::size_t i = supports[s];
        SupportTerm& term = lists.terms[s];
        term.center = Vec3f(volume().position(i) - origin);
        term.metric = polynomials_.metric(volume(), i);
        term.inverse_square = 1 / (radii_[i] * radii_[i]);
        term.degree = polynomials_.degrees[i];
        term.constant = static_cast<float>(polynomials_.constants[i * c + m] - base);
        const auto of = polynomials_.of(i, m);
        term.coefficients = of.data();
        if (const float trust = polynomials_.trust[i]; trust < 1 && of.size() > 3) {
          float* scaled = lists.coefficients.data() + s * slots;
          for (std::size_t j = 0; j < of.size(); ++j) scaled[j] = j < 3 ? of[j] : trust * of[j];
          term.coefficients = scaled;
        }
      }
      detail::sum_supports(lists.terms.data(), lists.terms.size(), filled, gradient, tile);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t to = group.to[i] * c + m;
        const float divisor = tile.weight[i];
        if (!(divisor > kNoSupport)) {
          if (!wanted.values.empty()) wanted.values[to] = base;
          if (gradient) wanted.gradients[to] = {};
          continue;
        }
        const float value = tile.value[i] / divisor;
        if (!wanted.values.empty()) wanted.values[to] = base + static_cast<double>(value);
        if (!gradient) continue;
        Vec3 g;
        for (std::size_t k = 0; k < 3; ++k)
          g[k] = static_cast<double>((tile.value_slope[k][i] - value * tile.weight_slope[k][i]) / divisor);
        wanted.gradients[to] = g;
      }
    }
    if (wanted.degrees.empty()) return;
    for (std::size_t i = 0; i < n; ++i) wanted.degrees[group.to[i]] = polynomials_.degrees[own];
  }

  LocalPolynomials polynomials_;
  SharedArray<float> radii_;
  SupportIndex index_;
};

}  // namespace

std::vector<float> support_radii(const SampledVolume& volume, const LocalPolynomials& polynomials, double reach) {
  std::vector<float> radii(volume.size(), static_cast<float>(1.05 * reach));
  if (volume.lattice) {
    std::fill(radii.begin(), radii.end(), static_cast<float>(std::sqrt(3.0) * 1.05 * reach));
    return radii;
  }
  const Adjacency cells = cells_of_samples(volume);
  parallel_for(0, radii.size(), 1024, [&](std::size_t i) {
    const StarMetric metric = polynomials.metric(volume, i);
    double farthest = 0;
    for (const std::uint32_t cell : cells[i])
      for (const std::uint32_t k : volume.cells[cell])
        farthest = std::max(farthest, norm(metric(volume.corner(k) - volume.positions[i])));
    const double least = volume.cell_sample.empty() ? 1.05 * farthest : farthest / 0.7;
    radii[i] = std::max(radii[i], static_cast<float>(reach * least));
  });
  return radii;
}

std::unique_ptr<VolumeField> make_support_blend(std::shared_ptr<const SampledVolume> volume,
                                                std::shared_ptr<const VolumeLocator> locator,
                                                LocalPolynomials polynomials, SharedArray<float> radii) {
  return std::make_unique<SupportBlend>(std::move(volume), std::move(locator), std::move(polynomials),
                                        std::move(radii));
}

}  // namespace sansmesh
