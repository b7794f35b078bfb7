#include "sansmesh/volume/methods/support_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/field/level_field.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/kernels/support_kernels.h"
#include "sansmesh/volume/methods/cell_interpolant.h"
#include "sansmesh/volume/methods/front_share.h"
#include "sansmesh/volume/methods/grouped_field.h"
#include "sansmesh/volume/methods/linear_share.h"
#include "sansmesh/volume/samples/support_index.h"

namespace sansmesh::inline v1 {
namespace {

using detail::SupportTerm;
using detail::SupportTile;

constexpr float kNoSupport = 1e-20f;

/// Bounds of the polynomials: the values of the star, and for samples in cells of linear interpolation at the corners,
/// widened on both sides by a quarter of their difference, with full trust by one and a half times; not negative
/// (positive) if no sample is, unless values are logarithms.
class PolynomialBounds {
 public:
  PolynomialBounds() = default;
  PolynomialBounds(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& polynomials,
                   const CellInterpolant* corners, bool logarithm)
      : components_(values.components) {
    const std::size_t n = volume.size(), c = components_;
    bounds_.resize(n * c);
    const Adjacency cells = cells_of_samples(volume);
    std::vector<std::array<double, 2>> all(
        c, {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t m = 0; m < c; ++m) {
        const double v = values.values[i * c + m];
        all[m] = {std::min(all[m][0], v), std::max(all[m][1], v)};
      }
    parallel_for(0, n, 1024, [&](std::size_t i) {
      for (std::size_t m = 0; m < c; ++m) {
        double least = values.values[i * c + m], most = least;
        const auto take = [&](double v) { least = std::min(least, v), most = std::max(most, v); };
        for (const std::uint32_t j : volume.stars[i]) take(values.values[j * c + m]);
        for (const std::uint32_t cell : cells[i])
          for (const std::uint32_t k : volume.cells[cell])
            take(corners ? corners->at_corner(k, m) : values.values[k * c + m]);
        const auto trust = static_cast<double>(polynomials.trust[i]);
        const double beyond = (kBeyondStar + kBeyondTrusted * trust * trust) * (most - least);
        least -= beyond, most += beyond;
        bounds_[i * c + m] = {least, most};
        if (logarithm) continue;
        if (all[m][0] >= 0) least = std::max(least, 0.0);
        if (all[m][1] <= 0) most = std::min(most, 0.0);
        bounds_[i * c + m] = {least, most};
      }
    });
  }

  void set(std::size_t sample, std::size_t component, double base, SupportTerm& term) const {
    const auto& b = bounds_[sample * components_ + component];
    term.least = static_cast<float>(b[0] - base), term.most = static_cast<float>(b[1] - base);
  }

 private:
  static constexpr double kBeyondStar = 0.25, kBeyondTrusted = 1.25;

  std::size_t components_ = 1;
  std::vector<std::array<double, 2>> bounds_;  // per sample and component
};

class SupportBlend final : public GroupedField, public LevelField {
 public:
  SupportBlend(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
               LocalPolynomials polynomials, SharedArray<float> radii, const VolumeValues& values, bool logarithm,
               CellFronts fronts, std::optional<SmoothShare> smooth)
      : GroupedField(std::move(volume), std::move(locator), polynomials.components),
        polynomials_(std::move(polynomials)),
        radii_(std::move(radii)),
        smooth_(std::move(smooth)) {
    index_ = SupportIndex(this->volume(), polynomials_.metrics.view(), radii_.view());
    if (!this->volume().lattice) linear_.emplace(this->volume(), values, polynomials_, smooth_.has_value());
    bounds_ =
        PolynomialBounds(this->volume(), values, polynomials_, linear_ ? linear_->interpolant() : nullptr, logarithm);
    if (!fronts.fronts.empty()) fronts_.emplace(this->volume(), polynomials_, radii_, std::move(fronts));
  }

