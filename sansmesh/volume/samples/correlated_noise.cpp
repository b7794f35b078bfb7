#include "sansmesh/volume/samples/correlated_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/centre_fit.h"

namespace sansmesh::inline v1 {
namespace {

using Reach = std::array<std::size_t, 3>;

constexpr std::size_t kMostReach = 4;              // eddies of flows are larger
constexpr std::size_t kAlongAxis = 8000;           // residuals on segments along each axis
constexpr std::size_t kFewestSpaced = 1000;        // residuals below which nothing is said
constexpr std::size_t kFewestPairs = 200;          // the same of pairs at a distance
constexpr int kStencilRadius = 2, kInStencil = 5;  // steps, and their square, of neighbours from the centre
constexpr double kOpposite = -0.02;                // most correlation of independent residuals at `reach`
constexpr double kMostOpposite = -0.35;            // least
constexpr double kUnrelated = 0.2;                 // most beyond, up to four times as far
/// Exponent of the growth of residuals with the distance, between those measured: up to 0.33 of blurred noise, from
/// 0.42 of eddies of all sizes. The gap is narrow, and other structure may be below, so kMostOfData is asked as well.
constexpr double kGrowth = 0.36;
/// Deviation of noise over that of the data: up to the first it is noise beside a signal, from the second nothing shows
/// that it is not the signal.
constexpr double kBesideSignal = 0.35, kMostOfData = 0.5;
/// Normal deviates: range of the hundredths from both ends, in deviations.
constexpr double kMainRange = 4.653;
/// Shares of normal deviates beyond 2.5 (0.0124) and within 0.1 (0.0797), with a margin for varying noise.
constexpr double kTail = 2.5, kLeastTails = 0.003, kMostOfTails = 0.025;
constexpr double kCentre = 0.1, kLeastCentre = 0.055, kMostCentre = 0.105;

/// Consecutive samples of a lattice along an axis.
struct Segment {
  std::size_t axis = 0, first = 0, count = 0;  ///< `first`: number of its first residual
};

/// Residuals of samples on segments.
struct SpacedResiduals {
  std::size_t components = 1;
  std::vector<Segment> segments;
  std::vector<std::uint32_t> sample;
  std::vector<double> residual, predicted;  ///< all components of each; NaN beside steps and missing values
  std::vector<float> slope;                 ///< the same: squared norms of slopes, up to a factor
};

/// Predictions of samples from neighbours `reach` apart.
class SpacedStencil {
 public:
  SpacedStencil(const SampledVolume& volume, const VolumeValues& values, const std::vector<std::uint8_t>& filled,
                const Reach& reach)
      : values_(values), filled_(filled) {
    std::array<std::ptrdiff_t, 3> step{};
    std::ptrdiff_t all = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t n = volume.lattice->axes[k].size();
      size_[k] = n, step[k] = all * static_cast<std::ptrdiff_t>(reach[k]);
      margin_[k] = fits(n, reach[k]) ? kStencilRadius * reach[k] : 0;
      all *= static_cast<std::ptrdiff_t>(n);
    }
    const auto radius = [&](std::size_t k) { return margin_[k] > 0 ? kStencilRadius : 0; };
    std::vector<Vec3> u{{0, 0, 0}};
    std::vector<double> weights{0};
    for (int z = -radius(2); z <= radius(2); ++z)
      for (int y = -radius(1); y <= radius(1); ++y)
        for (int x = -radius(0); x <= radius(0); ++x) {
          const int square = x * x + y * y + z * z;
          if (square == 0 || square > kInStencil) continue;
          u.push_back(Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)} * 0.4);
          weights.push_back(1 - square / (kInStencil + 1.0));
          slopes_.push_back(u.back() * weights.back());
          offset_.push_back(x * step[0] + y * step[1] + z * step[2]);
        }
    CentreFit fit;
    fit.place(u);
    fit.weigh(weights);
    const auto l = fit.coefficients(2);
    double variance = 0, sum = 0;
    for (const double c : l) variance += c * c, sum += c;
    usable_ = !offset_.empty() && variance <= 3 && std::abs(sum - 1) < 1e-6;
    unit_ = 1 / std::sqrt(1 + variance);
    coefficients_.assign(l.begin() + 1, l.end());
  }

  /// True if an axis of `n` samples has room for neighbours `reach` apart.
  static bool fits(std::size_t n, std::size_t reach) { return n >= 2 * kStencilRadius * reach + kShortest; }
  /// True if neighbours along at least two axes predict a sample stably.
  bool usable() const { return usable_ && (reaches(0) + reaches(1) + reaches(2) >= 2); }
  /// True if there are neighbours along this axis.
  bool reaches(std::size_t axis) const { return margin_[axis] > 0; }
  std::size_t margin(std::size_t axis) const { return margin_[axis]; }
  /// Number of samples along an axis that have all neighbours.
  std::size_t inside(std::size_t axis) const { return size_[axis] - 2 * margin_[axis]; }
  std::size_t index(const std::array<std::size_t, 3>& i) const { return i[0] + size_[0] * (i[1] + size_[1] * i[2]); }

  void of(std::uint32_t sample, std::vector<double>& around, double* residuals, double* predicted, float* slope) const {
    const std::size_t c = values_.components;
    std::fill_n(residuals, c, std::numeric_limits<double>::quiet_NaN());
    std::fill_n(predicted, c, std::numeric_limits<double>::quiet_NaN());
    if (!filled_.empty()) {
      bool known = filled_[sample] == 0;
      for (const std::ptrdiff_t o : offset_) known = known && filled_[at(sample, o)] == 0;
      if (!known) return;
    }
    for (std::size_t m = 0; m < c; ++m) {
      const double own = values_.values[sample * c + m];
      double rise = 0;
      Vec3 ascent{};
      around.clear();
      for (std::size_t j = 0; j < offset_.size(); ++j) {
        around.push_back(values_.values[at(sample, offset_[j]) * c + m] - own);
        rise += coefficients_[j] * around.back(), ascent = ascent + slopes_[j] * around.back();
      }
      slope[m] = static_cast<float>(squared_norm(ascent));
      if (are_two_groups(around)) continue;
      residuals[m] = -rise * unit_, predicted[m] = own + rise;
    }
  }

 private:
  static constexpr std::size_t kShortest = 4;  // samples with all neighbours along an axis
  static std::size_t at(std::uint32_t sample, std::ptrdiff_t offset) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(sample) + offset);
  }

  const VolumeValues& values_;
  const std::vector<std::uint8_t>& filled_;
  std::array<std::size_t, 3> size_{}, margin_{};
  std::vector<std::ptrdiff_t> offset_;
  std::vector<double> coefficients_;
  std::vector<Vec3> slopes_;
  double unit_ = 1;
  bool usable_ = false;
};

