// The methods as printed, which do not interpolate: moving least squares without residuals, its robust variant, and
// iterated sums of values alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

std::unique_ptr<VolumeField> printed_field(std::shared_ptr<const SampledVolume> volume, const std::string& method,
                                           bool interpolate) {
  VolumeReconstructionOptions options;
  options.method = method, options.interpolate = interpolate, options.smoothing = 0;
  if (method == "mls" && !interpolate) options.radius = 4;
  if (volume->in_cells) options.cell_values = CellValues::centres;
  Progress progress;
  return reconstruct_volume(std::move(volume), "f", options, progress);
}

TEST(PrintedMethods, ReproduceLinearFunctionsOnEveryGrid) {
  for (const NamedGrid& grid : all_grids(linear_function))
    for (const char* method : {"mls", "mls-detail"}) {
      const auto volume = with_values_at_samples(*volume_of(grid.data, grid.association), linear_function);
      const Errors errors =
          errors_of(*printed_field(volume, method, false), points_within(*volume, 500), linear_function);
      EXPECT_LT(errors.most, 1e-5) << grid.name << ", " << method;
    }
}

/// Root mean squares of the errors at samples in flat parts and next to the step, in deviations of the noise.
std::pair<double, double> noisy_step_errors(const std::string& method, bool interpolate) {
  constexpr double kSigma = 0.05;
  const VolumeFunction step = [](const Vec3& x) { return 0.8 * x.x + 0.6 * x.y < 0.63 ? 1.0 : 0.0; };
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  const auto volume =
      volume_of(lattice_grid({20, 20, 20}, [&](const Vec3& x) { return step(x) + kSigma * normal(random); }));
  const auto field = printed_field(volume, method, interpolate);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < volume->size(); ++i) x.push_back(volume->position(i));
  std::vector<double> values(x.size());
  field->evaluate(x, {values});
  double sums[2] = {}, counts[2] = {};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = std::abs(0.8 * x[i].x + 0.6 * x[i].y - 0.63) * 19;
    if (d > 1.5 && d < 4) continue;
    const std::size_t part = d <= 1.5 ? 1 : 0;
    sums[part] += (values[i] - step(x[i])) * (values[i] - step(x[i])), ++counts[part];
  }
  return {std::sqrt(sums[0] / counts[0]) / kSigma, std::sqrt(sums[1] / counts[1]) / kSigma};
}

TEST(PrintedMethods, FilterNoiseAndOnlyTheRobustOneKeepsSteps) {
  for (const char* method : {"mls", "mls-detail"}) {
    const auto [flat, at_step] = noisy_step_errors(method, true);
    EXPECT_NEAR(flat, 1, 0.05) << method << " interpolates";
    EXPECT_NEAR(at_step, 1, 0.15) << method;
  }
  const auto [flat, at_step] = noisy_step_errors("mls", false);
  EXPECT_LT(flat, 0.65);
  EXPECT_GT(at_step, 2);
  const auto [robust_flat, robust_at_step] = noisy_step_errors("mls-detail", false);
  EXPECT_LT(robust_flat, 0.65);
  EXPECT_LT(robust_at_step, 1);
}

TEST(PrintedMethods, SumsOfValuesAreMeansBeforeTheyAreIterated) {
  Progress progress;
  const auto volume = volume_of(bent_grid({9, 9, 9}, linear_function));
  const auto samples = volume_values(*volume, "f").values;
  const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
  VolumeReconstructionOptions options;
  options.method = "amls", options.degree = 0, options.order = 2, options.epsilon = 1.0;
  const std::vector<Vec3> x = points_within(*volume, 1000);
  double before = 0;
  for (const int iterations : {0, 3, 30}) {
    options.iterations = iterations;
    const auto field = reconstruct_volume(volume, "f", options, progress);
    std::vector<double> values(x.size()), at(volume->size());
    field->evaluate(x, {values});
    if (iterations == 0)
      for (const double v : values) ASSERT_TRUE(v > *least && v < *most) << v;
    field->evaluate(volume->positions, {at});
    double residual = 0;
    for (std::size_t i = 0; i < at.size(); ++i) residual += std::abs(at[i] - samples[i]);
    if (iterations > 0) EXPECT_LT(residual, 0.7 * before) << iterations;
    before = residual;
  }
  options.degree = 3;
  EXPECT_THROW(reconstruct_volume(volume, "f", options, progress), ArgumentError);
}

TEST(PrintedMethods, MeansOverCellsInterpolate) {
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = "mls-detail", options.interpolate = false, options.cell_values = CellValues::means;
  EXPECT_THROW(
      reconstruct_volume(volume_of(bent_grid({5, 5, 5}, linear_function), Association::cells), "f", options, progress),
      ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