  void evaluate_level(double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    evaluate_all(x, {wanted.values, wanted.gradients, wanted.inside, {}, &level});
  }

 private:
  struct Lists final : Memory {
    FrontShare::Memory fronts;
    std::vector<double> blended;  // one component: values and gradients
    std::vector<Vec3> blended_slopes;
    SupportTile tile;
    SupportIndex::Memory found;
    Vec3 origin;
    std::vector<SupportTerm> terms;
    std::vector<float> coefficients;
    std::vector<double> flat;  // linear interpolation: components and the share, point by point
    std::vector<Vec3> slopes;
    std::unique_ptr<Memory> part;  // buffers for the smooth approximation
    SupportTile all, limit;  // weights of all supports, where some are doubtful; bounds of the smooth approximation
    std::vector<double> smooth, least, most;
    std::vector<Vec3> smooth_slopes, least_slopes, most_slopes;
  };

  std::unique_ptr<Memory> memory() const override {
    auto lists = std::make_unique<Lists>();
    if (smooth_) lists->part = memory_of(smooth_->field());
    return lists;
  }
  bool goes_on_straight() const override { return true; }

  void evaluate_group(const Group& group, Memory& memory, const PolynomialValues& wanted) const override {
    static_assert(SupportTile::kTile == kMostPoints);
    Lists& lists = static_cast<Lists&>(memory);
    SupportTile& tile = lists.tile;
    const std::size_t n = group.size, c = components();
    const bool gradient = !wanted.gradients.empty();
    // All of this depends on the cell alone, so that results do not depend on the other points in the cell.
    const Vec3 origin = index_.of_cell(group.cell, lists.found);
    lists.origin = origin;
    const std::vector<std::uint32_t>& supports = lists.found.supports;
    const std::uint32_t own = lists.found.own;

    constexpr std::size_t kRow = 16;
    const std::size_t filled = (n + kRow - 1) / kRow * kRow;
    for (std::size_t i = 0; i < filled; ++i) {
      const Vec3 d = group.x[std::min(i, n - 1)] - origin;
      for (std::size_t k = 0; k < 3; ++k) tile.x[k][i] = static_cast<float>(d[k]);
    }
    const bool shared = linear_ && linear_->has(group.cell.cell);
    if (shared) {
      lists.flat.resize(n * (c + 1)), lists.slopes.resize(gradient ? n * (c + 1) : 0);
      for (std::size_t i = 0; i < n; ++i)
        linear_->evaluate(*group.locations[i], group.x[i], std::span(lists.flat).subspan(i * (c + 1), c + 1),
                          gradient ? std::span(lists.slopes).subspan(i * (c + 1), c + 1) : std::span<Vec3>());
    }
    const bool doubtful = smooth_ && smooth_->any(supports);
    if (doubtful) evaluate_smooth(group, filled, gradient, lists);
    const bool front = fronts_ && fronts_->any(supports);
    const auto slots = static_cast<std::size_t>(monomial_count(3, LocalPolynomials::kMaxDegree) - 1);
    lists.terms.resize(supports.size());
    for (std::size_t m = 0; m < c; ++m) {
      const double base = polynomials_.constants[own * c + m];
      if (doubtful) limit_smooth(m, base, filled, gradient, lists);
      lists.coefficients.resize(supports.size() * slots);
      for (std::size_t s = 0; s < supports.size(); ++s) {
        const std::size_t i = supports[s];
        SupportTerm& term = lists.terms[s];
        set_support(i, lists, term);
        term.degree = polynomials_.degrees[i];
        term.scale = doubtful ? 1 - smooth_->doubt(i) : 1.0f;
        bounds_.set(i, m, base, term);
        term.constant = static_cast<float>(polynomials_.constants[i * c + m] - base);
        const auto of = polynomials_.of(i, m);
        term.coefficients = of.data();
        if (const float trust = trust_of(i); trust < 1 && of.size() > 3) {
          float* scaled = lists.coefficients.data() + s * slots;
          for (std::size_t j = 0; j < of.size(); ++j) scaled[j] = j < 3 ? of[j] : trust * of[j];
          term.coefficients = scaled;
        }
      }
      detail::sum_supports(lists.terms.data(), lists.terms.size(), filled, gradient, tile);
      blend_points(n, m, base, {gradient, shared, doubtful}, lists);
      if (front)
        fronts_->apply(supports, {origin, base, wanted.level, n, gradient}, doubtful ? lists.all : tile, lists.blended,
                       lists.blended_slopes, lists.fronts);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t to = group.to[i] * c + m;
        if (!wanted.values.empty()) wanted.values[to] = base + lists.blended[i];
        if (gradient) wanted.gradients[to] = lists.blended_slopes[i];
      }
    }
    if (wanted.degrees.empty()) return;
    for (std::size_t i = 0; i < n; ++i) wanted.degrees[group.to[i]] = polynomials_.degrees[own];
  }

