// Scaling the values by any factor scales the fields.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/smoothed_values.h"
#include "sansmesh/volume/volume_traits.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

double wave_of_magnitude(const Vec3& x) {
  return 1.5 + std::sin(2 * x.x + 0.3) * std::cos(1.7 * x.y) + std::exp(-x.z) * x.x;
}

std::vector<double> answers(const GridData& data, const std::string& method, bool slopes) {
  const auto volume = volume_of(data);
  const auto field = field_of(volume, method);
  const auto x = points_within(*volume, 40);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  field->evaluate(x, {values, gradients});
  if (!slopes) return values;
  for (const Vec3& g : gradients) values.insert(values.end(), {g.x, g.y, g.z});
  return values;
}

TEST(Magnitudes, OfValuesOnlyScaleTheField) {
  for (const VolumeMethod* const info : VolumeMethod::registry().all()) {
    const bool anywhere = info->grids == "all";
    const std::vector<double> expected =
        answers(lattice_grid({5, 4, 6}, wave_of_magnitude), std::string(info->name), true);
    const std::vector<double> near =
        anywhere ? answers(scattered_grid(40, wave_of_magnitude), std::string(info->name), false)
                 : std::vector<double>();
    for (const double factor : {0x1p980, 0x1p-130}) {
      SCOPED_TRACE(std::string(info->name) + " " + std::to_string(std::ilogb(factor)));
      const VolumeFunction scaled = [&](const Vec3& x) { return factor * wave_of_magnitude(x); };
      const std::vector<double> found = answers(lattice_grid({5, 4, 6}, scaled), std::string(info->name), true);
      for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], factor * expected[i]) << i;
      if (!anywhere) continue;
      const std::vector<double> far = answers(scattered_grid(40, scaled), std::string(info->name), false);
      for (std::size_t i = 0; i < far.size(); ++i) ASSERT_EQ(far[i], factor * near[i]) << i;
    }
  }
}

/// A noisy vector field with components of different size, times a factor.
GridData vectors_times(double factor, double last = 1) {
  GridData data = lattice_grid({6, 5, 7}, wave_of_magnitude);
  std::vector<double> values;
  for (std::size_t i = 0; i < 6u * 5 * 7; ++i) {
    const Vec3 x = block_point(data.blocks[0], i);
    const double noise = std::sin(1e4 * static_cast<double>(i)) / 8, wave = wave_of_magnitude(x) + noise;
    values.insert(values.end(), {64 * factor * wave, factor * (std::cos(3 * x.y) - noise), factor * last * x.x});
  }
  data.blocks[0].point_arrays.set("f", values, 3);
  return data;
}

std::vector<double> vector_answers(const GridData& data, const std::string& method) {
  const auto volume = volume_of(data);
  const auto field = field_of(volume, method);
  const auto x = points_within(*volume, 40);
  std::vector<double> values(3 * x.size());
  field->evaluate(x, {values});
  return values;
}

TEST(Magnitudes, OfVectorsOnlyScaleTheField) {
  for (const VolumeMethod* const info : VolumeMethod::registry().all()) {
    const std::vector<double> expected = vector_answers(vectors_times(1), std::string(info->name));
    for (const double factor : {0x1p46, 0x1p-60}) {
      SCOPED_TRACE(std::string(info->name) + " " + std::to_string(std::ilogb(factor)));
      const std::vector<double> found = vector_answers(vectors_times(factor), std::string(info->name));
      for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], factor * expected[i]) << i;
    }
  }
}

/// Flow solvers leave such values in a direction without flow.
TEST(Magnitudes, OfOneComponentMayBeNegligible) {
  for (const VolumeMethod* const info : VolumeMethod::registry().all()) {
    SCOPED_TRACE(info->name);
    const std::vector<double> expected = vector_answers(vectors_times(1, 0), std::string(info->name));
    const std::vector<double> found = vector_answers(vectors_times(1, 1e-310), std::string(info->name));
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], i % 3 == 2 ? 1e-300 : 0) << i;
  }
}