/// Number of a sample by the fractions of its ranges.
std::size_t by_fraction(std::size_t count, double fraction) {
  return std::min(count - 1, static_cast<std::size_t>(fraction * static_cast<double>(count)));
}

class CorrelatedNoiseSearch {
 public:
  CorrelatedNoiseSearch(const SampledVolume& volume, const VolumeValues& values)
      : volume_(volume), values_(values), rounding_(rounding_of(values)) {
    filled_.resize(values.filled.empty() ? 0 : volume.size());
    for (const std::uint32_t i : values.filled) filled_[i] = 1;
  }

  /// `none` without correlated noise.
  SampleNoise find(SampleNoise none) {
    Reach reach{1, 1, 1};
    std::array<bool, 3> farthest{};  // axes that are too short for more
    while (*std::max_element(reach.begin(), reach.end()) <= kMostReach) {
      const std::optional<SpacedResiduals> residuals = look(reach);
      if (!residuals) return none;
      const std::vector<double> deviations = deviations_of(*residuals);
      Reach next = reach;
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto r = correlation(*residuals, deviations, k, reach[k]); r && *r > kOpposite && !farthest[k]) {
          farthest[k] = !SpacedStencil::fits(volume_.lattice->axes[k].size(), reach[k] + 1);
          if (!farthest[k]) ++next[k];
        }
      if (next == reach) {
        if (reach == Reach{1, 1, 1}) return none;
        for (std::size_t k = 0; k < 3; ++k)
          if (reach[k] > 1) ++next[k];
        if (does_not_grow(*residuals, reach, next)) {
          SampleNoise noise = noise_from(*residuals, reach, deviations);
          noise.found =
              are_normal(*residuals, noise) && end_at_reach(*residuals, noise) && is_above_quanta(*residuals, noise);
          const double use = use_beside_signal(*residuals, noise);
          for (double& t : noise.typical) t *= use;
          return noise.found && use > 0 ? noise : none;
        }
      }
      reach = next;
    }
    return none;
  }

 private:
  std::optional<SpacedResiduals> look(const Reach& reach) const {
    const SpacedStencil stencil(volume_, values_, filled_, reach);
    if (!stencil.usable()) return {};
    SpacedResiduals r;
    r.components = values_.components;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!stencil.reaches(k)) continue;
      std::size_t lines = 1;
      for (std::size_t a = 0; a < 3; ++a)
        if (a != k) lines *= stencil.inside(a);
      const std::size_t length = std::min(stencil.inside(k), 8 * reach[k] + 16);
      const std::size_t count = std::min(lines * (stencil.inside(k) / length), kAlongAxis / length);
      for (std::size_t j = 0; j < count; ++j) add_segment(stencil, k, length, j, r);
    }
    if (r.sample.size() < kFewestSpaced) return {};
    const std::size_t c = r.components;
    r.residual.resize(r.sample.size() * c), r.predicted.resize(r.sample.size() * c);
    r.slope.resize(r.sample.size() * c);
    parallel_ranges(0, r.sample.size(), 256, [&](std::size_t begin, std::size_t end) {
      std::vector<double> around;
      for (std::size_t i = begin; i < end; ++i)
        stencil.of(r.sample[i], around, &r.residual[i * c], &r.predicted[i * c], &r.slope[i * c]);
    });
    const auto known = std::count_if(r.residual.begin(), r.residual.end(), [&](double v) { return counts(v); });
    if (known < static_cast<std::ptrdiff_t>(kFewestSpaced)) return {};
    return r;
  }

  /// Adds the j-th of evenly distributed segments.
  static void add_segment(const SpacedStencil& stencil, std::size_t axis, std::size_t length, std::size_t j,
                          SpacedResiduals& r) {
    // The R₃ sequence, powers of the inverse of the root of x⁴ = x + 1, fills three dimensions evenly.
    constexpr std::array<double, 3> kShift{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    std::array<std::size_t, 3> i{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t range = stencil.inside(a) - (a == axis ? length - 1 : 0);
      i[a] = stencil.margin(a) + by_fraction(range, std::fmod(0.5 + static_cast<double>(j) * kShift[a], 1.0));
    }
    r.segments.push_back({axis, r.sample.size(), length});
    for (std::size_t s = 0; s < length; ++s, ++i[axis])
      r.sample.push_back(static_cast<std::uint32_t>(stencil.index(i)));
  }

  /// False for NaN, and in constant parts.
  bool counts(double residual) const { return std::abs(residual) > rounding_; }

  std::vector<double> deviations_of(const SpacedResiduals& r) const {
    std::vector<double> deviations;
    for (std::size_t m = 0; m < r.components; ++m) {
      std::vector<double> magnitudes;
      for (std::size_t i = m; i < r.residual.size(); i += r.components)
        if (counts(r.residual[i])) magnitudes.push_back(std::abs(r.residual[i]));
      deviations.push_back(magnitudes.size() < kFewestPairs ? 0 : trimmed_deviation(std::move(magnitudes)));
    }
    return deviations;
  }

  /// Correlation of residuals this far apart along an axis; none if there are too few.
  std::optional<double> correlation(const SpacedResiduals& r, const std::vector<double>& deviations, std::size_t axis,
                                    std::size_t distance) const {
    SignCorrelation signs;
    std::size_t pairs = 0;
    for (const Segment& s : r.segments) {
      if (s.axis != axis) continue;
      for (std::size_t i = 0; i + distance < s.count; ++i)
        for (std::size_t m = 0; m < r.components; ++m) {
          const double a = r.residual[(s.first + i) * r.components + m];
          const double b = r.residual[(s.first + i + distance) * r.components + m];
          if (counts(a) && counts(b)) signs.add(a, b, deviations[m], rounding_), ++pairs;
        }
    }
    if (pairs < kFewestPairs || !signs.known()) return {};
    return signs.mean();
  }

  SampleNoise noise_from(const SpacedResiduals& r, const Reach& reach, const std::vector<double>& deviations) const {
    SampleNoise noise;
    noise.typical = deviations, noise.by_value.resize(r.components), noise.reach = reach;
    std::vector<ComponentResiduals> components(r.components);
    for (std::size_t m = 0; m < r.components; ++m) {
      for (std::size_t i = 0; i < r.sample.size(); ++i) {
        const std::size_t at = i * r.components + m;
        components[m].residuals.push_back({r.predicted[at], r.residual[at], volume_.position(r.sample[i])});
      }
      for (const Segment& s : r.segments)
        for (std::size_t i = s.first; i + reach[s.axis] < s.first + s.count; ++i)
          components[m].pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + reach[s.axis])});
    }
    find_variation(components, volume_.bounds(), rounding_, noise);
    return noise;
  }

  /// True if the residuals, in deviations of the noise, have the shares of normal deviates.
  bool are_normal(const SpacedResiduals& r, const SampleNoise& noise) const {
    double all = 0, tails = 0, centre = 0;
    for (std::size_t i = 0; i < r.residual.size(); ++i) {
      if (!counts(r.residual[i])) continue;
      const std::size_t m = i % r.components;
      if (!(noise.typical[m] > 0)) continue;
      const Vec3 x = volume_.position(r.sample[i / r.components]);
      const double t = std::abs(r.residual[i]) / noise.at(m, r.predicted[i], x);
      ++all, tails += t > kTail, centre += t < kCentre;
    }
    return tails >= kLeastTails * all && tails <= kMostOfTails * all && centre >= kLeastCentre * all &&
           centre <= kMostCentre * all;
  }

  /// True if residuals are unrelated from `reach` on. Those of waves are not.
  bool end_at_reach(const SpacedResiduals& r, const SampleNoise& noise) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (const auto own = correlation(r, noise.typical, k, noise.reach[k]); own && *own < kMostOpposite) return false;
      for (std::size_t d = noise.reach[k] + 1; d <= 4 * noise.reach[k]; ++d)
        if (const auto other = correlation(r, noise.typical, k, d); other && std::abs(*other) > kUnrelated)
          return false;
    }
    return true;
  }

  /// True if residuals are hardly larger at greater distances: one step more or half as far again. Those of structure
  /// are at both, and those of curved parts at the greater.
  bool does_not_grow(const SpacedResiduals& r, const Reach& reach, const Reach& next) const {
    Reach farther = reach;
    for (std::size_t k = 0; k < 3; ++k)
      if (reach[k] > 1) farther[k] += (reach[k] + 1) / 2;
    return growth(r, reach, next) <= kGrowth || (farther != next && growth(r, reach, farther) <= kGrowth);
  }

  /// Exponent of the growth of residuals with the distance, in flat places or everywhere, whichever is less; infinite
  /// if it is not known.
  double growth(const SpacedResiduals& r, const Reach& reach, const Reach& other) const {
    double least = std::numeric_limits<double>::infinity();
    const std::optional<SpacedResiduals> far = look(other);
    if (!far) return least;
    const auto farthest = [](const Reach& of) { return static_cast<double>(*std::max_element(of.begin(), of.end())); };
    const double distances = std::log(farthest(other) / farthest(reach));
    for (const std::size_t part : {1, 3}) {
      const std::vector<double> a = flat_residuals(r, part), b = flat_residuals(*far, part);
      double logs = 0, known = 0;
      for (std::size_t m = 0; m < r.components; ++m)
        if (a[m] > 0 && b[m] > 0) logs += std::log(b[m] / a[m]), ++known;
      if (known > 0) least = std::min(least, logs / known / distances);
    }
    return least;
  }

  /// Median magnitude of the residuals of each component at the `part`-th part of the samples with the least slopes,
  /// where curved parts add less to those of noise. 0 if there are few.
  std::vector<double> flat_residuals(const SpacedResiduals& r, std::size_t part) const {
    std::vector<double> flat;
    for (std::size_t m = 0; m < r.components; ++m) {
      std::vector<std::pair<float, double>> all;
      for (std::size_t i = m; i < r.residual.size(); i += r.components)
        if (counts(r.residual[i])) all.emplace_back(r.slope[i], std::abs(r.residual[i]));
      std::sort(all.begin(), all.end());
      std::vector<double> magnitudes;
      magnitudes.reserve(all.size() / part);
      for (std::size_t i = 0; i < all.size() / part; ++i) magnitudes.push_back(all[i].second);
      flat.push_back(magnitudes.size() < kFewestPairs ? 0 : median(magnitudes));
    }
    return flat;
  }

  /// The share of the deviation that counts as noise, 0 to 1: structure whose residuals pass for noise has little else.
  /// Data deviate by their standard deviation, or as normal deviates of their main range, which small bodies in wide
  /// surroundings widen.
  double use_beside_signal(const SpacedResiduals& r, const SampleNoise& noise) const {
    double of_noise = 0, of_data = 0;
    for (std::size_t m = 0; m < r.components; ++m) {
      std::vector<double> own;
      own.reserve(r.sample.size());
      for (const std::uint32_t i : r.sample)
        if (filled_.empty() || filled_[i] == 0) own.push_back(values_.values[i * r.components + m]);
      double mean = 0, variance = 0;
      for (const double v : own) mean += v / static_cast<double>(own.size());
      for (const double v : own) variance += (v - mean) * (v - mean) / static_cast<double>(own.size());
      const double lower = quantile(own, 0.01), range = (quantile(own, 0.99) - lower) / kMainRange;
      of_noise += noise.typical[m] * noise.typical[m], of_data += std::max(variance, range * range);
    }
    if (!(of_data > 0)) return 0;
    return std::clamp((kMostOfData - std::sqrt(of_noise / of_data)) / (kMostOfData - kBesideSignal), 0.0, 1.0);
  }

  bool is_above_quanta(const SpacedResiduals& r, const SampleNoise& noise) const {
    for (std::size_t m = 0; m < r.components; ++m) {
      std::vector<double> own;
      own.reserve(r.sample.size());
      for (const std::uint32_t i : r.sample) own.push_back(values_.values[i * r.components + m]);
      if (is_above_rounding(noise.typical[m], std::move(own))) return true;
    }
    return false;
  }

  const SampledVolume& volume_;
  const VolumeValues& values_;
  std::vector<std::uint8_t> filled_;
  double rounding_;
};

}  // namespace

SampleNoise estimate_correlated_noise(const SampledVolume& volume, const VolumeValues& values, Progress& progress) {
  SampleNoise none;
  none.typical.assign(values.components, 0.0), none.by_value.resize(values.components);
  if (!volume.lattice) return none;
  progress.begin("look at correlated noise");
  return CorrelatedNoiseSearch(volume, values).find(std::move(none));
}

}  // namespace sansmesh::inline v1
