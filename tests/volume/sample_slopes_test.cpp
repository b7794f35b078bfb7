#include "sansmesh/volume/samples/sample_slopes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "volume/volume_grids.h"

namespace sansmesh::inline v1 {
namespace {

struct Slopes {
  SampledVolume volume;
  std::vector<double> values;
};

Slopes slopes_of(const GridData& data, const test::VolumeFunction& f) {
  Progress progress;
  Slopes s{assemble_volume(data, Association::points, progress), {}};
  for (std::size_t i = 0; i < s.volume.size(); ++i) s.values.push_back(f(s.volume.position(i)));
  return s;
}

TEST(SampleSlopes, OfALinearFunctionAreExactOnEveryGrid) {
  const auto f = test::linear_function;
  for (const GridData& data : {test::lattice_grid({7, 8, 9}, f), test::stretched_grid({7, 8, 9}, f),
                               test::tetrahedra_grid({6, 6, 6}, f), test::scattered_grid(500, f)}) {
    const Slopes s = slopes_of(data, f);
    const SampleSlopes slopes(s.volume, s.values);
    for (std::size_t i = 0; i < s.volume.size(); ++i) {
      EXPECT_NEAR(norm(slopes.gradient(i) - test::kLinearGradient), 0, 1e-6) << i;
      EXPECT_GT(slopes.spacing(i), 0);
      EXPECT_GT(slopes.contrast(i), 0);
    }
  }
}

TEST(SampleSlopes, SpacingIsTheStepAndVolumesFillTheLattice) {
  const Slopes s = slopes_of(test::lattice_grid({11, 11, 11}, test::linear_function), test::linear_function);
  const SampleSlopes slopes(s.volume, s.values);
  double sum = 0;
  for (std::size_t i = 0; i < s.volume.size(); ++i) {
    EXPECT_NEAR(slopes.spacing(i), 0.1, 1e-12);
    sum += slopes.volume(i);
  }
  EXPECT_NEAR(sum, 1.1 * 1.1 * 1.1, 1e-9);  // each sample at the centre of its cube
}

/// Cells four times as long along y as along x, as a lattice and as a curvilinear block.
TEST(SampleSlopes, FlatCellsHaveTheirOwnSpacingInEachDirection) {
  const GridBlock lattice = test::lattice_block({9, 9, 9}, {0, 0, 0}, {1, 4, 2});
  const auto same = [](const Vec3& x) { return x; };
  for (const GridBlock& block : {lattice, test::curvilinear_block(lattice, same)}) {
    const Slopes s = slopes_of(test::one_block(block, test::linear_function), test::linear_function);
    const SampleSlopes slopes(s.volume, s.values);
    for (std::size_t i = 0; i < s.volume.size(); ++i) {
      const Vec3 x = s.volume.position(i);
      if (x.x < 0.1 || x.x > 0.9 || x.y < 0.4 || x.y > 3.6 || x.z < 0.2 || x.z > 1.8) continue;
      EXPECT_NEAR(slopes.spacing_along(i, {1, 0, 0}), 0.125, 1e-9);
      EXPECT_NEAR(slopes.spacing_along(i, {0, 1, 0}), 0.5, 1e-9);
      EXPECT_NEAR(slopes.volume(i), 0.125 * 0.5 * 0.25, 1e-9);
    }
  }
}

/// A border ten times fainter at one end than at the other is steepest in one plane everywhere: larger gradients along
/// the border do not count.
TEST(SampleSlopes, SteepestAcrossFollowsABorderThatFades) {
  const auto f = [](const Vec3& x) { return std::pow(10.0, -x.y) * std::tanh((x.x - 0.5) / 0.08); };
  for (const bool lattice : {true, false}) {
    const GridData data = lattice ? test::lattice_grid({25, 25, 9}, f) : test::tetrahedra_grid({25, 25, 9}, f);
    const Slopes s = slopes_of(data, f);
    const SampleSlopes slopes(s.volume, s.values);
    std::vector<float> steep(s.volume.size());
    for (std::size_t i = 0; i < steep.size(); ++i) steep[i] = static_cast<float>(norm(slopes.gradient(i)));
    const std::vector<float> most = steepest_across(s.volume, slopes, steep, 0.01);
    std::size_t on_border = 0;
    for (std::size_t i = 0; i < steep.size(); ++i) {
      const Vec3 x = s.volume.position(i);
      if (x.y < 0.1 || x.y > 0.9 || x.z < 0.2 || x.z > 0.8) continue;
      if (std::abs(x.x - 0.5) < 1e-9) {
        EXPECT_EQ(most[i], steep[i]);
        ++on_border;
      } else if (std::abs(x.x - 0.5) < 2.1 / 24) {
        EXPECT_GT(most[i], 1.1f * steep[i]);
      }
    }
    EXPECT_GT(on_border, 50u);
  }
}

TEST(SampleSlopes, SteepestAcrossIgnoresFlatRegions) {
  const Slopes s = slopes_of(test::lattice_grid({9, 9, 9}, test::linear_function), test::linear_function);
  const SampleSlopes slopes(s.volume, s.values);
  const std::vector<float> steep(s.volume.size(), 2);
  for (const float most : steepest_across(s.volume, slopes, steep, 3)) EXPECT_EQ(most, 0);
  for (const float most : steepest_across(s.volume, slopes, steep, 1)) EXPECT_EQ(most, 2);
}

}  // namespace
}  // namespace sansmesh::inline v1
