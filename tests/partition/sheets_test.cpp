// Connected sheets of a function, and the samples that represent them.
#include <algorithm>
#include <numbers>
#include <random>

#include "partition/edit_checks.h"
#include "sansmesh/partition/far/sheets.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

PointSet flipped(PointSet cloud) {
  for (Vec3f& n : cloud.normals) n = n * -1.0f;
  return cloud;
}

TEST(FindSheets, SeparateAndConcentricSpheres) {
  const PointSet separate = joined(sphere(10000), sphere(3600), 0.6f, {2.5f, 0, 0});
  const PointSet concentric = joined(sphere(10000), flipped(sphere(3600)), 0.6f);
  for (const PointSet& cloud : {separate, concentric}) {
    const Fitted f = fit(cloud);
    const Sheets sheets = find_sheets(f.data, f.positions);
    ASSERT_EQ(sheets.size(), 2u);
    const double sphere = 4 * std::numbers::pi;
    EXPECT_NEAR(sheets.area[0], sphere, 0.05 * sphere);
    EXPECT_NEAR(sheets.area[1], 0.36 * sphere, 0.05 * 0.36 * sphere);
    EXPECT_NEAR(sheets.evidence[0], 1, 0.1);
    EXPECT_NEAR(sheets.evidence[1], 1, 0.1);
    for (std::size_t i = 0; i < f.data.supports.size(); ++i) {
      const Vec3f foot = f.data.supports[i].foot;
      const bool small = std::min(norm(foot - Vec3f{2.5f, 0, 0}), norm(foot)) < 0.8f;
      EXPECT_EQ(sheets.of_support[i], small ? 1u : 0u) << norm(foot);
    }
    const Sheets bare = find_sheets(f.data, {});
    EXPECT_EQ(bare.of_support, sheets.of_support);
    EXPECT_EQ(bare.evidence, std::vector<double>(2, 0));
  }
}

TEST(FindSheets, StraysMakeSheetsThatNothingStandsFor) {
  PointSet cloud = sphere(20000);
  std::mt19937 random(2);
  std::normal_distribution<float> gauss;
  for (int i = 0; i < 30; ++i) {
    cloud.positions.push_back(Vec3f{2, 2, 2} + Vec3f{gauss(random), gauss(random), gauss(random)} * 0.15f);
    cloud.normals.push_back(normalized(Vec3f{gauss(random), gauss(random), gauss(random)}));
  }
  const Fitted f = fit(cloud);
  const Sheets sheets = find_sheets(f.data, f.positions);
  ASSERT_GE(sheets.size(), 2u);
  EXPECT_NEAR(sheets.evidence[0], 1, 0.1);
  for (std::size_t k = 1; k < sheets.size(); ++k)
    EXPECT_TRUE(sheets.evidence[k] < kLeastEvidence || sheets.area[k] < 0.01 * sheets.area[0])
        << k << ": " << sheets.evidence[k] << ", " << sheets.area[k];
  for (std::size_t i = 0; i < f.data.supports.size(); ++i)
    EXPECT_EQ(sheets.of_support[i] == 0, norm(f.data.functions[i].center) < 1.5f);
}

TEST(FindSheets, CreasesDoNotCutASheet) {
  for (const std::size_t n : {3000, 20000}) {
    const Fitted f = fit(cube(n));
    ASSERT_GT(f.data.report.creased, 10u);
    const Sheets sheets = find_sheets(f.data, f.positions);
    EXPECT_EQ(sheets.size(), 1u);
    EXPECT_NEAR(sheets.area[0], 24, n < 10000 ? 6 : 3.6);  // only the first piece of creased supports counts
    EXPECT_NEAR(sheets.evidence[0], 1, 0.1);
  }
}

/// Both faces of a square plate of edge 2, with or without its rim.
PointSet plate(float thickness, bool rim) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointSet cloud;
  for (int i = 0; i < 30000; ++i) {
    const float side = i % 2 ? 1.0f : -1.0f;
    cloud.positions.push_back({uniform(random), uniform(random), side * 0.5f * thickness});
    cloud.normals.push_back({0, 0, side});
  }
  const int around = rim ? static_cast<int>(30000 * thickness) : 0;
  for (int i = 0; i < around; ++i) {
    const std::size_t axis = static_cast<std::size_t>(i / 2 % 2);
    Vec3f p{uniform(random), uniform(random), 0.5f * thickness * uniform(random)}, n;
    p[axis] = n[axis] = i % 2 ? 1.0f : -1.0f;
    cloud.positions.push_back(p), cloud.normals.push_back(n);
  }
  return cloud;
}

TEST(FindSheets, SidesOfAPlateAreJoinedByItsRimAlone) {
  // Parallel sides that face away from each other are two sheets at any distance; the rim, if sampled, joins them.
  const Fitted open = fit(plate(0.2f, false));
  const Sheets two = find_sheets(open.data, open.positions);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_NEAR(two.area[0], 4, 1);  // the blocks at the rim are filled
  EXPECT_NEAR(two.area[1], 4, 1);
  for (std::size_t i = 0; i < open.data.supports.size(); ++i)
    EXPECT_EQ(two.of_support[i] == two.of_support[0],
              (open.data.functions[i].nu.z > 0) == (open.data.functions[0].nu.z > 0));
  const Fitted closed = fit(plate(0.2f, true));
  EXPECT_EQ(find_sheets(closed.data, closed.positions).size(), 1u);
}

TEST(FindSheets, ConstantsAreOnNone) {
  const Fitted f = fit(sphere(8000));
  const Selection chosen = in_ball(f.data, {0, 0, 1}, 0.3f);
  const EditResult edited = set_constant(f.data, chosen, 1);
  const Sheets sheets = find_sheets(edited.data, f.positions);
  EXPECT_EQ(sheets.size(), 1u);
  for (const std::uint32_t i : chosen) EXPECT_EQ(sheets.of_support[i], Sheets::kNone);
  // The erased part divides a sheet in two.
  SupportQuery band;
  band.box = Box3f{{-2, -2, -0.15f}, {2, 2, 0.15f}};
  const EditResult halves = set_constant(f.data, select_supports(f.data, band), 1);
  EXPECT_EQ(find_sheets(halves.data, f.positions).size(), 2u);
}

TEST(FindSheets, DoNotDependOnTheThreads) {
  const Fitted f = fit(cube(8000));
  test::compare_threads([&] { return find_sheets(f.data, f.positions); },
                        [](const Sheets& one, const Sheets& many) {
                          EXPECT_EQ(one.of_support, many.of_support);
                          EXPECT_EQ(one.area, many.area);
                          EXPECT_EQ(one.evidence, many.evidence);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
