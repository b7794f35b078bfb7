// Noise of volumes: its estimate, and smoothing that keeps steps, on every kind of grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/volume/samples/rician_noise.h"
#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume/smoothed_values.h"
#include "support/any_threads.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

double waves(const Vec3& x) { return std::sin(3 * x.x + 0.5) * std::cos(2.5 * x.y) + 0.6 * x.z * x.z; }

/// Grids of each kind with some thousand samples.
std::vector<NamedGrid> grids_for_noise() {
  const VolumeFunction zero = [](const Vec3&) { return 0.0; };
  std::vector<std::pair<std::string, GridData>> grids;
  grids.emplace_back("lattice", lattice_grid({14, 13, 15}, zero));
  grids.emplace_back("stretched", stretched_grid({15, 14, 13}, zero, 1.1));
  grids.emplace_back("bent", bent_grid({13, 14, 13}, zero));
  grids.emplace_back("o-grid", o_grid({29, 10, 9}, zero));
  grids.emplace_back("tetrahedra", tetrahedra_grid({15, 14, 16}, zero));
  grids.emplace_back("mixed", mixed_grid({13, 13, 13}, zero));
  grids.emplace_back("two levels", two_level_amr(12, zero));
  grids.emplace_back("overlapping", three_overlapping_blocks(11, zero));
  std::vector<NamedGrid> all;
  all.push_back({"scattered", scattered_grid(2000, zero)});
  for (auto& [name, data] : grids)
    for (const Association a : {Association::points, Association::cells})
      all.push_back({name + (a == Association::cells ? ", cells" : ""), data, a});
  return all;
}

VolumeValues noisy_values(const SampledVolume& volume, const VolumeFunction& f, double sigma, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  VolumeValues values;
  values.name = "f";
  for (std::size_t i = 0; i < volume.size(); ++i)
    values.values.push_back(f(volume.position(i)) + sigma * normal(random));
  return values;
}

SampleNoise noise_of(const SampledVolume& volume, const VolumeValues& values) {
  Progress progress;
  return estimate_noise(volume, values, volume.lattice ? std::vector<StarMetric>() : star_metrics(volume), progress);
}

SmoothedValues smooth(const SampledVolume& volume, const VolumeValues& values, std::optional<double> factor = {}) {
  Progress progress;
  return smoothed_values(volume, values, factor, progress);
}

/// Root mean square of the errors at the samples that `counts`.
template <class Counts>
double error_of(const SampledVolume& volume, const std::vector<double>& values, const VolumeFunction& f,
                const Counts& counts) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const Vec3 x = volume.position(i);
    if (!counts(x)) continue;
    sum += (values[i] - f(x)) * (values[i] - f(x)), ++count;
  }
  return std::sqrt(sum / count);
}

const auto kEverywhere = [](const Vec3&) { return true; };

TEST(VolumeNoise, CleanSamplesStayTheSameToTheBit) {
  const VolumeFunction functions[] = {waves, linear_function, [](const Vec3&) { return 3.25; },
                                      [](const Vec3& x) { return std::tanh(9 * (x.x + x.y - x.z)); },
                                      [](const Vec3& x) { return x.x < 0.45 ? 1.0 : 0.0; }};
  for (const std::vector<NamedGrid>& grids : {all_grids(waves), grids_for_noise()})
    for (const NamedGrid& grid : grids) {
      const auto volume = volume_of(grid.data, grid.association);
      for (std::size_t k = 0; k < std::size(functions); ++k) {
        const VolumeValues values = noisy_values(*volume, functions[k], 0);
        const SmoothedValues result = smooth(*volume, values);
        EXPECT_EQ(result.smoothing, 0) << grid.name << ", function " << k;
        EXPECT_EQ(result.noise, 0) << grid.name << ", function " << k;
        EXPECT_EQ(result.values.values, values.values) << grid.name << ", function " << k;
      }
    }
}

TEST(VolumeNoise, ShortWavesAreNoNoise) {
  for (const double w : {1.0, 1.3, 1.5, 1.6, 1.7, 1.9, 2.3}) {
    const double k = 23 * w;  // radians a unit: w a sample
    const auto f = [&](const Vec3& x) { return std::sin(k * x.x) * std::sin(k * x.y + 1) * std::sin(k * x.z + 2); };
    const auto volume = volume_of(lattice_grid({24, 24, 24}, f));
    EXPECT_EQ(smooth(*volume, noisy_values(*volume, f, 0)).smoothing, 0) << w;
  }
}

