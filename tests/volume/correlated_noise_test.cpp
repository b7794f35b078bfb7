// Noise that neighbouring samples of a lattice share: its estimate, smoothing, and structure that is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/volume/smoothed_values.h"
#include "support/any_threads.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

using Counts = std::array<std::size_t, 3>;

constexpr double kPi = 3.14159265358979323846;

/// Place of a sample in a cube of n³, in samples.
Vec3 lattice_place(std::size_t i, std::size_t n) {
  const std::size_t rows = i / n, layer = rows / n;
  return {static_cast<double>(i % n), static_cast<double>(rows % n), static_cast<double>(layer)};
}

/// White noise of a periodic lattice, blurred by Gaussians with these deviations (samples) along the axes, of mean 0
/// and deviation 1.
std::vector<double> blurred_noise(const Counts& n, const std::array<double, 3>& blur, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> f(n[0] * n[1] * n[2]);
  for (double& v : f) v = normal(random);
  std::size_t step = 1;
  for (std::size_t k = 0; k < 3; step *= n[k], ++k) {
    if (blur[k] == 0) continue;
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(4 * blur[k]));
    std::vector<double> result(f.size(), 0.0);
    for (std::size_t i = 0; i < f.size(); ++i) {
      const auto at = static_cast<std::ptrdiff_t>(i / step % n[k]), size = static_cast<std::ptrdiff_t>(n[k]);
      for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
        const std::ptrdiff_t to = ((at + d) % size + size) % size - at;
        const double t = static_cast<double>(d) / blur[k];
        result[i] +=
            std::exp(-0.5 * t * t) *
            f[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + to * static_cast<std::ptrdiff_t>(step))];
      }
    }
    f = std::move(result);
  }
  double mean = 0, square = 0;
  for (const double v : f) mean += v / static_cast<double>(f.size());
  for (const double v : f) square += (v - mean) * (v - mean) / static_cast<double>(f.size());
  for (double& v : f) v = (v - mean) / std::sqrt(square);
  return f;
}

VolumeValues with_noise(const SampledVolume& volume, const VolumeFunction& f, double sigma,
                        const std::vector<double>& noise) {
  VolumeValues values;
  values.name = "f";
  for (std::size_t i = 0; i < volume.size(); ++i) values.values.push_back(f(volume.position(i)) + sigma * noise[i]);
  return values;
}

/// A ball with a sharp border in a field that is flat below and curved above.
const Vec3 kBall{0.5, 0.5, 0.3};
double body(const Vec3& x) {
  const double above = std::max(x.z - 0.5, 0.0);
  return (norm(x - kBall) < 0.2 ? 1.0 : 0.0) + 6 * above * above * (0.5 + x.x * x.y);
}
bool is_flat(const Vec3& x) { return norm(x - kBall) > 0.28 && x.z < 0.5; }
bool is_curved(const Vec3& x) { return x.z > 0.6; }

double step(const Vec3& x) { return 0.8 * x.x + 0.6 * x.y + 0.1 * std::sin(6 * x.z) < 0.63 ? 1.0 : 0.0; }

/// Waves of random directions with lengths (samples) from `least` to `most`.
std::vector<double> random_waves(std::size_t n, double least, double most, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<double> f(n * n * n, 0.0);
  for (int wave = 0; wave < 24; ++wave) {
    Vec3 way{normal(random), normal(random), normal(random)};
    const double length = least * std::pow(most / least, share(random)), phase = 2 * kPi * share(random);
    way = way * (2 * kPi / length / norm(way));
    for (std::size_t i = 0; i < f.size(); ++i) f[i] += std::sin(dot(way, lattice_place(i, n)) + phase);
  }
  return f;
}

