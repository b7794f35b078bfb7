#include "sansmesh/points/face_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "support/any_threads.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

PointSet turned(PointSet mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Disc of radius 1 with a round rim and the given thickness at its centre.
PointSet disc_mesh(int levels, float thickness) {
  PointSet mesh = test::ball_mesh(levels);
  for (Vec3f& p : mesh.positions) p.z *= 0.5f * thickness;
  return mesh;
}

TEST(FaceSides, AreThoseOfSolids) {
  const PointSet ball = test::ball_mesh(3);
  EXPECT_EQ(face_sides(ball), FaceSides::outward);
  EXPECT_EQ(face_sides(turned(ball)), FaceSides::inward);
  EXPECT_EQ(face_sides(disc_mesh(3, 1e-4f)), FaceSides::outward) << "however thin";

  PointSet moved = ball;  // far from the origin
  for (Vec3f& p : moved.positions) p += Vec3f{50, -70, 90};
  EXPECT_EQ(face_sides(moved), FaceSides::outward);
  EXPECT_EQ(face_sides(turned(moved)), FaceSides::inward);
}

TEST(FaceSides, CavitiesLookTheOtherWay) {
  const PointSet ball = test::ball_mesh(3);
  EXPECT_EQ(face_sides(test::joined_meshes(ball, turned(ball), 0.5f)), FaceSides::outward);
  EXPECT_EQ(face_sides(test::joined_meshes(turned(ball), ball, 0.5f)), FaceSides::inward);
  EXPECT_EQ(face_sides(test::joined_meshes(ball, ball, 0.5f, {4, 0, 0})), FaceSides::outward);
  EXPECT_EQ(face_sides(test::joined_meshes(ball, turned(ball), 0.5f, {4, 0, 0})), FaceSides::unknown)
      << "no cavity where it lies outside";
}

TEST(FaceSides, AreUnknownWhereTheFacesBoundNoSolidOrDisagree) {
  PointSet half = test::ball_mesh(4), mixed = half, scratched = half;
  half.triangles.resize(half.triangles.size() / 2);
  EXPECT_EQ(face_sides(half), FaceSides::unknown);
  for (std::size_t i = 0; i < mixed.triangles.size(); i += 2) std::swap(mixed.triangles[i][1], mixed.triangles[i][2]);
  EXPECT_EQ(face_sides(mixed), FaceSides::unknown);
  scratched.triangles.resize(scratched.triangles.size() - 3);  // a few triangles are missing
  EXPECT_EQ(face_sides(scratched), FaceSides::outward);
  scratched.triangles.push_back({0, 0, 1});
  scratched.triangles.push_back({0, 1, 1000000});
  EXPECT_EQ(face_sides(scratched), FaceSides::outward) << "what is no triangle does not count";
  EXPECT_EQ(face_sides(PointSet{}), FaceSides::unknown);
}

TEST(ThinParts, AreThoseWhoseOtherSideIsAsNearAsNeighbours) {
  const PointSet ball = test::ball_mesh(5);  // edges of 0.03 to 0.05
  EXPECT_EQ(find_thin_parts(ball, 1).share, 0);
  EXPECT_EQ(find_thin_parts(turned(ball), 1).share, 0) << "what faces it is not behind it";
  EXPECT_LT(find_thin_parts(disc_mesh(5, 0.3f), 1).share, 0.1) << "only its rim";
  const ThinParts thin = find_thin_parts(disc_mesh(5, 0.03f), 1);
  EXPECT_GT(thin.share, 0.95);
  // The mean thickness of an ellipsoid over its disc is two thirds of the largest, the median √½ of it; the rim is
  // tested more often.
  EXPECT_GT(thin.thickness, 0.6 * 0.03);
  EXPECT_LT(thin.thickness, 0.75 * 0.03);
  PointSet doubled = ball;  // some faces occur twice, once reversed
  for (std::size_t i = 0; i < ball.triangles.size(); i += 7)
    doubled.triangles.push_back({ball.triangles[i][0], ball.triangles[i][2], ball.triangles[i][1]});
  EXPECT_EQ(find_thin_parts(doubled, 1).share, 0);
  EXPECT_EQ(find_thin_parts(PointSet{}, 1).share, 0);
}

TEST(ThinParts, AreTheSameInAnyUnitAndForAnyNumberOfThreads) {
  const PointSet mesh = disc_mesh(5, 0.06f);
  PointSet large = mesh;
  for (Vec3f& p : large.positions) p *= 1024;
  const ThinParts a = find_thin_parts(mesh, 1), b = find_thin_parts(large, 1024);
  EXPECT_EQ(a.share, b.share);
  EXPECT_EQ(1024 * a.thickness, b.thickness);
  test::compare_threads([&] { return find_thin_parts(mesh, 1); },
                        [](const ThinParts& one, const ThinParts& many) {
                          EXPECT_EQ(one.share, many.share);
                          EXPECT_EQ(one.thickness, many.thickness);
                        });
}

TEST(SampleFaces, VerticesOfThinMeshesDoNotSuffice) {
  EXPECT_EQ(face_samples_wanted(test::ball_mesh(5)), 0u);
  EXPECT_EQ(face_samples_wanted(disc_mesh(5, 0.6f)), 0u);
  std::size_t thicker = 0;
  for (const float thickness : {0.1f, 0.07f, 0.05f}) {
    const PointSet mesh = disc_mesh(5, thickness);
    const std::size_t wanted = face_samples_wanted(mesh);
    EXPECT_TRUE(vertices_are_dense(mesh)) << "thin or not";
    EXPECT_GT(wanted, std::max(2 * mesh.size(), thicker)) << "the thinner, the more";
    EXPECT_LE(wanted, kFaceSamples);
    thicker = wanted;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