TEST(VolumeNoise, WhiteNoiseIsEstimatedOnEveryGrid) {
  for (const NamedGrid& grid : grids_for_noise()) {
    const auto volume = volume_of(grid.data, grid.association);
    for (const double sigma : {0.02, 0.15}) {
      const SampleNoise noise = noise_of(*volume, noisy_values(*volume, waves, sigma));
      EXPECT_TRUE(noise.found) << grid.name << ", " << volume->size() << ", " << noise.correlation;
      EXPECT_NEAR(noise.typical[0], sigma, 0.15 * sigma) << grid.name;
    }
  }
}

TEST(VolumeNoise, TheEstimateFollowsScaleAndShift) {
  const auto volume = volume_of(bent_grid({14, 14, 14}, waves));
  const VolumeValues values = noisy_values(*volume, waves, 0.05);
  const SampleNoise own = noise_of(*volume, values);
  VolumeValues other = values;
  for (double& v : other.values) v = 7 - 1000 * v;
  const SampleNoise scaled = noise_of(*volume, other);
  EXPECT_NEAR(scaled.typical[0], 1000 * own.typical[0], 1e-6 * own.typical[0] * 1000);
  EXPECT_EQ(scaled.found, own.found);
}

TEST(VolumeNoise, RoundingToIntegersIsNoNoise) {
  const auto volume = volume_of(lattice_grid({20, 20, 20}, waves));
  VolumeValues values = noisy_values(*volume, waves, 0);
  for (double& v : values.values) v = std::round(30 * v);
  EXPECT_EQ(smooth(*volume, values).values.values, values.values);
}

TEST(VolumeNoise, FlatPartsKeepAThirdOfTheNoiseAtMost) {
  const VolumeFunction flat = [](const Vec3&) { return -2.5; };
  for (const NamedGrid& grid : grids_for_noise()) {
    const auto volume = volume_of(grid.data, grid.association);
    const SmoothedValues result = smooth(*volume, noisy_values(*volume, flat, 0.1));
    EXPECT_LT(error_of(*volume, result.values.values, flat, kEverywhere), 0.1 / 3) << grid.name;
  }
}

TEST(VolumeNoise, CurvedPartsLoseAThirdOfTheNoiseAndMore) {
  for (const NamedGrid& grid : grids_for_noise()) {
    const auto volume = volume_of(grid.data, grid.association);
    for (const double sigma : {0.02, 0.15}) {
      const SmoothedValues result = smooth(*volume, noisy_values(*volume, waves, sigma));
      EXPECT_LT(error_of(*volume, result.values.values, waves, kEverywhere), (sigma > 0.1 ? 0.4 : 0.65) * sigma)
          << grid.name;
    }
  }
}

TEST(VolumeNoise, StepsStaySharp) {
  const VolumeFunction step = [](const Vec3& x) { return 0.8 * x.x + 0.6 * x.y < 0.63 ? 1.0 : 0.0; };
  for (const NamedGrid& grid : grids_for_noise()) {
    const auto volume = volume_of(grid.data, grid.association);
    const double near = 1.5 * volume->facts.median_spacing;
    const auto at_step = [&](const Vec3& x) { return std::abs(0.8 * x.x + 0.6 * x.y - 0.63) < near; };
    for (const double sigma : {0.02, 0.1}) {
      const SmoothedValues result = smooth(*volume, noisy_values(*volume, step, sigma));
      EXPECT_EQ(result.smoothing, 1) << grid.name;
      EXPECT_LT(error_of(*volume, result.values.values, step, at_step), 0.6 * sigma) << grid.name << " " << sigma;
    }
  }
}