/// Means over cubes of 3 samples of random numbers, each around the nearest of random points some `width` apart.
std::vector<double> random_grains(std::size_t n, double width, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0, 1);
  const auto side = static_cast<std::ptrdiff_t>(std::ceil(static_cast<double>(n) / width)) + 2;
  std::vector<Vec3> points;
  std::vector<double> grains;
  for (std::ptrdiff_t c = 0; c < side * side * side; ++c) {
    const std::ptrdiff_t rows = c / side, layer = rows / side;
    const Vec3 cell{static_cast<double>(c % side), static_cast<double>(rows % side), static_cast<double>(layer)};
    points.push_back((cell + Vec3{share(random), share(random), share(random)} - Vec3{1, 1, 1}) * width);
    grains.push_back(normal(random));
  }
  std::vector<double> f(n * n * n);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Vec3 x = lattice_place(i, n);
    double nearest = 1e9;
    for (int o = 0; o < 27; ++o) {
      std::ptrdiff_t cell = 0;
      for (std::size_t k = 3, rest = 9; k-- > 0; rest /= 3) {
        const auto at = static_cast<std::ptrdiff_t>(x[k] / width) + 1 +
                        static_cast<std::ptrdiff_t>(o / static_cast<int>(rest) % 3) - 1;
        cell = cell * side + std::clamp<std::ptrdiff_t>(at, 0, side - 1);
      }
      if (const double d = norm(x - points[static_cast<std::size_t>(cell)]); d < nearest)
        nearest = d, f[i] = grains[static_cast<std::size_t>(cell)];
    }
  }
  std::size_t step = 1;
  for (std::size_t k = 0; k < 3; ++k, step *= n) {
    std::vector<double> mean = f;
    for (std::size_t i = 0; i < f.size(); ++i)
      if (const std::size_t at = i / step % n; at > 0 && at + 1 < n) mean[i] = (f[i - step] + f[i] + f[i + step]) / 3;
    f = std::move(mean);
  }
  return f;
}

/// Sum of smooth interpolations of random numbers on lattices of halved widths, as procedural textures are made.
std::vector<double> value_noise(std::size_t n, double width, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> f(n * n * n, 0.0);
  for (; width >= 2; width /= 2) {
    const auto side = static_cast<std::size_t>(static_cast<double>(n) / width) + 2;
    std::vector<double> numbers(side * side * side);
    for (double& v : numbers) v = normal(random);
    for (std::size_t i = 0; i < f.size(); ++i) {
      const Vec3 x = lattice_place(i, n) * (1 / width);
      for (std::size_t corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::size_t at = 0;
        for (std::size_t k = 3; k-- > 0;) {
          const double t = x[k] - std::floor(x[k]), smooth = t * t * (3 - 2 * t);
          const std::size_t upper = corner >> k & 1;
          weight *= upper == 1 ? smooth : 1 - smooth;
          at = at * side + static_cast<std::size_t>(x[k]) + upper;
        }
        f[i] += weight * numbers[at];
      }
    }
  }
  return f;
}

SmoothedValues smooth_by_noise(const SampledVolume& volume, const VolumeValues& values,
                               std::optional<double> factor = {}) {
  Progress progress;
  return smoothed_values(volume, values, factor, progress);
}

SampleNoise noise_in(const SampledVolume& volume, const VolumeValues& values) {
  Progress progress;
  return noise_of_values(volume, values, progress);
}

template <class Where>
double rms_where(const SampledVolume& volume, const std::vector<double>& values, const VolumeFunction& f,
                 const Where& where) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const Vec3 x = volume.position(i);
    if (where(x)) sum += (values[i] - f(x)) * (values[i] - f(x)), ++count;
  }
  return std::sqrt(sum / count);
}

TEST(CorrelatedNoise, FlatPartsLoseHalfOfItAndMoreAndStepsStay) {
  for (const auto& [blur, sigma] : {std::pair{0.7, 0.05}, {0.9, 0.1}, {1.2, 0.1}}) {
    // Wide kernels leave few independent residuals.
    const Counts n = blur > 1 ? Counts{44, 42, 46} : Counts{38, 36, 40};
    const auto volume = volume_of(lattice_grid(n, body));
    const std::vector<double> noise = blurred_noise(n, {blur, blur, blur}, 6);
    const VolumeValues values = with_noise(*volume, body, sigma, noise);
    const SmoothedValues result = smooth_by_noise(*volume, values);
    ASSERT_EQ(result.smoothing, 1) << blur << ", " << sigma;
    EXPECT_NEAR(result.noise, sigma, 0.2 * sigma) << blur;
    EXPECT_LT(rms_where(*volume, result.values.values, body, is_flat), 0.5 * sigma) << blur << ", " << sigma;
    EXPECT_LT(rms_where(*volume, result.values.values, body, is_curved), 0.8 * sigma) << blur << ", " << sigma;
    const auto at_border = [](const Vec3& x) { return std::abs(norm(x - kBall) - 0.2) < 0.05; };
    EXPECT_LT(rms_where(*volume, result.values.values, body, at_border), 1.05 * sigma) << blur << ", " << sigma;
  }
}

