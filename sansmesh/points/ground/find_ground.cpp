#include "sansmesh/points/ground/find_ground.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/ground/ground_grid.h"
#include "sansmesh/points/ground/ground_growth.h"
#include "sansmesh/points/ground/ground_seeds.h"
#include "sansmesh/points/ground/ground_trend.h"

namespace sansmesh::inline v1 {
namespace {

/// Grids that vote: edge of the cells in spacings, and shift in cells. The result of a single one depends on the chance
/// that puts samples into cells: the mean Kappa of four ISPRS samples rises by 1 %.
struct VotingGrid {
  double edge, shift;
};
constexpr std::array<VotingGrid, 3> kGrids{{{1, 0}, {1.1, 0.5}, {0.9, 0.25}}};
/// Rounds of trend and seeds.
constexpr int kSeedRounds = 2;
/// For the lowest samples of cells, and for all others.
constexpr double kTolerance = 0.15, kOtherTolerance = 0.2, kDeviations = 0.5, kSlope = 0.05, kOtherSlope = 0.1;

std::vector<std::uint8_t> ground_of_grid(const PointSet& points, const GroundGrid& grid,
                                         std::vector<std::uint8_t> ground) {
  grow_ground(points, grid, ground, {kTolerance, kDeviations, kSlope * grid.cell});
  std::vector<std::uint8_t> samples(points.size(), 0);
  const GroundTolerance others{kOtherTolerance, kDeviations, kOtherSlope * grid.cell};
  parallel_for(0, points.size(), 1024, [&](std::size_t i) {
    const std::uint32_t cell = grid.cell_of[i];
    if (cell == GroundGrid::kNone) return;
    samples[i] = grid.lowest[cell] == i ? ground[cell] : continues_ground(points, grid, ground, i, others);
  });
  return samples;
}

}  // namespace

GroundSamples find_ground(const PointSet& points, Progress& progress) {
  progress.begin("find ground");
  const auto extent = measure_survey(points);
  if (!extent) throw DataError("the points cover no area over x and y: there is no ground to find");
  GroundSamples result;
  result.cell = extent->spacing;
  result.ground.assign(points.size(), 0);
  GroundTrend trend;
  std::optional<GroundGrid> first;
  for (const VotingGrid& voting : kGrids) {
    GroundGrid grid =
        make_ground_grid(points, *extent, voting.edge * extent->spacing, voting.shift, first ? &*first : nullptr);
    std::vector<std::uint8_t> seeds = find_ground_seeds(points, grid, trend);
    if (!first)
      for (int round = 0; round < kSeedRounds; ++round) {
        trend = GroundTrend(points, grid, seeds);
        seeds = find_ground_seeds(points, grid, trend);
      }
    const std::vector<std::uint8_t> votes = ground_of_grid(points, grid, std::move(seeds));
    for (std::size_t i = 0; i < votes.size(); ++i)
      result.ground[i] = static_cast<std::uint8_t>(result.ground[i] + votes[i]);
    if (!first) first = std::move(grid);
  }
  for (std::uint8_t& g : result.ground) g = 2 * g > kGrids.size();
  result.count = static_cast<std::size_t>(std::count(result.ground.begin(), result.ground.end(), std::uint8_t{1}));
  return result;
}

}  // namespace sansmesh::inline v1