TEST(VolumeNoise, DeviationsMatchTheErrors) {
  const VolumeFunction step = [](const Vec3& x) { return 0.8 * x.x + 0.6 * x.y < 0.63 ? 1.0 : 0.0; };
  for (const VolumeFunction& f : {VolumeFunction(waves), step}) {
    const auto volume = volume_of(bent_grid({20, 20, 20}, f));
    const SmoothedValues result = smooth(*volume, noisy_values(*volume, f, 0.05));
    double expected = 0;
    for (const float d : result.deviations) expected += static_cast<double>(d) * static_cast<double>(d);
    expected = std::sqrt(expected / static_cast<double>(volume->size()));
    const double error = error_of(*volume, result.values.values, f, kEverywhere);
    EXPECT_GT(expected, 0.6 * error);
    EXPECT_LT(expected, 1.6 * error);
  }
}

TEST(VolumeNoise, PowersOfTwoScaleResultsExactlyAndThreadsDoNotMatter) {
  for (const bool lattice : {true, false}) {
    const auto volume = volume_of(lattice ? lattice_grid({12, 11, 13}, waves) : tetrahedra_grid({10, 11, 9}, waves));
    VolumeValues values = noisy_values(*volume, waves, 0.05);
    expect_equal_for_any_threads([&] { return smooth(*volume, values).values.values; });
    const SmoothedValues own = smooth(*volume, values);
    for (const double factor : {0x1p-40, 0x1p900}) {
      VolumeValues other = values;
      for (double& v : other.values) v *= factor;
      const SmoothedValues scaled = smooth(*volume, other);
      for (std::size_t i = 0; i < volume->size(); ++i)
        ASSERT_EQ(scaled.values.values[i], factor * own.values.values[i]) << factor;
    }
  }
}

TEST(VolumeNoise, FactorZeroInterpolatesAndLargerOnesSmoothMore) {
  const auto volume = volume_of(lattice_grid({16, 16, 16}, waves));
  const VolumeValues values = noisy_values(*volume, waves, 0.05);
  EXPECT_EQ(smooth(*volume, values, 0).values.values, values.values);
  double rough = std::numeric_limits<double>::infinity();
  for (const double factor : {0.3, 1.0, 3.0}) {
    const SmoothedValues result = smooth(*volume, values, factor);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < 16; ++i) sum += std::abs(result.values.values[i + 1] - result.values.values[i]);
    EXPECT_LT(sum, rough) << factor;
    rough = sum;
  }
}

TEST(VolumeNoise, VectorsAreSmoothedTogether) {
  const auto volume = volume_of(bent_grid({14, 14, 14}, waves));
  const VolumeValues a = noisy_values(*volume, waves, 0.05, 1), b = noisy_values(*volume, linear_function, 0.02, 2);
  VolumeValues both;
  both.name = "f", both.components = 2;
  for (std::size_t i = 0; i < volume->size(); ++i) both.values.insert(both.values.end(), {a.values[i], b.values[i]});
  const SmoothedValues result = smooth(*volume, both);
  std::vector<double> first, second;
  for (std::size_t i = 0; i < volume->size(); ++i)
    first.push_back(result.values.values[2 * i]), second.push_back(result.values.values[2 * i + 1]);
  EXPECT_LT(error_of(*volume, first, waves, kEverywhere), 0.5 * 0.05);
  EXPECT_LT(error_of(*volume, second, linear_function, kEverywhere), 0.5 * 0.02);
}

/// Noise of deviation sigma(value, position).
template <class Deviation>
VolumeValues varying_values(const SampledVolume& volume, const VolumeFunction& f, const Deviation& sigma) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  VolumeValues values;
  values.name = "f";
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const Vec3 x = volume.position(i);
    values.values.push_back(f(x) + sigma(f(x), x) * normal(random));
  }
  return values;
}

/// Larger grids of some kinds, for curves of the noise.
std::vector<NamedGrid> large_grids() {
  const VolumeFunction zero = [](const Vec3&) { return 0.0; };
  return {{"lattice", lattice_grid({26, 26, 26}, zero), Association::points},
          {"bent, cells", bent_grid({24, 24, 24}, zero), Association::cells},
          {"tetrahedra", tetrahedra_grid({23, 23, 23}, zero), Association::points}};
}