TEST(CorrelatedNoise, ItsReachFollowsTheKernelAlongEachAxis) {
  const Counts n{48, 44, 40};
  const auto volume = volume_of(lattice_grid(n, step));
  const SampleNoise in_slices = noise_in(*volume, with_noise(*volume, step, 0.1, blurred_noise(n, {1, 1, 0}, 3)));
  EXPECT_TRUE(in_slices.found);
  EXPECT_GE(in_slices.reach[0], 2u);
  EXPECT_GE(in_slices.reach[1], 2u);
  EXPECT_EQ(in_slices.reach[2], 1u);
  EXPECT_NEAR(in_slices.typical[0], 0.1, 0.02);
  const SampleNoise wide = noise_in(*volume, with_noise(*volume, step, 0.1, blurred_noise(n, {1.2, 1.2, 1.2}, 4)));
  EXPECT_TRUE(wide.found);
  for (const std::size_t r : wide.reach) EXPECT_GE(r, 3u);
  const SampleNoise white = noise_in(*volume, with_noise(*volume, step, 0.1, blurred_noise(n, {0, 0, 0}, 4)));
  EXPECT_TRUE(white.found);
  EXPECT_FALSE(white.correlated());
}

TEST(CorrelatedNoise, StructureIsNone) {
  const Counts n{48, 48, 48};
  const VolumeFunction zero = [](const Vec3&) { return 0.0; };
  const auto volume = volume_of(lattice_grid(n, zero));
  std::vector<VolumeFunction> clean{body, step, [](const Vec3& x) { return std::tanh(9 * (x.x + x.y - x.z)); }};
  for (const double k : {10.0, 20.0, 45.0, 60.0, 90.0})
    clean.emplace_back(
        [k](const Vec3& x) { return std::sin(k * x.x) * std::sin(k * x.y + 1) * std::sin(k * x.z + 2); });
  // The usual test signal of volume rendering: waves near the resolution.
  clean.emplace_back([](const Vec3& x) {
    const double r = std::hypot(2 * x.x - 1, 2 * x.y - 1);
    return std::sin(1.57 * (2 * x.z - 1)) + 0.25 * std::cos(37.7 * std::cos(1.57 * r));
  });
  for (std::size_t k = 0; k < clean.size(); ++k)
    EXPECT_FALSE(noise_in(*volume, with_noise(*volume, clean[k], 0, std::vector<double>(volume->size()))).found) << k;
  // Random parts of a specimen, as of bone or shell: sharp, smooth or isolated.
  for (const double size : {1.5, 2.0, 3.0, 4.0}) {
    std::vector<double> form = blurred_noise(n, {size, size, size}, 7), parts = form;
    const auto check = [&](const char* what) {
      EXPECT_FALSE(noise_in(*volume, with_noise(*volume, zero, 1, parts)).found) << what << " " << size;
    };
    for (std::size_t i = 0; i < form.size(); ++i) parts[i] = form[i] > 0 ? 1 : 0;
    check("sharp");
    for (std::size_t i = 0; i < form.size(); ++i) parts[i] = std::clamp(0.5 + 2 * form[i], 0.0, 1.0);
    check("partial volumes");
    for (std::size_t i = 0; i < form.size(); ++i) parts[i] = std::tanh(2 * form[i]);
    check("smooth");
    for (std::size_t i = 0; i < form.size(); ++i) parts[i] = std::max(form[i] - 0.8, 0.0);
    check("islands");
  }
}

TEST(CorrelatedNoise, StructureOfWhichItWouldBeMostIsNone) {
  // Residuals of normal deviates that do not grow, but without a signal beside them.
  constexpr std::size_t kSize = 44;
  const VolumeFunction zero = [](const Vec3&) { return 0.0; };
  const auto volume = volume_of(lattice_grid({kSize, kSize, kSize}, zero));
  for (const unsigned seed : {2, 3, 4}) {
    const auto check = [&](const char* field, const std::vector<double>& f) {
      const VolumeValues values = with_noise(*volume, zero, 1, f);
      const SampleNoise noise = noise_in(*volume, values);
      EXPECT_FALSE(noise.found) << field << ", seed " << seed << ": " << noise.typical[0];
    };
    check("waves of 2.9 to 31 samples", random_waves(kSize, 2.9, 31, seed));
    check("waves of 2.2 to 21 samples", random_waves(kSize, 2.2, 21, seed));
    check("grains", random_grains(kSize, 3.2, seed));
    check("value noise", value_noise(kSize, 8, seed));
  }
}

