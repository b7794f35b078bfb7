#include "sansmesh/volume/samples/smooth_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/centre_fit.h"
#include "sansmesh/volume/samples/near_samples.h"

namespace sansmesh::inline v1 {
namespace {

/// Neighbours of the three widths, and of the passes that find steps.
constexpr std::array<std::size_t, 3> kWidths{57, 137, 271};
/// Fits of each width: degree 2 and 1 with robust weights, and without.
constexpr std::size_t kFits = 4, kCandidates = kFits * kWidths.size();
constexpr std::size_t kFirstLook = 27, kSecondLook = 57, kThirdLook = 81;
/// Differences in deviations of the noise beyond which a neighbour does not count: of samples, and of means of these.
constexpr double kSamplesApart = 4.5, kMeansApart = 3;
/// σ of the robust weights, in deviations of the noise.
constexpr double kRobust = 2;
/// Squared distance from plane and value, in variances of the noise, below which all neighbours count.
constexpr double kNoStep = 2;
/// Pooling of errors: passes over stars, and the accepted error of the pooled mean in variances of the noise.
constexpr int kPoolPasses = 16;
/// Added error of fits whose robust weights are neither 0 nor 1: such weights follow the noise.
constexpr double kVague = 2;
constexpr double kAccepted = 0.03;
constexpr double kLeastRobust = 1e-4;
constexpr std::size_t kSmoothGrain = 256;

double biweight(double t2) { return t2 < 1 ? (1 - t2) * (1 - t2) : 0; }

class SampleSmoother {
 public:
  SampleSmoother(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                 const SampleNoise& noise, double factor)
      : volume_(volume), values_(values), metrics_(metrics), n_(volume.size()), c_(values.components) {
    for (const double typical : noise.typical) {
      const double s = factor * typical;
      deviations_.push_back(s), inverse_.push_back(s > 0 ? 1 / (s * s) : 0);
    }
    if (noise.varies()) noise_ = &noise;
  }

  SmoothedSamples smooth(Progress& progress) {
    if (std::all_of(inverse_.begin(), inverse_.end(), [](double i) { return i == 0; }))
      return {values_.values, std::vector<float>(n_ * c_, 0.0f)};
    progress.begin("smooth", 4);
    find_variances(values_.values);
    look(values_.values, kFirstLook, kSamplesApart);
    find_variances(pilot_);
    progress.advance();
    look(pilot_, kSecondLook, kMeansApart);
    progress.advance();
    find_slopes();
    progress.advance();
    fit_candidates();
    find_edges();
    for (int pass = 0; pass < kPoolPasses; ++pass) pool();
    SmoothedSamples result = choose();
    progress.advance();
    return result;
  }

 private:
  /// Factors of the noise's variance at each sample, by these values.
  void find_variances(const std::vector<double>& of) {
    if (!noise_) return;
    factors_.resize(n_ * c_);
    parallel_for(0, n_, kSmoothGrain, [&](std::size_t i) {
      const Vec3 x = volume_.position(i);
      const double place = noise_->by_place.at(x);
      for (std::size_t m = 0; m < c_; ++m) {
        const double f = place * noise_->by_value[m].at(of[i * c_ + m]);
        factors_[i * c_ + m] = static_cast<float>(f * f);
      }
    });
  }
  /// Factor of the noise's variance in a component of a sample.
  double variance_factor(std::size_t i, std::size_t m) const {
    return factors_.empty() ? 1 : static_cast<double>(factors_[i * c_ + m]);
  }

  /// Largest squared difference of two samples over the components, in variances of the noise.
  double difference(const std::vector<double>& of, std::size_t i, std::size_t j) const {
    double most = 0;
    for (std::size_t m = 0; m < c_; ++m) {
      const double d = of[i * c_ + m] - of[j * c_ + m];
      const double both = factors_.empty() ? 1 : 2 / (variance_factor(i, m) + variance_factor(j, m));
      most = std::max(most, d * d * inverse_[m] * both);
    }
    return most;
  }

