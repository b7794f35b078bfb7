#include "sansmesh/render/scene/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();

std::vector<Vec3f> random_directions(int count) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<Vec3f> directions;
  for (int i = 0; i < count; ++i) {
    const float x = normal(random), y = normal(random), z = normal(random);
    directions.push_back(normalized(Vec3f{x, y, z}));
  }
  return directions;
}

TEST(RayScene, ClosedMeshIsHitFromInsideInEveryDirection) {
  const TriangleMesh mesh = test::octasphere(4);
  const RayScene scene = RayScene::triangles(mesh.vertices, mesh.triangles);
  for (const Vec3f& d : random_directions(2000)) {
    const auto hit = scene.closest({0, 0, 0}, d);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, 1, 0.01);
    EXPECT_GT(dot(hit->normal, d), 0.99f) << "normals point outwards";
    const Triangle& t = mesh.triangles[hit->primitive];
    const Vec3f at =
        (1 - hit->u - hit->v) * mesh.vertices[t[0]] + hit->u * mesh.vertices[t[1]] + hit->v * mesh.vertices[t[2]];
    EXPECT_LT(norm(at - hit->distance * d), 1e-5f) << "u and v are the weights of the second and third corner";
    EXPECT_TRUE(scene.blocked({0, 0, 0}, d, kEndless));
    EXPECT_FALSE(scene.blocked({0, 0, 0}, d, 0.9f));
    EXPECT_FALSE(scene.closest(2.0f * d, d));
    EXPECT_FALSE(scene.blocked(2.0f * d, d, kEndless));
  }
}

TEST(RayScene, PacketsFindWhatSingleRaysFind) {
  TriangleMesh mesh = test::octasphere(4);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) mesh.triangles.push_back(mesh.triangles[(i * 77 + 5) % count]);
  const RayScene scene = RayScene::triangles(mesh.vertices, mesh.triangles);
  const Vec3f eye{0.3f, -0.2f, 3};
  std::vector<Vec3f> directions;
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x)
      directions.push_back(
          normalized(Vec3f{0.02f * static_cast<float>(x - 20), 0.02f * static_cast<float>(y - 20), -1}));
  std::vector<std::optional<RayHit>> hits(directions.size()), behind(directions.size());
  scene.closest({&eye, 1}, directions, {}, {}, hits);
  std::size_t met = 0;
  std::vector<float> beyond;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const auto single = scene.closest(eye, directions[i]);
    beyond.push_back(single ? single->distance + 1e-3f : 0);
    ASSERT_EQ(hits[i].has_value(), single.has_value()) << i;
    if (!single) continue;
    ++met;
    EXPECT_EQ(hits[i]->primitive, single->primitive);
    EXPECT_NEAR(hits[i]->distance, single->distance, 1e-5f);
    EXPECT_LT(norm(hits[i]->normal - single->normal), 1e-5f);
  }
  EXPECT_GT(met, 500u);
  scene.closest({&eye, 1}, directions, beyond, {}, behind);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (!hits[i] || dot(hits[i]->normal, directions[i]) > -0.2f) continue;
    ASSERT_TRUE(behind[i]) << "the far side";
    EXPECT_GT(dot(behind[i]->normal, directions[i]), 0);
  }
}

TEST(RayScene, LowestPrimitiveWinsWhereSeveralCoincide) {
  TriangleMesh mesh = test::octasphere(3);
  const std::size_t count = mesh.triangles.size();
  for (int copy = 0; copy < 3; ++copy)
    for (std::size_t i = 0; i < count; ++i) mesh.triangles.push_back(mesh.triangles[(i * 77 + 5) % count]);
  const RayScene scene = RayScene::triangles(mesh.vertices, mesh.triangles);
  for (const Vec3f& d : random_directions(2000)) EXPECT_LT(scene.closest({0, 0, 0}, d)->primitive, count);

  std::vector<Vec3f> centers(5, Vec3f{1, 2, 3});
  centers.resize(200, Vec3f{-4, 2, 3});
  const RayScene balls = RayScene::balls(centers, 0.5f);
  EXPECT_EQ(balls.closest({1, 2, 9}, {0, 0, -1})->primitive, 0u);
  EXPECT_EQ(balls.closest({-4, 2, 9}, {0, 0, -1})->primitive, 5u);
}

TEST(RayScene, BallsAndDiscsAreWhereTheyShouldBe) {
  const std::vector<Vec3f> centers{{0, 0, 0}, {3, 0, 0}};
  const RayScene balls = RayScene::balls(centers, 0.5f);
  const auto ball = balls.closest({3, 0, 5}, {0, 0, -1});
  ASSERT_TRUE(ball);
  EXPECT_NEAR(ball->distance, 4.5, 1e-5);
  EXPECT_EQ(ball->primitive, 1u);
  EXPECT_GT(ball->normal.z, 0.999f);
  EXPECT_FALSE(balls.closest({1.5f, 0, 5}, {0, 0, -1}));

  const std::vector<float> radii{0.5f, 2};
  EXPECT_NEAR(RayScene::balls(centers, radii).closest({3, 0, 5}, {0, 0, -1})->distance, 3, 1e-5);
  EXPECT_NEAR(RayScene::balls(centers, radii).closest({0, 0, 5}, {0, 0, -1})->distance, 4.5, 1e-5);

  const std::vector<Vec3f> normals{{0, 0, 1}, {1, 0, 0}};
  EXPECT_TRUE(RayScene::discs(centers, normals, radii).closest({9, 1.3f, 1.3f}, {-1, 0, 0}));
  EXPECT_FALSE(RayScene::discs(centers, normals, radii).closest({0.4f, 0.4f, 5}, {0, 0, -1}));
  const RayScene discs = RayScene::discs(centers, normals, 0.5f);
  const auto disc = discs.closest({0.3f, 0.3f, 5}, {0, 0, -1});
  ASSERT_TRUE(disc);
  EXPECT_NEAR(disc->distance, 5, 1e-5);
  EXPECT_NEAR(std::abs(disc->normal.z), 1, 1e-5);
  EXPECT_FALSE(discs.closest({0.4f, 0.4f, 5}, {0, 0, -1})) << "beyond the rim";
  EXPECT_TRUE(discs.blocked({5, 0.2f, 0.2f}, {-1, 0, 0}, 2.1f));
}

}  // namespace
}  // namespace sansmesh::inline v1
