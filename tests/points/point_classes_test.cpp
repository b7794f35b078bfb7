#include "sansmesh/points/cleaning/point_classes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/points/prepare_cloud.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

PointClasses of(std::initializer_list<int> numbers) {
  PointClasses classes;
  for (const int c : numbers) classes.set(static_cast<std::size_t>(c));
  return classes;
}

TEST(PointClasses, NamesNumbersAndRanges) {
  EXPECT_EQ(parse_point_classes("ground"), of({2}));
  EXPECT_EQ(parse_point_classes("2"), of({2}));
  EXPECT_EQ(parse_point_classes(" Ground, BUILDING ,9"), of({2, 6, 9}));
  EXPECT_EQ(parse_point_classes("3-5"), parse_point_classes("vegetation"));
  EXPECT_EQ(parse_point_classes("low-vegetation,medium-vegetation,high-vegetation"), of({3, 4, 5}));
  EXPECT_EQ(parse_point_classes("noise"), of({7, 18}));
  EXPECT_EQ(parse_point_classes("wire"), of({13, 14, 16}));
  EXPECT_EQ(parse_point_classes("0-255").count(), 256u);
  EXPECT_EQ(parse_point_classes("64,255"), of({64, 255}));
  // Each name has a distinct number.
  std::size_t named = 0;
  for (unsigned c = 0; c < 256; ++c) {
    const std::string_view name = point_class_name(c);
    if (name.empty()) continue;
    EXPECT_EQ(parse_point_classes(name), of({static_cast<int>(c)})) << name;
    ++named;
  }
  EXPECT_EQ(named, 23u);
}

TEST(PointClasses, WhatIsNoClassIsRefusedWithAllNames) {
  for (const char* list :
       {"grund", "", "ground,", "256", "-1", "5-3", "3-", "2.5", "2 3", "ground building", "3-500"}) {
    try {
      parse_point_classes(list);
      ADD_FAILURE() << list;
    } catch (const ArgumentError& error) {
      const std::string what = error.what();
      for (const char* name : {"ground", "building", "water", "vegetation", "noise", "3-5"})
        EXPECT_NE(what.find(name), std::string::npos) << what;
    }
  }
}

template <class T>
PointSet classified(const char* name, std::size_t n) {
  std::mt19937 random(1);
  PointSet points;
  std::vector<T> classes;
  for (std::size_t i = 0; i < n; ++i) {
    points.positions.push_back({static_cast<float>(i), 0, 1});
    classes.push_back(static_cast<T>(random() % 7));
  }
  points.attributes.set(name, std::move(classes));
  return points;
}

/// Selects the points of the classes, in order, for all number types and attribute names.
TEST(PointClasses, ChooseAmongPoints) {
  const auto expect = [](const PointSet& all) {
    const Attribute& classes = *find_point_classes(all);
    std::vector<Vec3f> wanted;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (classes.number(i) == 2 || classes.number(i) == 5) wanted.push_back(all.positions[i]);
    PointSet kept = all;
    keep_classes(kept, of({2, 5, 200}));
    EXPECT_EQ(kept.positions, wanted);
    EXPECT_EQ(kept.attributes[0].rows(), wanted.size());
    const auto counts = count_point_classes(classes);
    EXPECT_EQ(counts[2] + counts[5], wanted.size());
    EXPECT_EQ(counts[0] + counts[1] + counts[2] + counts[3] + counts[4] + counts[5] + counts[6], all.size());
  };
  expect(classified<std::uint8_t>("classification", 3000));
  expect(classified<double>("Classification", 3000));
  expect(classified<float>("scalar_Classification", 3000));
  expect(classified<std::int64_t>("class", 3000));
}

TEST(PointClasses, NoneAndNothingLeftAreErrors) {
  PointSet bare;
  bare.positions.resize(5);
  EXPECT_EQ(find_point_classes(bare), nullptr);
  EXPECT_THROW(keep_classes(bare, of({2})), DataError);
  PointSet points;
  points.positions.resize(3);
  points.attributes.set("classification", std::vector<std::uint8_t>{1, 6, 77});
  try {
    keep_classes(points, of({2}));
    ADD_FAILURE();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("1 (unclassified), 6 (building), 77"), std::string::npos) << error.what();
  }
  EXPECT_EQ(points.size(), 3u);
  points.attributes.set("classification", std::vector<float>{-3, std::nanf(""), 1e9f});
  EXPECT_THROW(keep_classes(points, ~PointClasses()), DataError);
  EXPECT_EQ(count_point_classes(points.attributes[0])[0], 0u);
}

/// Preparing a cloud with additional points of other classes equals preparing it without them.
TEST(PointClasses, ArePartOfTheUseOfClouds) {
  PointSet cloud = test::sphere(2000);
  cloud.attributes.clear();
  PointSet mixed = cloud;
  std::vector<std::uint8_t> classes(mixed.size(), 2);
  for (int i = 0; i < 500; ++i) {
    mixed.positions.push_back({3.0f * static_cast<float>(i), 40, 1});
    if (mixed.has_normals()) mixed.normals.push_back({0, 0, 1});
    if (mixed.has_colors()) mixed.colors.push_back({});
    classes.push_back(5);
  }
  mixed.attributes.set("classification", classes);
  Progress progress;
  CloudPreparation ground;
  ground.classes = parse_point_classes("ground");
  const PreparedCloud wanted = prepare_cloud(cloud, {}, progress), chosen = prepare_cloud(mixed, ground, progress);
  EXPECT_EQ(chosen.points.positions, wanted.points.positions);
  EXPECT_EQ(chosen.points.normals, wanted.points.normals);
  EXPECT_EQ(chosen.frame, wanted.frame);
  ground.classes = parse_point_classes("water");
  EXPECT_THROW(prepare_cloud(mixed, ground, progress), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