TEST(CorrelatedNoise, ItFadesWhereItBecomesMostOfTheData) {
  const Counts n{40, 40, 40};
  const VolumeFunction signal = [](const Vec3& x) { return std::sin(5 * x.x) + std::sin(4 * x.y + x.z); };
  const auto volume = volume_of(lattice_grid(n, signal));
  const std::vector<double> noise = blurred_noise(n, {0.9, 0.9, 0.9}, 6);
  // The deviation that is found, where the noise has a share of the deviation of the data.
  const auto used = [&](double share) {
    const VolumeValues clean = with_noise(*volume, signal, 0, noise);
    double mean = 0, variance = 0;
    for (const double v : clean.values) mean += v / static_cast<double>(volume->size());
    for (const double v : clean.values) variance += (v - mean) * (v - mean) / static_cast<double>(volume->size());
    const double sigma = share * std::sqrt(variance / (1 - share * share));
    const SampleNoise found = noise_in(*volume, with_noise(*volume, signal, sigma, noise));
    return found.found ? found.typical[0] / sigma : 0;
  };
  EXPECT_NEAR(used(0.1), 1, 0.2);
  EXPECT_NEAR(used(0.3), 1, 0.2);
  double last = used(0.36);
  for (const double share : {0.38, 0.40, 0.42, 0.44, 0.46, 0.48, 0.50, 0.52}) {
    const double next = used(share);
    EXPECT_LE(next, last) << share;
    EXPECT_NEAR(next, last, 0.25) << share;
    last = next;
  }
  EXPECT_EQ(last, 0);
}

TEST(CorrelatedNoise, EddiesOfAllSizesAreNone) {
  // Larger eddies are stronger, as in turbulence, so differences grow with the distance.
  const Counts n{56, 56, 56};
  std::vector<double> eddies(n[0] * n[1] * n[2], 0.0);
  for (int k = 0; k < 6; ++k) {
    const double size = 0.6 * std::pow(1.6, k);
    const std::vector<double> own = blurred_noise(n, {size, size, size}, 20 + static_cast<unsigned>(k));
    for (std::size_t i = 0; i < own.size(); ++i) eddies[i] += std::cbrt(size) * own[i];
  }
  const VolumeFunction zero = [](const Vec3&) { return 0.0; };
  const auto volume = volume_of(lattice_grid(n, zero));
  EXPECT_FALSE(noise_in(*volume, with_noise(*volume, zero, 1, eddies)).found);
}

TEST(CorrelatedNoise, VectorsAndSingleLayersHaveIt) {
  const Counts n{120, 120, 2};
  const std::vector<double> noise = blurred_noise(n, {0.9, 0.9, 0}, 6);
  const auto volume = volume_of(lattice_grid(n, step));
  VolumeValues values = with_noise(*volume, step, 0.1, noise);
  const std::size_t layer = n[0] * n[1];
  for (std::size_t i = 0; i < layer; ++i) values.values[layer + i] = values.values[i];
  EXPECT_EQ(smooth_by_noise(*volume, values).smoothing, 1);

  const Counts cube{36, 36, 36};
  const auto other = volume_of(lattice_grid(cube, step));
  const VolumeValues a = with_noise(*other, step, 0.1, blurred_noise(cube, {0.9, 0.9, 0.9}, 6));
  const VolumeValues b = with_noise(*other, linear_function, 0.05, blurred_noise(cube, {0.9, 0.9, 0.9}, 7));
  VolumeValues both;
  both.name = "f", both.components = 2;
  for (std::size_t i = 0; i < other->size(); ++i) both.values.insert(both.values.end(), {a.values[i], b.values[i]});
  const SampleNoise found = noise_in(*other, both);
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.typical[0], 0.1, 0.02);
  EXPECT_NEAR(found.typical[1], 0.05, 0.01);
}

TEST(CorrelatedNoise, PowersOfTwoScaleResultsExactlyAndThreadsDoNotMatter) {
  const Counts n{32, 30, 34};
  const auto volume = volume_of(lattice_grid(n, step));
  const VolumeValues values = with_noise(*volume, linear_function, 0.1, blurred_noise(n, {0.8, 0.8, 0.8}, 2));
  ASSERT_TRUE(noise_in(*volume, values).correlated());
  expect_equal_for_any_threads([&] { return smooth_by_noise(*volume, values).values.values; });
  const SmoothedValues own = smooth_by_noise(*volume, values);
  VolumeValues other = values;
  for (double& v : other.values) v *= 0x1p-40;
  const SmoothedValues scaled = smooth_by_noise(*volume, other);
  for (std::size_t i = 0; i < volume->size(); ++i) ASSERT_EQ(scaled.values.values[i], 0x1p-40 * own.values.values[i]);
}

}  // namespace
}  // namespace sansmesh::test
