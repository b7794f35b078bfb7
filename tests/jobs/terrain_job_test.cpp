// Tests of tiles and height grids.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>

#include "sansmesh/convert.h"
#include "sansmesh/error.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

/// Terrain of 300 × 200, a sample per 4 units of area, in coordinates of a survey.
PointSet survey() {
  PointSet points;
  points.origin = {511900, 5402950, 400};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < 15000; ++i) {
    const double x = 300 * uniform(random), y = 200 * uniform(random);
    points.positions.push_back(Vec3f(Vec3{x, y, 5 * std::sin(x / 40) + 3 * std::cos(y / 30)}));
    numbers.push_back(i);
  }
  points.attributes.set("number", std::move(numbers));
  return points;
}

SplitResult tiles_of(const PointSet& points, double size) {
  Progress progress;
  return split(CloudOrMesh(points), {.tile_size = size}, progress);
}

TEST(Tiles, HoldEverySampleOnce) {
  const PointSet points = survey();
  const SplitResult made = tiles_of(points, 100);
  // 511900 to 512200 and 5402950 to 5403150: the southern row starts at 5402900.
  ASSERT_EQ(made.parts.size(), 9u);
  EXPECT_EQ(made.places[0], "511900_5402900");
  EXPECT_EQ(made.places[8], "512100_5403100");
  std::set<std::uint32_t> seen;
  for (std::size_t k = 0; k < made.parts.size(); ++k) {
    const PointSet& part = made.parts[k].points;
    const double left = std::stod(made.places[k]),
                 bottom = std::stod(made.places[k].substr(made.places[k].find('_') + 1));
    const auto* const numbers = part.attributes.find<std::uint32_t>("number");
    ASSERT_TRUE(numbers);
    EXPECT_EQ(part.origin, points.origin);
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Vec3 p = part.origin + Vec3(part.positions[i]);
      EXPECT_TRUE(p.x >= left && p.x < left + 100 && p.y >= bottom && p.y < bottom + 100) << made.places[k];
      EXPECT_TRUE(seen.insert((*numbers)[i]).second);
      EXPECT_EQ(part.positions[i], points.positions[(*numbers)[i]]);
    }
  }
  EXPECT_EQ(seen.size(), points.size());
}

// Coordinates in hundredths, as in surveys, are not exact in float.
TEST(Tiles, BelongToTheirLeftAndLowerBorder) {
  for (const Vec3 origin : {Vec3{511234.37, 5402001.93, 0}, Vec3{0, 0, 0}, Vec3{-4321.11, 17.77, 0}}) {
    PointSet points;
    points.origin = origin;
    for (int k = -400; k <= 400; ++k)
      for (const double d : {-0.01, 0.0, 0.01}) {
        const double x = 25 * (k + std::round(origin.x / 25)) + d;
        points.positions.push_back({static_cast<float>(x - origin.x), static_cast<float>(1.0 - origin.y), 0});
      }
    const SplitResult made = tiles_of(points, 25);
    for (std::size_t k = 1; k + 1 < made.parts.size(); ++k) {
      const double left = std::stod(made.places[k]);
      const PointSet& part = made.parts[k].points;
      // The border itself, just after it, and just before the next one.
      ASSERT_EQ(part.size(), 3u) << made.places[k];
      for (const Vec3f& p : part.positions) {
        const double in = part.origin.x + static_cast<double>(p.x) - left;
        EXPECT_TRUE(in > -0.001 && in < 24.995) << in;
      }
    }
  }
}

// Floats at 10 km are 0.98 mm apart: the last one before a border is before it.
TEST(Tiles, HaveTheLastPositionBeforeABorder) {
  PointSet points;
  points.positions = {{std::nextafter(10000.0f, 0.0f), 5, 0}, {10000, 5, 0}};
  const SplitResult made = tiles_of(points, 100);
  EXPECT_EQ(made.places, (std::vector<std::string>{"9900_0", "10000_0"}));
}

TEST(Tiles, RefuseEqualNames) {
  PointSet points;
  points.origin = {0, 5403000, 0};
  for (int k = 0; k < 9; ++k) points.positions.push_back({0, 3e-6f * static_cast<float>(k), 0});
  EXPECT_THROW(tiles_of(points, 1e-6), DataError);
}

TEST(Tiles, RefuseBadOptions) {
  const PointSet points = survey();
  EXPECT_THROW(tiles_of(points, 0), ArgumentError);
  EXPECT_THROW(tiles_of(points, 1e-3), DataError);
  Progress progress;
  EXPECT_THROW(split(CloudOrMesh(points), {.tile_size = 10, .split_distance = 1}, progress), ArgumentError);
  PointSet mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(split(CloudOrMesh(mesh), {.tile_size = 10}, progress), DataError);
}

