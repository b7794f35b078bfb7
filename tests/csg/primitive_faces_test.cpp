// Faces of primitives: closed, oriented, of the primitive's volume, within the error.
#include "sansmesh/csg/primitive_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "sansmesh/csg/face_builder.h"
#include "sansmesh/csg/solid.h"

namespace sansmesh::test {
namespace {

constexpr double kPi = std::numbers::pi;

double volume_of(const SolidFaces& f) {
  double sum = 0;
  for (const auto& [a, b, c] : f.triangles) sum += dot(f.vertices[a], cross(f.vertices[b], f.vertices[c])) / 6;
  return sum;
}

void expect_closed(const SolidFaces& f) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : f.triangles)
    for (std::size_t e = 0; e < 3; ++e) ++edges[{t[e], t[(e + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(f.vertices.size(), 2 + f.triangles.size() / 2);
}

TEST(PrimitiveFaces, EncloseTheVolumeOfTheirPrimitive) {
  const Vec3 axis = normalized(Vec3{1, -2, 3});
  const SolidFaces ball = ball_faces({1, 2, 3}, 2, 8);
  expect_closed(ball);
  EXPECT_NEAR(volume_of(ball), 32 * kPi / 3, 1e-12);
  for (const auto& [bottom, top] : {std::pair(1.0, 1.0), {2.0, 1.0}, {1.0, 0.0}, {0.0, 3.0}}) {
    const SolidFaces cone = frustum_faces({1, 2, 3}, axis, bottom, top, 1.5, 20);
    expect_closed(cone);
    EXPECT_NEAR(volume_of(cone), kPi * (bottom * bottom + bottom * top + top * top), 1e-12);
  }
  const SolidFaces rod = rod_faces({0, 0, 0}, {1, 2, 3}, 0.5, 200);
  expect_closed(rod);
  EXPECT_NEAR(volume_of(rod), kPi * (std::sqrt(14.0) / 4 + 1.0 / 6), 1e-3);
  const SolidFaces box = box_faces({0, 0, 0}, {1, 2, 3});
  expect_closed(box);
  EXPECT_DOUBLE_EQ(volume_of(box), 6);
  const SolidFaces ring = ring_faces({1, 1, 1}, axis, 2, 0.5, 200, 100);
  EXPECT_NEAR(volume_of(ring), kPi * kPi, 1e-3);
}

/// Mean distance of the middles of faces from the ball or cylinder, as a bound of the mean over the faces.
TEST(PrimitiveFaces, KeepTheError) {
  for (const double error : {0.01, 0.001}) {
    const std::size_t n = sides_of_circle(2, error);
    const double height = 2 * (1 - std::cos(kPi / static_cast<double>(n)));
    EXPECT_LT(0.2566 * height, 1.01 * error);
    EXPECT_GT(0.2566 * height, 0.6 * error);
    const SolidFaces ball = ball_faces({}, 2, edges_of_quarter(2, error));
    for (const Vec3& v : ball.vertices) EXPECT_LT(std::abs(norm(v) - 2), 4.5 * error);
  }
}

TEST(PrimitiveFaces, HalfSpacesAreFlatAcrossAxes) {
  const SolidFaces f = half_space_faces({0, 0, -1}, -0.3, {5, 5, 5}, 10);
  expect_closed(f);
  int on_plane = 0;
  for (const Vec3& v : f.vertices) on_plane += v.z == 0.3;
  EXPECT_EQ(on_plane, 4);
  EXPECT_GT(volume_of(f), 0);
  EXPECT_TRUE(half_space_faces({0, 0, 1}, -100, {}, 10).triangles.empty());
}

TEST(FaceBuilder, KnowsWhatHasNoFaces) {
  const auto obstacle = [](const Solid& s) { return survey_faces(*s.node()).obstacle; };
  const Solid box = csg::box({0, 0, 0}, {1, 1, 1}), ball = csg::sphere({}, 1);
  EXPECT_EQ(obstacle(box), "");
  EXPECT_EQ(obstacle(csg::rotate(csg::subtract(box, ball), {1, 1, 1}, 20)), "");
  EXPECT_EQ(obstacle(csg::offset(box, 0.1)), "an offset");
  EXPECT_EQ(obstacle(csg::shell(box, 0.1)), "a shell");
  EXPECT_EQ(obstacle(csg::unite(box, ball, 0.1)), "a rounded crease (r=)");
  EXPECT_EQ(obstacle(csg::box({0, 0, 0}, {1, 1, 1}, 0.1)), "a rounded box");
  EXPECT_TRUE(survey_faces(*ball.node()).curved);
  EXPECT_FALSE(survey_faces(*box.node()).curved);
}

TEST(FaceBuilder, EqualPartsAreOne) {
  const Solid box = csg::box({0, 0, 0}, {1, 1, 1});
  Solid all = box;
  for (int i = 0; i < 5; ++i) all = csg::unite(csg::subtract(all, csg::box({0, 0, 0}, {2, 2, 2})), box);
  EXPECT_EQ(faces_of(*all.node(), 0.01, {{0, 0, 0}, {1, 1, 1}}).parts.size(), 2u);
}

TEST(FaceBuilder, MirroredPartsFaceOutward) {
  const Solid ball = csg::mirror(csg::translate(csg::sphere({}, 1), {3, 0, 0}), {1, 0, 0});
  const SolidOfFaces faces = faces_of(*ball.node(), 0.01, {{-4, -1, -1}, {-2, 1, 1}});
  ASSERT_EQ(faces.parts.size(), 1u);
  EXPECT_NEAR(volume_of(faces.parts[0]), 4 * kPi / 3, 1e-9);
}

}  // namespace
}  // namespace sansmesh::test
