#include "sansmesh/points/orientation/inward_parts.h"

#include <gtest/gtest.h>

#include "points/shapes.h"
#include "sansmesh/points/prepare_cloud.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

PointSet facing_in(PointSet points) {
  for (Vec3f& n : points.normals) n = -n;
  return points;
}

PointSet both(PointSet a, const PointSet& b) {
  append(a, b);
  return a;
}

const PointSet& outer() {
  static const PointSet points = sample_sphere(6000, 1, 0, 1);
  return points;
}
const PointSet& inner() {
  static const PointSet points = sample_sphere(2000, 0.6f, 0, 2);
  return points;
}
const PointSet& beside() {
  static const PointSet points = sample_sphere(1500, 0.5f, 0, 3, {3, 0, 0});
  return points;
}

/// Expects these normals of a cloud after its preparation, and a warning if they differ from the given ones.
void expect_prepared(const PointSet& given, const PointSet& expected) {
  Progress progress;
  const PreparedCloud cloud = prepare_cloud(given, {}, progress);
  EXPECT_EQ(cloud.points.normals, expected.normals);
  EXPECT_EQ(cloud.notes.size(), given.normals == expected.normals ? 0u : 1u);
  EXPECT_FALSE(cloud.oriented_by);
}

TEST(InwardParts, EachPartFacesOutward) {
  expect_prepared(both(outer(), facing_in(beside())), both(outer(), beside()));
  expect_prepared(both(facing_in(outer()), beside()), both(outer(), beside()));
  expect_prepared(both(facing_in(outer()), facing_in(beside())), both(outer(), beside()));
}

TEST(InwardParts, CavitiesStay) {
  const PointSet shell = both(outer(), facing_in(inner()));
  expect_prepared(shell, shell);
  expect_prepared(both(shell, facing_in(beside())), both(shell, beside()));
  // A shell that is inverted as a whole.
  expect_prepared(facing_in(shell), shell);
  // A body in the cavity faces outward.
  const PointSet core = sample_sphere(500, 0.3f, 0, 4);
  expect_prepared(both(shell, facing_in(core)), both(shell, core));
}

TEST(InwardParts, PartsOfOneInvertedAssemblyTurnTogether) {
  expect_prepared(facing_in(both(outer(), inner())), both(outer(), inner()));
}

TEST(InwardParts, OpenPartsStay) {
  PointSet bowl;
  const PointSet ball = sample_sphere(3000, 0.8f, 0, 5, {-4, 0, 0});
  for (std::size_t i = 0; i < ball.size(); ++i)
    if (ball.positions[i].z < 0.1f)
      bowl.positions.push_back(ball.positions[i]), bowl.normals.push_back(-ball.normals[i]);
  expect_prepared(both(outer(), bowl), both(outer(), bowl));
  expect_prepared(both(both(outer(), bowl), facing_in(beside())), both(both(outer(), bowl), beside()));
}

TEST(InwardParts, DoNotDependOnTheNumberOfThreads) {
  const PointSet given = both(both(outer(), facing_in(inner())), facing_in(beside()));
  test::expect_equal_for_any_threads([&] {
    PointSet points = given;
    Progress progress;
    EXPECT_EQ(flip_inward_parts(points, 0, false, progress), beside().size());
    return points.normals;
  });
}

}  // namespace
}  // namespace sansmesh::inline v1