TEST(Tiles, OfAHeightGridFitTogether) {
  const PointSet points = survey();
  Progress progress;
  for (const double cell : {2.0, 2.5}) {
    const HeightGrid whole = make_height_grid(CloudOrMesh(points), {.cell = cell}, progress, {.tile_size = 100}).grid;
    const std::vector<HeightTile> tiles = split_height_grid(whole, 100);
    ASSERT_EQ(tiles.size(), 9u);
    std::size_t known = 0;
    for (const HeightTile& tile : tiles) {
      const HeightGrid& g = tile.grid;
      EXPECT_EQ(g.heights.width, std::lround(100 / cell));
      EXPECT_EQ(g.heights.height, std::lround(100 / cell));
      EXPECT_EQ(std::fmod(g.left, 100), 0);
      EXPECT_EQ(std::fmod(g.top, 100), 0);
      EXPECT_EQ(tile.place, std::to_string(std::lround(g.left)) + "_" + std::to_string(std::lround(g.top - 100)));
      for (int r = 0; r < g.heights.height; ++r)
        for (int c = 0; c < g.heights.width; ++c) {
          const float h = g.heights.at(c, r);
          if (std::isnan(h)) continue;
          ++known;
          const auto k = static_cast<int>(std::lround((g.left - whole.left) / cell)) + c;
          const auto j = static_cast<int>(std::lround((whole.top - g.top) / cell)) + r;
          ASSERT_EQ(h, whole.heights.at(k, j));
        }
    }
    std::size_t expected = 0;
    for (const float h : whole.heights.pixels) expected += std::isfinite(h);
    EXPECT_EQ(known, expected);
  }
  // The default cell divides the tiles; a given one must.
  const HeightGrid chosen = make_height_grid(CloudOrMesh(points), {}, progress, {.tile_size = 33}).grid;
  EXPECT_NEAR(33 / chosen.cell, std::round(33 / chosen.cell), 1e-9);
  EXPECT_GE(chosen.cell, 2);
  EXPECT_THROW(make_height_grid(CloudOrMesh(points), {.cell = 3}, progress, {.tile_size = 100}), ArgumentError);
  EXPECT_THROW(make_height_grid(CloudOrMesh(points), {.cell = 1}, progress, {.tile_size = 1e5}), ArgumentError);
  EXPECT_THROW(make_height_grid(CloudOrMesh(points), {}, progress, {.tile_size = -5}), ArgumentError);
  const HeightGrid grid = make_height_grid(CloudOrMesh(points), {.cell = 2}, progress).grid;
  for (const double size : {0.0, -2.0, 33.0, 1e5, 6e9, static_cast<double>(NAN), static_cast<double>(INFINITY)})
    EXPECT_THROW(split_height_grid(grid, size), ArgumentError) << size;
}

// A single run equals the run with neighbours: tiles of a survey have no seam.
TEST(HeightGrid, OfASurfaceHasTheCellsOfItsSamples) {
  const PointSet points = survey();
  Progress progress;
  const TerrainSamples samples = terrain_samples(points, false, progress);
  EXPECT_NEAR(samples.spacing, 2, 0.2);
  EXPECT_GT(samples.count, points.size() * 9 / 10);
  EXPECT_TRUE(has_note(samples.notes, "ground_found"));
  EXPECT_EQ(terrain_samples(points, true, progress).count, points.size());
  // A plane 7 above zero over the samples.
  TriangleMesh plane;
  plane.origin = points.origin;
  plane.vertices = {{0.1f, 0.1f, 7}, {299.9f, 0.1f, 7}, {299.9f, 199.9f, 7}, {0.1f, 199.9f, 7}};
  plane.triangles = {{0, 1, 2}, {0, 2, 3}};
  const HeightGridResult of_samples = make_height_grid(CloudOrMesh(points), {}, progress),
                         of_plane = make_height_grid(plane, samples, {}, progress);
  EXPECT_EQ(of_plane.report.cell, of_samples.report.cell);
  EXPECT_EQ(of_plane.report.samples, of_samples.report.samples);
  EXPECT_EQ(of_plane.grid.left, of_samples.grid.left);
  EXPECT_EQ(of_plane.grid.top, of_samples.grid.top);
  EXPECT_NEAR(of_plane.report.highest, 407, 1e-3);
  EXPECT_THROW(make_height_grid(plane, samples, {.gap = 3}, progress), ArgumentError);
}

TEST(HeightGrid, NamesBreaklinesOutside) {
  const PointSet points = survey();
  Progress progress;
  HeightGridUse use;
  use.breaklines.origin = points.origin;
  use.breaklines.positions = {{10, 10, 1}, {100, 100, 2}, {5000, 0, 1}, {5000, 10, 1}};
  use.breaklines.offsets = {0, 2, 4};
  const HeightGridResult made = make_height_grid(CloudOrMesh(points), {}, progress, use);
  EXPECT_EQ(made.report.breaklines, 1u);
  EXPECT_TRUE(has_note(made.notes, "breaklines_outside"));
  PointSet mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(make_height_grid(CloudOrMesh(mesh), {}, progress, use), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
