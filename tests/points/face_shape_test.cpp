#include "sansmesh/points/shape/face_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
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
    EXPECT_GT(wanted, 2 * mesh.size());
    EXPECT_GE(wanted, thicker) << "the thinner, the more";
    EXPECT_LE(wanted, kFaceSamples);
    thicker = wanted;
  }
}

/// A cube of n × n squares a face, two triangles each, whose vertices are shared; its faces bulge outward by `bulge`.
PointSet cube_mesh(int n, float bulge) {
  PointSet mesh;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, added] = number.emplace(at, static_cast<std::uint32_t>(mesh.size()));
    if (added) {
      Vec3f p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = 2 * static_cast<float>(at[k]) / static_cast<float>(n) - 1;
      mesh.positions.push_back(p * (1 - bulge) + normalized(p) * bulge);
    }
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> x{};
            x[axis] = side, x[(axis + 1) % 3] = i + u, x[(axis + 2) % 3] = j + v;
            return vertex(x);
          };
          const std::uint32_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          mesh.triangles.push_back(side ? Triangle{a, b, c} : Triangle{a, c, b});
          mesh.triangles.push_back(side ? Triangle{a, c, d} : Triangle{a, d, c});
        }
  return mesh;
}

TEST(SampleFaces, VerticesOnCreasesDoNotSuffice) {
  const PointSet cube = cube_mesh(20, 0), round = cube_mesh(20, 1);
  EXPECT_TRUE(vertices_are_dense(cube));
  EXPECT_EQ(face_samples_wanted(cube), 10 * cube.size());
  EXPECT_EQ(face_samples_wanted(round), 0u);
}

TEST(SampleFaces, SharpEdgesOfNoiseAreNoCreases) {
  PointSet rough = test::ball_mesh(5);
  std::mt19937 generator(1);
  std::normal_distribution<float> noise(0, 0.01f);
  for (Vec3f& p : rough.positions) p = p * (1 + noise(generator));
  EXPECT_EQ(face_samples_wanted(rough), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