TEST(VolumeNoise, EvenNoiseDoesNotVary) {
  for (const NamedGrid& grid : large_grids()) {
    const auto volume = volume_of(grid.data, grid.association);
    const SampleNoise noise = noise_of(*volume, noisy_values(*volume, waves, 0.05));
    for (std::size_t i = 0; i < volume->size(); i += 7) {
      const Vec3 x = volume->position(i);
      ASSERT_NEAR(noise.at(0, waves(x), x), 0.05, 0.2 * 0.05) << grid.name;
    }
  }
}

TEST(VolumeNoise, NoiseThatGrowsWithTheSignalIsFollowed) {
  const VolumeFunction f = [](const Vec3& x) { return 1 + x.x + 0.3 * std::sin(3 * x.y); };
  const auto sigma = [](double value, const Vec3&) { return 0.04 * (value - 0.4); };
  for (const NamedGrid& grid : large_grids()) {
    const auto volume = volume_of(grid.data, grid.association);
    const VolumeValues values = varying_values(*volume, f, sigma);
    const SampleNoise noise = noise_of(*volume, values);
    EXPECT_TRUE(noise.found) << grid.name;
    for (const double v : {0.9, 1.3, 1.7, 2.1}) {
      double logs = 0, count = 0;
      for (std::size_t i = 0; i < volume->size(); ++i) {
        const Vec3 x = volume->position(i);
        if (std::abs(f(x) - v) < 0.1) logs += std::log(noise.at(0, f(x), x) / sigma(f(x), x)), ++count;
      }
      EXPECT_NEAR(logs / count, 0, 0.28) << grid.name << ", " << v;
    }
    // Each part loses its own noise.
    const SmoothedValues result = smooth(*volume, values);
    for (const double low : {0.8, 1.8}) {
      const auto part = [&](const Vec3& x) { return f(x) > low && f(x) < low + 0.3; };
      EXPECT_LT(error_of(*volume, result.values.values, f, part), 0.5 * sigma(low + 0.15, {}))
          << grid.name << ", " << low;
    }
  }
}

TEST(VolumeNoise, NoiseOfMagnitudesIsLessWhereThereIsNoSignal) {
  // Magnitudes of complex numbers, as in magnetic resonance: the noise around the body has a Rayleigh distribution.
  const double sigma = 0.04;
  const VolumeFunction body = [](const Vec3& x) {
    const double r = norm(x - Vec3{0.5, 0.5, 0.5});
    return r < 0.35 ? 0.7 + 0.3 * std::sin(5 * x.x) * std::cos(4 * x.y) : 0.0;
  };
  const auto volume = volume_of(lattice_grid({36, 36, 36}, body));
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  VolumeValues values;
  values.name = "f";
  for (std::size_t i = 0; i < volume->size(); ++i) {
    const double real = body(volume->position(i)) + sigma * normal(random);
    values.values.push_back(std::hypot(real, sigma * normal(random)));
  }
  const SampleNoise noise = noise_of(*volume, values);
  EXPECT_TRUE(noise.found) << noise.correlation;
  const double air = noise.at(0, 1.25 * sigma, {0.1, 0.1, 0.2}), tissue = noise.at(0, 0.7, {0.5, 0.5, 0.5});
  EXPECT_NEAR(air, 0.655 * sigma, 0.15 * sigma);
  EXPECT_NEAR(tissue, sigma, 0.25 * sigma);
  const SmoothedValues result = smooth(*volume, values);
  const auto inside = [](const Vec3& x) { return norm(x - Vec3{0.5, 0.5, 0.5}) < 0.28; };
  EXPECT_LT(error_of(*volume, result.values.values, body, inside), 0.4 * sigma);
}