  struct Parts {
    bool gradient, shared, doubtful;  ///< whether gradients are wanted; linear interpolation, smooth approximation
  };

  /// The blend of a component, relative to the base, from the sums of all supports.
  void blend_points(std::size_t n, std::size_t component, double base, const Parts& has, Lists& lists) const {
    const std::size_t c = components();
    const SupportTile &tile = lists.tile, &whole = has.doubtful ? lists.all : lists.tile;
    lists.blended.resize(n), lists.blended_slopes.resize(has.gradient ? n : 0);
    for (std::size_t i = 0; i < n; ++i) {
      const float divisor = whole.weight[i];
      lists.blended[i] = 0;
      if (has.gradient) lists.blended_slopes[i] = {};
      if (!(divisor > kNoSupport)) continue;
      Smoothed by;
      if (has.doubtful) by = smooth_at(lists, i, i * c + component, base, has.gradient);
      const float value = tile.value[i] / divisor;
      const double fitted = static_cast<double>(value) + by.doubt * by.value;
      const double* flat = has.shared ? lists.flat.data() + i * (c + 1) : nullptr;
      const double more = has.shared ? flat[component] - base - fitted : 0;
      lists.blended[i] = has.shared ? fitted + flat[c] * more : fitted;
      if (!has.gradient) continue;
      Vec3 g;
      for (std::size_t k = 0; k < 3; ++k)
        g[k] = static_cast<double>((tile.value_slope[k][i] - value * whole.weight_slope[k][i]) / divisor);
      if (has.doubtful) g = g + by.slope * by.doubt + by.doubt_slope * by.value;
      if (has.shared) {
        const Vec3* flat_slopes = lists.slopes.data() + i * (c + 1);
        g = g + (flat_slopes[component] - g) * flat[c] + flat_slopes[c] * more;
      }
      lists.blended_slopes[i] = g;
    }
  }

  // The smooth approximation at a point, relative to the base, and its share.
  struct Smoothed {
    double value = 0, doubt = 0;
    Vec3 slope, doubt_slope;
  };

  void evaluate_smooth(const Group& group, std::size_t filled, bool gradient, Lists& lists) const {
    const std::size_t n = group.size, c = components();
    lists.terms.resize(lists.found.supports.size());
    for (std::size_t s = 0; s < lists.terms.size(); ++s) {
      const std::size_t i = lists.found.supports[s];
      set_support(i, lists, lists.terms[s]);
      lists.terms[s].constant = smooth_->doubt(i);
    }
    for (std::size_t k = 0; k < 3; ++k)
      std::copy_n(lists.tile.x[k], filled, lists.all.x[k]), std::copy_n(lists.tile.x[k], filled, lists.limit.x[k]);
    detail::sum_supports(lists.terms.data(), lists.terms.size(), filled, gradient, lists.all);
    lists.smooth.resize(n * c), lists.smooth_slopes.resize(gradient ? n * c : 0);
    Group part = group;
    for (std::size_t i = 0; i < n; ++i) part.to[i] = static_cast<std::uint32_t>(i);
    evaluate_part(smooth_->field(), part, *lists.part, {lists.smooth, lists.smooth_slopes, {}, {}});
  }

