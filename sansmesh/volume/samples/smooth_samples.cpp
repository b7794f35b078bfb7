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
      : volume_(volume),
        values_(values),
        metrics_(metrics),
        noise_(noise),
        factor_(factor),
        n_(volume.size()),
        c_(values.components) {}

  SmoothedSamples smooth(Progress& progress) {
    progress.begin("smooth", 4);
    look(values_.values, kFirstLook, kSamplesApart);
    progress.advance();
    look(pilot_, kSecondLook, kMeansApart);
    progress.advance();
    find_slopes();
    progress.advance();
    fit_candidates();
    for (int pass = 0; pass < kPoolPasses; ++pass) pool();
    SmoothedSamples result = choose();
    progress.advance();
    return result;
  }

 private:
  double deviation(std::size_t sample, std::size_t m) const { return factor_ * noise_.at(sample, m); }

  /// Whether any component has noise there; inverse squares of the deviations (0 without noise).
  bool inverse_squares(std::size_t sample, std::vector<double>& inverse) const {
    bool any = false;
    for (std::size_t m = 0; m < c_; ++m) {
      const double s = deviation(sample, m);
      inverse[m] = s > 0 ? 1 / (s * s) : 0;
      any = any || s > 0;
    }
    return any;
  }

  /// Largest squared difference of two samples over the components, in variances of the noise.
  double difference(const std::vector<double>& of, std::size_t i, std::size_t j,
                    const std::vector<double>& inverse) const {
    double most = 0;
    for (std::size_t m = 0; m < c_; ++m) {
      const double d = of[i * c_ + m] - of[j * c_ + m];
      most = std::max(most, d * d * inverse[m]);
    }
    return most;
  }

  /// Means of the samples over neighbours that differ little from the sample in `by`.
  void look(const std::vector<double>& by, std::size_t count, double apart) {
    std::vector<double> means(values_.values);
    const double unit = 1 / (apart * apart);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      NearSamples near(volume_, metrics_);
      std::vector<double> inverse(c_), sums(c_);
      for (std::size_t i = begin; i < end; ++i) {
        if (!inverse_squares(i, inverse)) continue;
        near.gather(static_cast<std::uint32_t>(i), count);
        const double radius = near.radius(count), inside = 1 / (radius * radius);
        double whole = 0;
        sums.assign(c_, 0.0);
        for (std::size_t j = 0; j < near.samples().size(); ++j) {
          const std::size_t at = near.samples()[j];
          const double w = (1 - near.squares()[j] * inside * 0.75) * biweight(difference(by, i, at, inverse) * unit);
          if (!(w > 0)) continue;
          whole += w;
          for (std::size_t m = 0; m < c_; ++m)
            sums[m] += w * (values_.values[at * c_ + m] - values_.values[i * c_ + m]);
        }
        for (std::size_t m = 0; m < c_; ++m)
          if (inverse[m] > 0) means[i * c_ + m] = values_.values[i * c_ + m] + sums[m] / whole;
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
      std::vector<double> inverse(c_), weights, f;
      for (std::size_t i = begin; i < end; ++i) {
        if (!inverse_squares(i, inverse)) continue;
        near.gather(static_cast<std::uint32_t>(i), kThirdLook);
        const double radius = near.radius(kThirdLook), inside = 1 / (radius * radius);
        weights.clear();
        for (std::size_t j = 0; j < near.samples().size(); ++j)
          weights.push_back(std::max(1 - near.squares()[j] * inside, 0.0) *
                            biweight(difference(pilot_, i, near.samples()[j], inverse) * unit));
        fit.place(near.local());
        fit.weigh(weights);
        const auto l = fit.coefficients(1);
        for (std::size_t m = 0; m < c_; ++m) {
          if (inverse[m] == 0) continue;
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

  /// Robust weights of the neighbours: how far they are from the plane, or from the value, at the sample.
  void find_robust(std::size_t i, const NearSamples& near, const std::vector<double>& inverse,
                   std::vector<double>& robust) const {
    robust.clear();
    for (std::size_t j = 0; j < near.samples().size(); ++j) {
      const std::size_t at = near.samples()[j];
      double most = 0;
      for (std::size_t m = 0; m < c_; ++m) {
        const double level = pilot_[at * c_ + m] - pilot_[i * c_ + m];
        const double plane = level - dot(Vec3(slopes_[i * c_ + m]), near.local()[j]);
        most = std::max(most, std::min(level * level, plane * plane) * inverse[m]);
      }
      const double w = std::exp(-most / (2 * kRobust * kRobust));
      robust.push_back(w < kLeastRobust ? 0 : w);
    }
  }

  void fit_candidates() {
    changes_.assign(n_ * kCandidates * c_, 0.0f);
    variances_.assign(n_ * kCandidates, 1.0f);
    errors_.assign(n_ * kCandidates, 1.0f);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      NearSamples near(volume_, metrics_);
      CentreFit fit;
      std::vector<double> inverse(c_), robust, weights;
      for (std::size_t i = begin; i < end; ++i) {
        if (!inverse_squares(i, inverse)) continue;
        near.gather(static_cast<std::uint32_t>(i), kWidths.back());
        find_robust(i, near, inverse, robust);
        fit.place(near.local());
        for (std::size_t w = 0; w < kWidths.size(); ++w) {
          const double radius = near.radius(kWidths[w]), inside = 1 / (radius * radius);
          weights.clear();
          double vague = 0, whole = 0;
          for (std::size_t j = 0; j < robust.size() && near.squares()[j] * inside < 1; ++j) {
            weights.push_back((1 - near.squares()[j] * inside) * robust[j]);
            vague += weights.back() * (1 - robust[j]), whole += weights.back();
          }
          fit.weigh(weights);
          vague *= kVague / whole;
          keep(i, kFits * w, near, fit.coefficients(2), inverse, vague);
          keep(i, kFits * w + 1, near, fit.coefficients(1), inverse, vague);
          for (std::size_t j = 0; j < weights.size(); ++j) weights[j] = 1 - near.squares()[j] * inside;
          fit.weigh(weights);
          keep(i, kFits * w + 2, near, fit.coefficients(2), inverse, 0);
          keep(i, kFits * w + 3, near, fit.coefficients(1), inverse, 0);
        }
      }
    });
  }

  /// Stores the change of the sample's value by a candidate, its variance, and an unbiased estimate of its squared error
  /// in variances of the noise: (f − p)² / σ² − 1 + 2 l, with l the sample's own coefficient.
  void keep(std::size_t i, std::size_t candidate, const NearSamples& near, std::span<const double> l,
            const std::vector<double>& inverse, double vague) {
    const std::size_t at = i * kCandidates + candidate;
    double variance = 0, error = 0, noisy = 0;
    for (const double a : l) variance += a * a;
    for (std::size_t m = 0; m < c_; ++m) {
      if (inverse[m] == 0) continue;
      double rise = 0;
      for (std::size_t j = 1; j < l.size(); ++j)
        rise += l[j] * (values_.values[near.samples()[j] * c_ + m] - values_.values[i * c_ + m]);
      changes_[at * c_ + m] = static_cast<float>(rise * std::sqrt(inverse[m]));
      error += rise * rise * inverse[m] - 1 + 2 * l[0], ++noisy;
    }
    variances_[at] = static_cast<float>(variance);
    errors_[at] = static_cast<float>(error / noisy + vague);
  }

  /// Means of the errors over each sample and its star, without those across steps.
  void pool() {
    std::vector<float> pooled(errors_.size());
    const double unit = 1 / (2 * kMeansApart * kMeansApart);
    parallel_ranges(0, n_, kSmoothGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> star;
      std::vector<double> inverse(c_);
      for (std::size_t i = begin; i < end; ++i) {
        std::array<double, kCandidates> sums{};
        double whole = 1;
        for (std::size_t k = 0; k < kCandidates; ++k) sums[k] = static_cast<double>(errors_[i * kCandidates + k]);
        if (inverse_squares(i, inverse)) {
          volume_.star(i, star);
          for (const std::uint32_t j : star) {
            const double w = std::exp(-difference(pilot_, i, j, inverse) * unit);
            whole += w;
            for (std::size_t k = 0; k < kCandidates; ++k)
              sums[k] += w * static_cast<double>(errors_[j * kCandidates + k]);
          }
        }
        for (std::size_t k = 0; k < kCandidates; ++k)
          pooled[i * kCandidates + k] = static_cast<float>(sums[k] / whole);
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
        const double s = deviation(i, m);
        result.deviations[i * c_ + m] = static_cast<float>(s * std::sqrt(least));
        if (best < kCandidates && s > 0)
          result.values[i * c_ + m] += s * static_cast<double>(changes_[(i * kCandidates + best) * c_ + m]);
      }
    });
    return result;
  }

  const SampledVolume& volume_;
  const VolumeValues& values_;
  std::span<const StarMetric> metrics_;
  const SampleNoise& noise_;
  double factor_;
  std::size_t n_, c_;
  std::vector<double> pilot_;
  std::vector<Vec3f> slopes_;
  std::vector<float> changes_, variances_, errors_;  ///< of each candidate of each sample
};

}  // namespace

SmoothedSamples smooth_samples(const SampledVolume& volume, const VolumeValues& values,
                               std::span<const StarMetric> metrics, const SampleNoise& noise, double factor,
                               Progress& progress) {
  return SampleSmoother(volume, values, metrics, noise, factor).smooth(progress);
}

}  // namespace sansmesh::inline v1