TEST(VolumeNoise, MeansOfMagnitudesAreCorrected) {
  // A signal of 0, 1.5 and 12 deviations, and one that fades into the background.
  const double sigma = 0.05;
  const VolumeFunction signal = [](const Vec3& x) {
    if (x.z > 0.7) return 0.6;
    if (x.z > 0.45 && x.z < 0.65) return x.x > 0.5 ? 0.075 : 0.0;
    return x.x > 0.5 ? 0.6 * (x.x - 0.5) : 0.0;
  };
  const auto volume = volume_of(lattice_grid({36, 36, 36}, signal));
  std::mt19937 random(29);
  std::normal_distribution<double> normal;
  VolumeValues magnitudes, real;
  magnitudes.name = real.name = "f";
  for (std::size_t i = 0; i < volume->size(); ++i) {
    const double part = signal(volume->position(i)) + sigma * normal(random);
    magnitudes.values.push_back(std::hypot(part, sigma * normal(random)));
    real.values.push_back(part + 0.3);
  }
  Progress progress;
  const SampleNoise noise = noise_of_values(*volume, magnitudes, progress);
  EXPECT_STREQ(noise.kind(), "Rician");
  EXPECT_NEAR(noise.rician, sigma, 0.08 * sigma);
  EXPECT_STREQ(noise_of_values(*volume, real, progress).kind(), "white");
  const SmoothedValues result = smooth(*volume, magnitudes);
  EXPECT_EQ(result.noise, noise.rician);
  const auto mean_error_where = [&](const auto& where) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < volume->size(); ++i) {
      const Vec3 x = volume->position(i);
      if (where(x)) sum += result.values.values[i] - signal(x), ++count;
    }
    return sum / count;
  };
  // Uncorrected: 1.25, 0.4 and 0.04 deviations.
  EXPECT_LT(std::abs(mean_error_where([](const Vec3& x) { return x.x < 0.4 && x.z < 0.6; })), 0.35 * sigma);
  EXPECT_LT(std::abs(mean_error_where([](const Vec3& x) { return x.x > 0.6 && x.z > 0.5 && x.z < 0.6; })), 0.2 * sigma);
  EXPECT_LT(std::abs(mean_error_where([](const Vec3& x) { return x.z > 0.8; })), 0.1 * sigma);
  EXPECT_LT(error_of(*volume, result.values.values, signal, [](const Vec3& x) { return x.z > 0.8; }), 0.4 * sigma);
}

TEST(VolumeNoise, OnlyMagnitudesAreRician) {
  // Counts grow with the signal, and values around an offset are normal deviates.
  const VolumeFunction body = [](const Vec3& x) { return norm(x - Vec3{0.5, 0.5, 0.5}) < 0.35 ? 1.0 : 0.0; };
  const auto volume = volume_of(lattice_grid({30, 30, 30}, body));
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  for (const double background : {3.66, 8.0}) {
    VolumeValues counts, offset, folded;
    counts.name = offset.name = folded.name = "f";
    for (std::size_t i = 0; i < volume->size(); ++i) {
      const double f = body(volume->position(i));
      counts.values.push_back(std::poisson_distribution<int>(background + 100 * f)(random));
      offset.values.push_back(std::max(background + 40 * f + 1.9 * normal(random), 0.0));
      folded.values.push_back(std::abs(1.3 + 20 * f + normal(random)));
    }
    for (const VolumeValues* const values : {&counts, &offset, &folded}) {
      Progress progress;
      EXPECT_STREQ(noise_of_values(*volume, *values, progress).kind(), "white") << background;
    }
  }
}

TEST(VolumeNoise, TheMeanOfMagnitudesIsInverted) {
  EXPECT_NEAR(mean_magnitude(0), std::sqrt(std::acos(-1.0) / 2), 1e-6);
  for (const double a : {0.0, 0.2, 1.0, 2.5, 5.0, 11.0, 14.0}) {
    // The mean of √((a + x)² + y²) over normal deviates x and y, by sums.
    double sum = 0;
    for (double x = -8; x < 8; x += 0.02)
      for (double y = -8; y < 8; y += 0.02)
        sum += std::exp(-0.5 * (x * x + y * y)) * std::hypot(a + x, y) * 0.0004 / (2 * std::acos(-1.0));
    EXPECT_NEAR(mean_magnitude(a), sum, 3e-4) << a;
    EXPECT_NEAR(signal_of_magnitude(mean_magnitude(a)), a, 2e-3) << a;
  }
  EXPECT_EQ(signal_of_magnitude(1), 0);
}