  // Means of the bounds of the doubtful polynomials, relative to the base.
  void limit_smooth(std::size_t component, double base, std::size_t filled, bool gradient, Lists& lists) const {
    lists.terms.resize(lists.found.supports.size());
    for (const bool upper : {false, true}) {
      for (std::size_t s = 0; s < lists.terms.size(); ++s) {
        const std::size_t i = lists.found.supports[s];
        SupportTerm& term = lists.terms[s];
        if (!upper) set_support(i, lists, term);
        SupportTerm bounds;
        bounds_.set(i, component, base, bounds);
        term.scale = smooth_->doubt(i);
        term.constant = upper ? bounds.most : bounds.least;
      }
      const SupportTile& sums = lists.limit;
      detail::sum_supports(lists.terms.data(), lists.terms.size(), filled, gradient, lists.limit);
      std::vector<double>& to = upper ? lists.most : lists.least;
      std::vector<Vec3>& slopes = upper ? lists.most_slopes : lists.least_slopes;
      to.assign(filled, 0), slopes.assign(gradient ? filled : 0, {});
      for (std::size_t i = 0; i < filled; ++i) {
        const float weight = sums.weight[i], bound = sums.value[i] / weight;
        if (!(weight > kNoSupport)) continue;
        to[i] = static_cast<double>(bound);
        for (std::size_t k = 0; gradient && k < 3; ++k)
          slopes[i][k] = static_cast<double>((sums.value_slope[k][i] - bound * sums.weight_slope[k][i]) / weight);
      }
    }
  }

  void set_support(std::size_t sample, const Lists& lists, SupportTerm& term) const {
    term = {};
    term.center = Vec3f(volume().position(sample) - lists.origin);
    term.metric = polynomials_.metric(volume(), sample);
    term.inverse_square = 1 / (radii_[sample] * radii_[sample]);
  }

  static Smoothed smooth_at(const Lists& lists, std::size_t point, std::size_t entry, double base, bool gradient) {
    Smoothed t;
    const float divisor = lists.all.weight[point], doubt = lists.all.value[point] / divisor;
    t.doubt = static_cast<double>(doubt);
    const double value = lists.smooth[entry] - base;
    t.value = std::min(std::max(value, lists.least[point]), lists.most[point]);
    if (!gradient) return t;
    t.slope = t.value < value   ? lists.most_slopes[point]
              : t.value > value ? lists.least_slopes[point]
                                : lists.smooth_slopes[entry];
    for (std::size_t k = 0; k < 3; ++k)
      t.doubt_slope[k] =
          static_cast<double>((lists.all.value_slope[k][point] - doubt * lists.all.weight_slope[k][point]) / divisor);
    return t;
  }

  // Factor of the terms of degree 2 and more. Planes of samples at corners would be worse than linear interpolation,
  // whose share replaces their trust.
  float trust_of(std::size_t sample) const { return volume().cell_sample.empty() ? 1.0f : polynomials_.trust[sample]; }

  LocalPolynomials polynomials_;
  SharedArray<float> radii_;
  SupportIndex index_;
  std::optional<LinearShare> linear_;
  PolynomialBounds bounds_;
  std::optional<FrontShare> fronts_;
  std::optional<SmoothShare> smooth_;
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
                                                LocalPolynomials polynomials, SharedArray<float> radii,
                                                const VolumeValues& values, bool logarithm, CellFronts fronts,
                                                std::optional<SmoothShare> smooth) {
  return std::make_unique<SupportBlend>(std::move(volume), std::move(locator), std::move(polynomials), std::move(radii),
                                        values, logarithm, std::move(fronts), std::move(smooth));
}

}  // namespace sansmesh::inline v1
