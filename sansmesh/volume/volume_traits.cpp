#include "sansmesh/volume/volume_traits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest number of predicted samples.
constexpr std::size_t kPredicted = 3000;
/// Neighbours required: twice the number of coefficients of a cubic polynomial, with as few rings as possible.
constexpr std::size_t kWanted = 40;
constexpr int kRingsAround = 4;
/// Predictions are normal deviates, about twice as wide as the noise of their neighbours implies.
constexpr double kToDeviation = 1.4826;
/// Samples next to steps: error in medians, and as a share of the range.
constexpr double kStepMedians = 10, kStepShare = 0.05;

struct Prediction {
  std::array<double, 4> error{};  ///< by degree
  double spread = 0;  ///< factor by which noise of the neighbours widens the error of degree 2: √(1 + leverage)
};

/// The neighbours of a sample ring by ring, without the sample itself.
void gather(const SampledVolume& volume, std::uint32_t sample, std::vector<std::uint32_t>& found) {
  std::vector<std::uint32_t> star;
  found.assign(1, sample);
  std::size_t first = 0;
  for (int ring = 0; ring < kRingsAround && found.size() <= kWanted; ++ring) {
    const std::size_t last = found.size();
    for (std::size_t i = first; i < last; ++i) {
      volume.star(found[i], star);
      for (const std::uint32_t s : star)
        if (std::find(found.begin(), found.end(), s) == found.end()) found.push_back(s);
    }
    first = last;
  }
  found.erase(found.begin());
}

class Predictor {
 public:
  Predictor(const SampledVolume& volume, const VolumeValues& values) : volume_(volume), values_(values) {}

  Prediction predict(std::uint32_t sample) {
    gather(volume_, sample, near_);
    const Vec3 center = volume_.position(sample);
    // Coordinates in which the neighbours have the same spread along all axes.
    Vec3 scale;
    for (const std::uint32_t s : near_) {
      const Vec3 d = volume_.position(s) - center;
      for (std::size_t k = 0; k < 3; ++k) scale[k] = std::max(scale[k], std::abs(d[k]));
    }
    const std::size_t n = near_.size();
    for (auto& x : x_) x.resize(n);
    weights_.resize(n), f_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 d = volume_.position(near_[i]) - center;
      double r2 = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        x_[k][i] = scale[k] > 0 ? d[k] / scale[k] : 0;
        r2 += x_[k][i] * x_[k][i];
      }
      weights_[i] = std::exp(-2 * r2);
    }
    Prediction p;
    for (std::size_t c = 0; c < values_.components; ++c) {
      const double truth = values_.of(sample)[c];
      for (std::size_t i = 0; i < n; ++i) f_[i] = values_.of(near_[i])[c];
      fit_.reset({{x_[0], x_[1], x_[2]}, f_, weights_}, ApproximationFrame<3>{{0, 0, 0}, 1});
      for (std::size_t degree = 0; degree < 4; ++degree) {
        fit_.raise();
        p.error[degree] = std::max(p.error[degree], std::abs(fit_.value({0, 0, 0}) - truth));
        if (degree == 2 && c == 0) p.spread = spread_of(n);
      }
    }
    return p;
  }

 private:
  /// The value at the centre is Σ a_i f_i: √(1 + Σ a_i²), with a_i = √w_i Σ_j ψ_j(0) √w_i ψ_j(x_i) / ‖ψ_j‖².
  double spread_of(std::size_t n) {
    basis_.resize(static_cast<std::size_t>(fit_.size()));
    fit_.basis({0, 0, 0}, basis_);
    double sum = 1;
    for (std::size_t i = 0; i < n; ++i) {
      double a = 0;
      for (int j = 0; j < fit_.size(); ++j)
        if (!fit_.is_dropped(j))
          a += basis_[static_cast<std::size_t>(j)] * fit_.weighted_basis(j)[i] / fit_.squared_norm(j);
      sum += a * a * weights_[i];
    }
    return std::sqrt(sum);
  }

  const SampledVolume& volume_;
  const VolumeValues& values_;
  OrthogonalFit<3> fit_;
  std::vector<std::uint32_t> near_;
  std::array<std::vector<double>, 3> x_;
  std::vector<double> weights_, f_, basis_;
};

double range_of(const VolumeValues& values) {
  double widest = 0;
  for (std::size_t c = 0; c < values.components; ++c) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = c; i < values.values.size(); i += values.components)
      least = std::min(least, values.values[i]), most = std::max(most, values.values[i]);
    widest = std::max(widest, most - least);
  }
  return widest;
}

}  // namespace

VolumeTraits measure_volume_traits(const SampledVolume& volume, const VolumeValues& values, const SampleNoise& noise,
                                   Progress& progress) {
  VolumeTraits t;
  t.samples = volume.size();
  t.range = range_of(values);
  if (!(t.range > 0)) return t;
  if (const double scale = binary_scale(t.range); scale != 1) {
    t = measure_volume_traits(volume, scaled_values(values, std::vector<double>(values.components, scale)),
                              noise.scaled(scale), progress);
    t.range /= scale;
    return t;
  }
  const std::size_t count = std::min(kPredicted, t.samples);
  progress.begin("look at values", count);
  std::vector<Prediction> predictions(count);
  parallel_ranges(0, count, 64, [&](std::size_t begin, std::size_t end) {
    Predictor predictor(volume, values);
    for (std::size_t i = begin; i < end; ++i)
      predictions[i] = predictor.predict(static_cast<std::uint32_t>(i * t.samples / count));
    progress.advance(end - begin);
  });
  std::vector<double> errors(count);
  for (std::size_t degree = 0; degree < 4; ++degree) {
    for (std::size_t i = 0; i < count; ++i) errors[i] = predictions[i].error[degree] / t.range;
    t.left_out[degree] = median(errors);
    double sum = 0;
    for (const double e : errors) sum += e * e;
    t.left_out_rms[degree] = std::sqrt(sum / static_cast<double>(count));
  }
  for (std::size_t i = 0; i < count; ++i) errors[i] = predictions[i].error[2] / (t.range * predictions[i].spread);
  t.noise = std::min(kToDeviation * median(errors), kToDeviation * t.left_out[3]);
  if (noise.found) {
    t.noisy = true, t.kind = noise.kind();
    t.noise = noise.deviation() / t.range;
  }
  std::size_t stepped = 0;
  for (const Prediction& p : predictions)
    stepped += p.error[2] > kStepMedians * t.left_out[2] * t.range && p.error[2] > kStepShare * t.range;
  t.steps = static_cast<double>(stepped) / static_cast<double>(count);
  return t;
}

}  // namespace sansmesh::inline v1
