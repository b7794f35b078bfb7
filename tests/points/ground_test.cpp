#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/points/cleaning/point_classes.h"
#include "sansmesh/points/ground/classify_ground.h"
#include "sansmesh/points/ground/find_ground.h"
#include "sansmesh/points/ground/ground_grid.h"
#include "sansmesh/points/ground/height_raster.h"

namespace sansmesh::inline v1 {
namespace {

/// Samples of a scene of 200 × 200, one per unit of area, with known ground.
struct Scene {
  PointSet points;
  std::vector<std::uint8_t> ground;

  void add(const Vec3& p, bool is_ground) {
    points.positions.push_back(Vec3f(p));
    ground.push_back(is_ground);
  }

  void scale(float factor) {
    for (Vec3f& p : points.positions) p = p * factor;
  }
};

/// Height of the object at a place over the ground; 0 for none.
using Objects = std::function<double(double, double)>;
using Terrain = std::function<double(double, double)>;

Scene scene(const Terrain& terrain, const Objects& objects, double noise = 0.05) {
  Scene s;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 200);
  std::normal_distribution<double> gauss(0, noise);
  for (int i = 0; i < 40000; ++i) {
    const double x = uniform(random), y = uniform(random), object = objects(x, y);
    s.add({x, y, terrain(x, y) + object + gauss(random)}, object == 0);
  }
  return s;
}

double hills(double x, double y) { return 8 * std::sin(x / 25) + 6 * std::cos(y / 30) + 0.1 * x; }
double gentle(double x, double y) { return 3 * std::sin(x / 25) + 2 * std::cos(y / 30) + 0.05 * x; }
double nothing(double, double) { return 0; }

/// A hall of 60 × 44, houses with gables, and crowns of trees, through which a third of the samples passes.
double town(double x, double y) {
  if (std::abs(x - 50) < 30 && std::abs(y - 60) < 22) return 8;
  for (const double at : {130.0, 160.0})
    if (std::abs(x - at) < 6 && std::abs(y - 40) < 10) return 8 - 0.5 * std::abs(x - at);
  const double dx = std::fmod(x, 12.0) - 6, dy = std::fmod(y, 12.0) - 6, from_stem = std::hypot(dx, dy);
  const bool through = std::fmod(997 * x + 3 * y, 1.0) < 0.33;
  return y > 110 && from_stem < 4 && !through ? 12 - from_stem : 0;
}

struct Errors {
  double first, second;  ///< shares of ground that is rejected, and of objects that are accepted
};

Errors errors_of(const Scene& s) {
  Progress progress;
  const GroundSamples found = find_ground(s.points, progress);
  double ground = 0, rejected = 0, accepted = 0;
  for (std::size_t i = 0; i < s.ground.size(); ++i) {
    ground += s.ground[i];
    rejected += s.ground[i] && !found.ground[i];
    accepted += !s.ground[i] && found.ground[i];
  }
  return {rejected / ground, accepted / std::max(1.0, static_cast<double>(s.ground.size()) - ground)};
}

// Along the border, octagons lack corners: the parts that they are composed of end there.
TEST(HeightRaster, OpeningEqualsTheDefinitionInside) {
  constexpr int kColumns = 61, kRows = 49;
  HeightRaster raster{kColumns, kRows, {}};
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t i = 0; i < raster.columns * raster.rows; ++i)
    raster.heights.push_back(i % 7 == 3 ? std::numeric_limits<float>::quiet_NaN() : uniform(random));
  const std::vector<std::uint8_t> centers(raster.size(), 1);
  for (const int radius : {1, 2, 3, 5, 9}) {
    const HeightRaster found = opened(raster, static_cast<std::size_t>(radius), centers);
    // An octagon: a square and a square turned by 45°.
    const int turned = std::min(static_cast<int>(std::lround(0.29 * radius)), (radius - 1) / 2),
              straight = radius - 2 * turned;
    std::vector<std::pair<int, int>> octagon;
    for (int a = -radius; a <= radius; ++a)
      for (int b = -radius; b <= radius; ++b) {
        bool in = false;
        for (int p = -turned; p <= turned && !in; ++p)
          for (int q = -turned; q <= turned && !in; ++q)
            in = std::abs(a - p - q) <= straight && std::abs(b - p + q) <= straight;
        if (in) octagon.push_back({a, b});
      }
    const auto over = [&](const std::vector<float>& z, float none, auto better) {
      std::vector<float> result(z.size(), none);
      for (int r = 0; r < kRows; ++r)
        for (int c = 0; c < kColumns; ++c)
          for (const auto& [a, b] : octagon) {
            if (r + b < 0 || r + b >= kRows || c + a < 0 || c + a >= kColumns) continue;
            const float v = z[static_cast<std::size_t>((r + b) * kColumns + c + a)];
            float& to = result[static_cast<std::size_t>(r * kColumns + c)];
            if (better(v, to)) to = v;
          }
      return result;
    };
    constexpr float kNo = std::numeric_limits<float>::infinity();
    const auto least = over(raster.heights, kNo, [](float a, float b) { return a < b; });
    const auto expected = over(least, -kNo, [](float a, float b) { return a > b; });
    for (int r = 2 * radius; r < kRows - 2 * radius; ++r)
      for (int c = 2 * radius; c < kColumns - 2 * radius; ++c) {
        const auto k = static_cast<std::size_t>(r * kColumns + c);
        EXPECT_EQ(found.heights[k], expected[k]) << radius << ": " << c << ", " << r;
      }
  }
}

