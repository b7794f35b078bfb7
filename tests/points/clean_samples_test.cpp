#include "sansmesh/points/cleaning/clean_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sansmesh/points/cleaning/duplicates.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(CleanSamples, LeavesCleanCloudsAlone) {
  for (const std::size_t n : {0u, 1u, 20u, 5000u}) {
    PointSet cloud = test::sphere(n);
    const SampleCleaning cleaning = clean_samples(cloud);
    EXPECT_EQ(cleaning.non_finite + cleaning.far_away + cleaning.duplicates, 0u);
    EXPECT_EQ(cloud.size(), n);
  }
}

TEST(CleanSamples, TakesOutWhatIsNoNumber) {
  PointSet cloud = test::sphere(3000);
  cloud.positions[7] = {kNan, 0, 0};
  cloud.positions[8][1] = std::numeric_limits<float>::infinity();
  cloud.normals[9] = {0, kNan, 1};
  EXPECT_EQ(clean_samples(cloud).non_finite, 3u);
  EXPECT_EQ(cloud.size(), 2997u);
  EXPECT_EQ(cloud.normals.size(), 2997u);
}

TEST(CleanSamples, TakesOutFarSamplesButNoParts) {
  for (const float distance : {6.0f, 1e3f, 1e9f}) {
    PointSet cloud = test::sphere(3000);
    cloud.positions.push_back({distance, 0, 0});
    cloud.normals.push_back({1, 0, 0});
    EXPECT_EQ(clean_samples(cloud).far_away, 1u) << distance;
    EXPECT_EQ(cloud.size(), 3000u);
  }
  PointSet two = test::sphere(3000);
  for (std::size_t i = 0; i < 60; ++i) {  // 2 % of the samples, far away
    two.positions.push_back(Vec3f{50, 0, 0} + two.positions[50 * i]);
    two.normals.push_back(two.normals[50 * i]);
  }
  EXPECT_EQ(clean_samples(two).far_away, 0u);
}

TEST(CleanSamples, TakesOutDuplicatesWhereTheyAreMany) {
  for (const std::size_t n : {2000u, 60000u}) {
    PointSet cloud = test::sphere(n);
    const PointSet once = cloud;
    for (int copy = 0; copy < 2; ++copy) {
      cloud.positions.insert(cloud.positions.end(), once.positions.begin(), once.positions.end());
      cloud.normals.insert(cloud.normals.end(), once.normals.begin(), once.normals.end());
    }
    EXPECT_NEAR(duplicate_share(cloud), 2.0 / 3, 0.02);
    EXPECT_EQ(clean_samples(cloud).duplicates, 2 * n);
    EXPECT_EQ(cloud.positions, once.positions);
  }
  PointSet few = test::sphere(5000);
  few.positions[10] = few.positions[11];
  EXPECT_EQ(clean_samples(few).duplicates, 0u);
}

TEST(CleanSamples, WhatIsBesideManyAtOnePlaceIsNotFarAway) {
  PointSet cloud = test::sphere(300);
  cloud.positions.insert(cloud.positions.begin() + 50, 200000, Vec3f{});
  cloud.normals.insert(cloud.normals.begin() + 50, 200000, Vec3f{0, 0, 1});
  const SampleCleaning cleaning = clean_samples(cloud);
  EXPECT_EQ(cleaning.far_away, 0u);
  EXPECT_EQ(cleaning.duplicates, 199999u);
  EXPECT_EQ(cloud.size(), 301u);
}

}  // namespace
}  // namespace sansmesh::inline v1