  /// Means of the samples over neighbours that differ little from the sample in `by`.
  void look(const std::vector<double>& by, std::size_t count, double apart) {
    std::vector<double> means(values_.values);
    const double unit = 1 / (apart * apart);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      NearSamples near(volume_, metrics_);
      std::vector<double> sums(c_);
      for (std::size_t i = begin; i < end; ++i) {
        near.gather(static_cast<std::uint32_t>(i), count);
        const double radius = near.radius(count), inside = 1 / (radius * radius);
        double whole = 0;
        sums.assign(c_, 0.0);
        for (std::size_t j = 0; j < near.samples().size(); ++j) {
          const std::size_t at = near.samples()[j];
          const double w = (1 - near.squares()[j] * inside * 0.75) * biweight(difference(by, i, at) * unit);
          if (!(w > 0)) continue;
          whole += w;
          for (std::size_t m = 0; m < c_; ++m)
            sums[m] += w * (values_.values[at * c_ + m] - values_.values[i * c_ + m]);
        }
        for (std::size_t m = 0; m < c_; ++m)
          if (inverse_[m] > 0) means[i * c_ + m] = values_.values[i * c_ + m] + sums[m] / whole;
      }
    });
    pilot_ = std::move(means);
  }

  /// Planes through the samples on this side of steps: values and slopes in local coordinates.
  void find_slopes() {
    std::vector<double> values(values_.values);
    slopes_.assign(n_ * c_, Vec3f{});
    const double unit = 1 / (kMeansApart * kMeansApart);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      NearSamples near(volume_, metrics_);
      CentreFit fit;
      std::vector<double> weights, f;
      for (std::size_t i = begin; i < end; ++i) {
        near.gather(static_cast<std::uint32_t>(i), kThirdLook);
        const double radius = near.radius(kThirdLook), inside = 1 / (radius * radius);
        weights.clear();
        for (std::size_t j = 0; j < near.samples().size(); ++j)
          weights.push_back(std::max(1 - near.squares()[j] * inside, 0.0) *
                            biweight(difference(pilot_, i, near.samples()[j]) * unit));
        if (!near.repeated()) fit.place(near.local());
        fit.weigh(weights, 1);
        const auto l = fit.coefficients(1);
        for (std::size_t m = 0; m < c_; ++m) {
          if (inverse_[m] == 0) continue;
          f.clear();
          double rise = 0;
          for (std::size_t j = 0; j < near.samples().size(); ++j) {
            f.push_back(values_.values[near.samples()[j] * c_ + m] - values_.values[i * c_ + m]);
            rise += l[j] * f[j];
          }
          values[i * c_ + m] = values_.values[i * c_ + m] + rise;
          slopes_[i * c_ + m] = Vec3f(fit.slope(f));
        }
      }
    });
    pilot_ = std::move(values);
  }

  /// Robust weights of the neighbours: how far they are from the plane, or from the value, at the sample. False if all
  /// are about 1.
  bool find_robust(std::size_t i, const NearSamples& near, std::vector<double>& robust) const {
    const std::size_t n = near.samples().size();
    robust.assign(n, 0.0);
    for (std::size_t m = 0; m < c_; ++m) {
      const Vec3 slope(slopes_[i * c_ + m]);
      const double own = pilot_[i * c_ + m];
      for (std::size_t j = 0; j < n; ++j) {
        const double level = pilot_[near.samples()[j] * c_ + m] - own, plane = level - dot(slope, near.local()[j]);
        robust[j] = std::max(robust[j], std::min(level * level, plane * plane) * inverse_[m] / variance_factor(i, m));
      }
    }
    if (*std::max_element(robust.begin(), robust.end()) < kNoStep) return false;
    for (double& r : robust) {
      r = std::exp(-r / (2 * kRobust * kRobust));
      if (r < kLeastRobust) r = 0;
    }
    return true;
  }

  /// Coefficients of the fits without robust weights, which depend on positions only.
  struct PlainFits {
    std::array<std::vector<double>, 2 * kWidths.size()> coefficients;
    std::array<double, kWidths.size()> inside{};

    void set(const NearSamples& near, CentreFit& fit, std::vector<double>& weights) {
      fit.place(near.local());
      for (std::size_t w = 0; w < kWidths.size(); ++w) {
        const double radius = near.radius(kWidths[w]);
        inside[w] = 1 / (radius * radius);
        weights.clear();
        for (std::size_t j = 0; j < near.squares().size() && near.squares()[j] * inside[w] < 1; ++j)
          weights.push_back(1 - near.squares()[j] * inside[w]);
        fit.weigh(weights);
        for (std::size_t k = 0; k < 2; ++k) {
          const auto l = fit.coefficients(2 - static_cast<int>(k));
          coefficients[2 * w + k].assign(l.begin(), l.end());
        }
      }
    }
  };

  void fit_candidates() {
    changes_.assign(n_ * kCandidates * c_, 0.0f);
    variances_.assign(n_ * kCandidates, 1.0f);
    errors_.assign(n_ * kCandidates, 1.0f);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      NearSamples near(volume_, metrics_);
      CentreFit fit;
      PlainFits plain;
      std::vector<double> robust, weights;
      for (std::size_t i = begin; i < end; ++i) {
        near.gather(static_cast<std::uint32_t>(i), kWidths.back());
        if (!near.repeated()) plain.set(near, fit, weights);
        for (std::size_t k = 0; k < plain.coefficients.size(); ++k)
          keep(i, kFits * (k / 2) + 2 + k % 2, near, plain.coefficients[k], 0);
        if (!find_robust(i, near, robust)) {
          // Both are the same there. The pooled errors of neighbours at steps need them.
          for (std::size_t w = 0; w < kWidths.size(); ++w)
            for (std::size_t k = 0; k < 2; ++k) copy_candidate(i, kFits * w + 2 + k, kFits * w + k);
          continue;
        }
        for (std::size_t w = 0; w < kWidths.size(); ++w) {
          weights.clear();
          double vague = 0, whole = 0;
          for (std::size_t j = 0; j < robust.size() && near.squares()[j] * plain.inside[w] < 1; ++j) {
            weights.push_back((1 - near.squares()[j] * plain.inside[w]) * robust[j]);
            vague += weights.back() * (1 - robust[j]), whole += weights.back();
          }
          vague *= kVague / whole;
          fit.weigh(weights);
          keep(i, kFits * w, near, fit.coefficients(2), vague);
          keep(i, kFits * w + 1, near, fit.coefficients(1), vague);
        }
      }
    });
  }

  /// Stores the change of the sample's value by a candidate, its variance, and an unbiased estimate of its squared
  /// error in variances of the noise: (f − p)² / σ² − 1 + 2 l, with l the sample's own coefficient.
  void keep(std::size_t i, std::size_t candidate, const NearSamples& near, std::span<const double> l, double vague) {
    const std::size_t at = i * kCandidates + candidate;
    double variance = 0, error = 0, noisy = 0;
    if (factors_.empty())
      for (const double a : l) variance += a * a;
    else
      variance = varying_variance(i, near, l);
    for (std::size_t m = 0; m < c_; ++m) {
      if (inverse_[m] == 0) continue;
      double rise = 0;
      for (std::size_t j = 1; j < l.size(); ++j)
        rise += l[j] * (values_.values[near.samples()[j] * c_ + m] - values_.values[i * c_ + m]);
      changes_[at * c_ + m] = static_cast<float>(rise * std::sqrt(inverse_[m]));
      error += rise * rise * inverse_[m] / variance_factor(i, m) - 1 + 2 * l[0], ++noisy;
    }
    variances_[at] = static_cast<float>(variance);
    errors_[at] = static_cast<float>(error / noisy + vague);
  }

  /// Σ l_j² σ_j² / σ_i², mean over the components.
  double varying_variance(std::size_t i, const NearSamples& near, std::span<const double> l) const {
    double sum = 0, noisy = 0;
    for (std::size_t m = 0; m < c_; ++m) {
      if (inverse_[m] == 0) continue;
      double of = 0;
      for (std::size_t j = 0; j < l.size(); ++j) of += l[j] * l[j] * variance_factor(near.samples()[j], m);
      sum += of / variance_factor(i, m), ++noisy;
    }
    return sum / noisy;
  }

  void copy_candidate(std::size_t i, std::size_t from, std::size_t to) {
    const std::size_t a = i * kCandidates + from, b = i * kCandidates + to;
    variances_[b] = variances_[a], errors_[b] = errors_[a];
    for (std::size_t m = 0; m < c_; ++m) changes_[b * c_ + m] = changes_[a * c_ + m];
  }

  /// Weights of the edges from each sample to its star: 0 across steps.
  void find_edges() {
    const double unit = 1 / (2 * kMeansApart * kMeansApart);
    first_edge_.assign(n_ + 1, 0);
    std::vector<std::uint32_t> star;
    for (std::size_t i = 0; i < n_; ++i) {
      volume_.star(i, star);
      first_edge_[i + 1] = first_edge_[i] + star.size();
    }
    edges_.assign(first_edge_[n_], 0.0f);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> near;
      for (std::size_t i = begin; i < end; ++i) {
        volume_.star(i, near);
        for (std::size_t k = 0; k < near.size(); ++k)
          edges_[first_edge_[i] + k] = static_cast<float>(std::exp(-difference(pilot_, i, near[k]) * unit));
      }
    });
  }

  /// Means of the errors over each sample and its star, without those across steps.
  void pool() {
    std::vector<float> pooled(errors_.size());
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> star;
      for (std::size_t i = begin; i < end; ++i) {
        std::array<float, kCandidates> sums{};
        float whole = 1;
        for (std::size_t k = 0; k < kCandidates; ++k) sums[k] = errors_[i * kCandidates + k];
        volume_.star(i, star);
        for (std::size_t e = 0; e < star.size(); ++e) {
          const float w = edges_[first_edge_[i] + e];
          const float* const other = errors_.data() + star[e] * kCandidates;
          whole += w;
          for (std::size_t k = 0; k < kCandidates; ++k) sums[k] += w * other[k];
        }
        for (std::size_t k = 0; k < kCandidates; ++k) pooled[i * kCandidates + k] = sums[k] / whole;
      }
    });
    errors_ = std::move(pooled);
  }

  SmoothedSamples choose() const {
    SmoothedSamples result{values_.values, std::vector<float>(n_ * c_, 0.0f)};
    parallel_for(0, n_, kSmoothGrain, [&](std::size_t i) {
      double least = 1;
      std::size_t best = kCandidates;
      for (std::size_t k = 0; k < kCandidates; ++k) {
        const auto variance = static_cast<double>(variances_[i * kCandidates + k]);
        const double bias = static_cast<double>(errors_[i * kCandidates + k]) - variance - kAccepted;
        const double risk = variance + std::max(bias, 0.0);
        if (risk < least) least = risk, best = k;
      }
      for (std::size_t m = 0; m < c_; ++m) {
        const double s = deviations_[m];
        result.deviations[i * c_ + m] = static_cast<float>(s * std::sqrt(least * variance_factor(i, m)));
        if (best < kCandidates && s > 0)
          result.values[i * c_ + m] += s * static_cast<double>(changes_[(i * kCandidates + best) * c_ + m]);
      }
    });
    return result;
  }

  const SampledVolume& volume_;
  const VolumeValues& values_;
  std::span<const StarMetric> metrics_;
  std::vector<double> deviations_;      ///< deviations of the noise, per component
  std::vector<double> inverse_;         ///< inverse squares of the deviations, 0 without noise
  const SampleNoise* noise_ = nullptr;  ///< noise that varies
  std::vector<float> factors_;          ///< factors of the variance at each sample, if it varies
  std::size_t n_, c_;
  std::vector<double> pilot_;
  std::vector<Vec3f> slopes_;
  std::vector<std::size_t> first_edge_;  ///< start of the star of each sample in `edges_`
  std::vector<float> edges_;
  std::vector<float> changes_, variances_, errors_;  ///< one per candidate of each sample
};

}  // namespace

SmoothedSamples smooth_samples(const SampledVolume& volume, const VolumeValues& values,
                               std::span<const StarMetric> metrics, const SampleNoise& noise, double factor,
                               Progress& progress) {
  return SampleSmoother(volume, values, metrics, noise, factor).smooth(progress);
}

}  // namespace sansmesh::inline v1