TEST(FindGround, BareTerrainIsGround) {
  EXPECT_LT(errors_of(scene(hills, nothing)).first, 0.005);
  // A slope of 45°, and a terrace with a wall of 5.
  EXPECT_LT(errors_of(scene([](double x, double) { return x; }, nothing)).first, 0.01);
  EXPECT_LT(errors_of(scene([](double x, double y) { return hills(x, y) + (x > 90 ? 5 : 0); }, nothing)).first, 0.02);
}

TEST(FindGround, BuildingsAndTreesAreNot) {
  const Errors flat = errors_of(scene([](double, double) { return 0.0; }, town));
  EXPECT_LT(flat.first, 0.005);
  EXPECT_LT(flat.second, 0.01);
  const Errors hilly = errors_of(scene(gentle, town));
  EXPECT_LT(hilly.first, 0.03);
  EXPECT_LT(hilly.second, 0.02);
}

TEST(FindGround, AnyUnitAndStraySamples) {
  Scene plain = scene(gentle, town), feet = plain;
  feet.scale(1 / 0.3048f);
  const Errors a = errors_of(plain), b = errors_of(feet);
  EXPECT_NEAR(a.first, b.first, 0.002);
  EXPECT_NEAR(a.second, b.second, 0.002);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(0, 200);
  for (int i = 0; i < 200; ++i) {
    const double x = uniform(random), y = uniform(random);
    plain.add({x, y, gentle(x, y) + (i % 2 ? -1 : 1) * (3 + 0.2 * uniform(random))}, false);
  }
  plain.add({1e6, 1e6, 0}, false);
  plain.add({std::numeric_limits<double>::quiet_NaN(), 0, 0}, false);
  const Errors c = errors_of(plain);
  EXPECT_LT(c.first, 0.03);
  EXPECT_LT(c.second, 0.02);
}

TEST(FindGround, NoAreaIsAnError) {
  Progress progress;
  PointSet line;
  EXPECT_THROW(find_ground(line, progress), DataError);
  for (int i = 0; i < 50; ++i) line.positions.push_back({static_cast<float>(i), 0, 0});
  EXPECT_THROW(find_ground(line, progress), DataError);
}

TEST(ClassifyGround, ExistingClassesStay) {
  Progress progress;
  Scene s = scene(gentle, town);
  std::vector<std::uint8_t> classes(s.points.size(), 1);
  for (std::size_t i = 0; i < 100; ++i) classes[i] = 6;
  s.points.attributes.set("classification", classes);
  const GroundClassification made = classify_ground(s.points, progress);
  EXPECT_EQ(made.kept, 100u);
  EXPECT_GT(made.ground, 20000u);
  const auto* const now = s.points.attributes.find<std::uint8_t>("classification");
  ASSERT_TRUE(now);
  EXPECT_EQ((*now)[5], 6);
  // A second run finds its own ground.
  EXPECT_TRUE(classify_ground(s.points, progress).had_ground);
  PointSet bare;
  bare.positions = s.points.positions;
  PointClasses ground;
  ground.set(2);
  const std::vector<Note> notes = select_classes(bare, ground, progress);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].code, "ground_found");
  EXPECT_LT(bare.size(), s.points.size());
  // With classes other than ground, there is nothing to find.
  PointClasses buildings;
  buildings.set(6);
  EXPECT_THROW(select_classes(bare, buildings, progress), DataError);
}

TEST(ClassifyGround, RefusesForeignNumbersAsClasses) {
  PointSet points;
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 10; ++k) points.positions.push_back({static_cast<float>(i), static_cast<float>(k), 0});
  points.attributes.set("class", std::vector<std::int32_t>(points.size(), 300));
  Progress progress;
  EXPECT_THROW(classify_ground(points, progress), DataError);
}

TEST(MeasureSurvey, SamplesOnALineCoverNoArea) {
  PointSet points;
  for (int i = 0; i < 200; ++i) points.positions.push_back({static_cast<float>(i), i % 2 ? 1e-31f : 0, 0});
  EXPECT_FALSE(measure_survey(points).has_value());
}

}  // namespace
}  // namespace sansmesh::inline v1