TEST(VolumeNoise, NoiseThatVariesInSpaceIsFollowed) {
  const auto sigma = [](double, const Vec3& x) { return 0.02 * std::exp(1.2 * x.y); };
  for (const NamedGrid& grid : large_grids()) {
    const auto volume = volume_of(grid.data, grid.association);
    const VolumeValues values = varying_values(*volume, waves, sigma);
    const SampleNoise noise = noise_of(*volume, values);
    EXPECT_TRUE(noise.found) << grid.name;
    const Box3 box = volume->bounds();
    for (const double t : {0.2, 0.5, 0.8}) {
      Vec3 x = box.center();
      x.y = box.lower.y + t * box.size().y;
      EXPECT_NEAR(noise.at(0, waves(x), x), sigma(0, x), 0.3 * sigma(0, x)) << grid.name << ", " << t;
    }
  }
}

TEST(VolumeNoise, SingleLayersAreSmoothedAsLayers) {
  for (const Association a : {Association::points, Association::cells})
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<std::size_t, 3> counts{60, 60, 60};
      counts[k] = 2;
      const VolumeFunction step = [&](const Vec3& x) { return x[(k + 1) % 3] < 0.47 ? 0.0 : 1.0; };
      const auto volume = volume_of(lattice_grid(counts, step), a);
      // Both layers have the same noise, as single layers of files have.
      std::mt19937 random(3);
      std::normal_distribution<double> normal;
      VolumeValues values;
      values.name = "f";
      values.values.resize(volume->size());
      const auto& axes = volume->lattice->axes;
      ASSERT_EQ(axes[k].size(), 2u);
      const std::size_t apart = k == 0 ? 1 : k == 1 ? axes[0].size() : axes[0].size() * axes[1].size();
      for (std::size_t i = 0; i < volume->size(); ++i)
        values.values[i] = volume->lattice->indices(i)[k] == 1 ? values.values[i - apart]
                                                               : step(volume->position(i)) + 0.1 * normal(random);
      const SmoothedValues result = smooth(*volume, values);
      EXPECT_EQ(result.smoothing, 1) << k;
      EXPECT_NEAR(result.noise, 0.1, 0.02) << k;
      const auto away = [&](const Vec3& x) { return std::abs(x[(k + 1) % 3] - 0.47) > 0.06; };
      EXPECT_LT(error_of(*volume, result.values.values, step, away), 0.05) << k;
      for (std::size_t i = 0; i < volume->size(); ++i)
        if (volume->lattice->indices(i)[k] == 1)
          ASSERT_EQ(result.values.values[i], result.values.values[i - apart]) << k << ", " << i;
    }
}

TEST(VolumeNoise, MissingValuesDoNotLowerIt) {
  SampledVolume volume = *volume_of(lattice_grid({20, 20, 20}, waves));
  std::vector<double> values = noisy_values(volume, waves, 0.05).values;
  const double known = noise_of(volume, noisy_values(volume, waves, 0.05)).typical[0];
  std::mt19937 random(8);
  for (double& v : values)
    if (random() % 4 == 0) v = std::numeric_limits<double>::quiet_NaN();
  volume.attributes.set("f", values);
  const SampleNoise noise = noise_of(volume, volume_values(volume, "f"));
  EXPECT_TRUE(noise.found) << noise.correlation;
  EXPECT_NEAR(noise.typical[0], known, 0.07 * known);
}

TEST(VolumeNoise, EveryReconstructionSmoothsFirst) {
  SampledVolume made = *volume_of(lattice_grid({14, 14, 14}, waves));
  made.attributes.set("f", noisy_values(made, waves, 0.1).values);
  const auto volume = std::make_shared<const SampledVolume>(std::move(made));
  const std::vector<Vec3> x = points_within(*volume, 2000);
  for (const VolumeMethod* const method : VolumeMethod::registry().all()) {
    Progress progress;
    VolumeReconstructionOptions options;
    options.method = std::string(method->name);
    VolumeReconstructionReport report;
    const auto smoothed = reconstruct_volume(volume, "f", options, progress, &report);
    EXPECT_EQ(report.options.smoothing, 1) << method->name;
    EXPECT_NEAR(report.noise, 0.1, 0.015) << method->name;
    options.smoothing = 0;
    const auto raw = reconstruct_volume(volume, "f", options, progress, &report);
    EXPECT_EQ(report.noise, 0) << method->name;
    EXPECT_LT(mean_error(*smoothed, x, waves), mean_error(*raw, x, waves)) << method->name;
  }
}

}  // namespace
}  // namespace sansmesh::test