/// Decay to zero is accepted or rejected independently of the unit.
TEST(Magnitudes, OfPeaksHaveNoEffect) {
  for (const double sharpness : {1 / 1.3, 1 / 0.3}) {
    const auto peak = [&](double factor) {
      return lattice_grid({12, 12, 12}, [=](const Vec3& x) {
        return factor * std::exp(-squared_norm(x - Vec3{0.5, 0.5, 0.5}) * 400 * sharpness);
      });
    };
    const std::vector<double> expected = answers(peak(1), "mls-detail", false);
    for (const double factor : {0x1p49, 0x1p51, 0x1p-49, 0x1p-52}) {
      SCOPED_TRACE(std::to_string(std::ilogb(factor)));
      const std::vector<double> found = answers(peak(factor), "mls-detail", false);
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], factor * expected[i], factor * 1e-30);
    }
  }
}

TEST(Magnitudes, OfTraitsOnlyScaleTheRange) {
  const auto traits_of = [](double factor) {
    const auto volume =
        volume_of(lattice_grid({8, 8, 8}, [&](const Vec3& x) { return factor * wave_of_magnitude(x); }));
    Progress progress;
    const VolumeValues values = volume_values(*volume, "f");
    return measure_volume_traits(*volume, values, noise_of_values(*volume, values, progress), progress);
  };
  const VolumeTraits moderate = traits_of(1), huge = traits_of(0x1p990);
  EXPECT_EQ(huge.range, 0x1p990 * moderate.range);
  EXPECT_EQ(huge.left_out, moderate.left_out);
  EXPECT_EQ(huge.noise, moderate.noise);
}

TEST(Magnitudes, OutOfRangeAreErrors) {
  Progress progress;
  const auto error_of = [&](const VolumeFunction& f, const std::string& method) -> std::string {
    try {
      VolumeReconstructionOptions options;
      options.method = method;
      reconstruct_volume(volume_of(lattice_grid({5, 5, 5}, f)), "f", options, progress);
    } catch (const DataError& error) {
      return error.what();
    }
    return {};
  };
  const auto linear = "linear", detail = "mls-detail";
  EXPECT_NE(error_of([](const Vec3& x) { return 1e308 * x.x; }, linear).find("too large"), std::string::npos);
  EXPECT_NE(error_of([](const Vec3& x) { return 1e-310 * x.x; }, linear).find("too small"), std::string::npos);
  EXPECT_NE(error_of([](const Vec3&) { return std::nan(""); }, linear).find("no finite value"), std::string::npos);
  // A single number that dwarfs all others.
  const auto spike = [](const Vec3& x) { return x == Vec3{0.5, 0.5, 0.5} ? 1e60 : wave_of_magnitude(x); };
  EXPECT_NE(error_of(spike, detail).find("values of up to 1e+60 stand so far apart"), std::string::npos);
  EXPECT_NE(error_of(spike, detail).find("`fill_value`"), std::string::npos);
  EXPECT_EQ(error_of(spike, linear), "");
}

TEST(Magnitudes, LengthsOfVectorsAreRight) {
  EXPECT_EQ(safe_norm({3, 4, 0}), 5);
  EXPECT_EQ(safe_norm(Vec3{3, 4, 0} * 0x1p900), 5 * 0x1p900);
  EXPECT_EQ(safe_norm(Vec3{3, 4, 0} * 0x1p-900), 5 * 0x1p-900);
  EXPECT_EQ(safe_norm({0, 0, 0}), 0);
  EXPECT_EQ(vector_length(std::vector<double>{3e300, 4e300}), vector_length(std::vector<double>{4e300, 3e300}));
  EXPECT_NEAR(vector_length(std::vector<double>{3e300, 4e300}), 5e300, 1e286);
  EXPECT_EQ(vector_length(std::vector<double>{0, 0}), 0);
}

}  // namespace
}  // namespace sansmesh::test
