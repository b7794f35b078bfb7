// Estimated errors of interpolation against the true ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volumes.h"
#include "support/sanitizers.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

double hills(const Vec3& x) {
  return std::sin(3 * x.x) * std::cos(2 * x.y + x.z) + std::exp(-12 * squared_norm(x - Vec3{0.4, 0.5, 0.45}));
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
  return rank;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size()), mean = (n - 1) / 2;
  double ab = 0, aa = 0;
  for (std::size_t i = 0; i < a.size(); ++i) ab += (a[i] - mean) * (b[i] - mean), aa += (a[i] - mean) * (a[i] - mean);
  return ab / aa;
}

VolumeModel model_for(GridData data, Association of) {
  for (GridBlock& b : data.blocks) (of == Association::cells ? b.point_arrays : b.cell_arrays).clear();
  VolumeModelOptions options;
  options.array = "f";
  if (of == Association::cells) options.reconstruction.cell_values = CellValues::centres;
  return {std::move(data), "made", options};
}

TEST(VolumeResolution, EstimatesTheErrorOfInterpolationOnEveryGrid) {
  SANSMESH_NOT_SANITIZED("judges accuracy");
  const std::size_t n = 14;
  std::vector<NamedGrid> grids{{"uniform", lattice_grid({n, n, n}, hills)},
                               {"rectilinear", stretched_grid({n, n, n}, hills, 1.15)},
                               {"bent", bent_grid({n, n, n}, hills)},
                               {"tetrahedra", tetrahedra_grid({n, n, n}, hills)},
                               {"mixed", mixed_grid({n, n, n}, hills)},
                               {"blocks", three_overlapping_blocks(10, hills)},
                               {"levels", two_level_amr(16, hills), Association::cells}};
  for (NamedGrid& grid : grids) {
    SCOPED_TRACE(grid.name);
    const VolumeModel volume = model_for(std::move(grid.data), grid.association);
    Progress progress;
    const ResolutionResult found = estimate_resolution(volume, progress);
    const auto samples = volume.samples(progress);
    const auto linear = field_of(samples, "linear");
    const auto x = points_within(*samples, 40 * samples->size());
    std::vector<double> values(x.size());
    linear->evaluate(x, {values});
    std::vector<CellLocation> at(x.size());
    VolumeLocator(*samples).locate(x, at);
    std::vector<double> sum(samples->size(), 0.0), count(samples->size(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double e = std::abs(values[i] - hills(x[i]));
      const auto add = [&](std::size_t s) { sum[s] += e, count[s] += 1; };
      if (samples->in_cells)
        add(samples->cell_sample[at[i].cell]);
      else
        for (std::size_t c = 0; c < at[i].corner_count; ++c) add(at[i].corners[c]);
    }
    const std::vector<double>& estimated = *found.samples->attributes.find("error")->as<double>();
    std::vector<double> truth, guess;
    for (std::size_t i = 0; i < sum.size(); ++i)
      if (count[i] > 20) truth.push_back(sum[i] / count[i]), guess.push_back(estimated[i]);
    ASSERT_GT(truth.size(), samples->size() / 2);
    const double mean = std::accumulate(truth.begin(), truth.end(), 0.0) / static_cast<double>(truth.size());
    EXPECT_GT(found.report.mean, mean / 1.5);
    EXPECT_LT(found.report.mean, mean * 1.5);
    EXPECT_GT(correlation(ranks(truth), ranks(guess)), 0.85);
  }
}

/// Twice as many samples per length have a quarter of the error; the factor of the report reaches what it promises.
TEST(VolumeResolution, TellsHowMuchFiner) {
  SANSMESH_NOT_SANITIZED("judges accuracy");
  const auto report_of = [](std::size_t n) {
    Progress progress;
    return estimate_resolution(model_for(bent_grid({n, n, n}, hills), Association::points), progress).report;
  };
  const ResolutionReport coarse = report_of(9), fine = report_of(17);
  EXPECT_GT(coarse.mean / fine.mean, 3);
  EXPECT_LT(coarse.mean / fine.mean, 5);
  ASSERT_GT(coarse.finer, 1.2);
  const auto needed = static_cast<std::size_t>(std::ceil(8 * coarse.finer)) + 1;
  const ResolutionReport enough = report_of(needed);
  EXPECT_LT(enough.high, 0.013 * enough.range);
  EXPECT_GT(enough.high, 0.005 * enough.range);
}

TEST(VolumeResolution, SamplesWithoutValueHaveNoError) {
  GridData data = lattice_grid({12, 12, 12}, hills);
  std::vector<double> values(12 * 12 * 12);
  const Attribute& made = *data.blocks[0].point_arrays.find("f");
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = made.number(i);
  for (const std::size_t i : {5u, 700u, 701u}) values[i] = std::numeric_limits<double>::quiet_NaN();
  data.blocks[0].point_arrays.set("f", values);
  Progress progress;
  const ResolutionResult found = estimate_resolution(model_for(std::move(data), Association::points), progress);
  const Attribute& errors = *found.samples->attributes.find("error");
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(std::isnan(errors.number(i)), std::isnan(values[i])) << i;
  EXPECT_TRUE(std::isfinite(found.report.mean));
  EXPECT_GE(found.report.most, found.report.high);
}

TEST(VolumeResolution, IsOfWholeVectors) {
  GridData data = lattice_grid({6, 6, 6}, hills);
  std::vector<double> vectors(std::size_t{2} * 6 * 6 * 6);
  for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = std::sin(static_cast<double>(i));
  data.blocks[0].point_arrays.set("v", vectors, 2);
  VolumeModelOptions options;
  options.array = "v:x";
  Progress progress;
  EXPECT_THROW(estimate_resolution(VolumeModel(std::move(data), "made", options), progress), ArgumentError);
}

TEST(VolumeResolution, OfLinearFunctionsIsPerfect) {
  Progress progress;
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const ResolutionResult found = estimate_resolution(model_for(grid.data, grid.association), progress);
    EXPECT_LT(found.report.most, 1e-5 * found.report.range);
    EXPECT_EQ(found.report.finer, 1);
  }
}

}  // namespace
}  // namespace sansmesh::test
