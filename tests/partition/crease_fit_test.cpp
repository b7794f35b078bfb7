#include "sansmesh/partition/fit/crease_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sansmesh::inline v1 {
namespace {

struct CornerSamples {
  std::vector<Vec3f> positions, normals;
  std::vector<float> weights;
};

/// Fit in the unit ball around the origin, whose samples come first.
CreaseFit crease_of(const CornerSamples& s) {
  const auto inner =
      static_cast<std::size_t>(std::count_if(s.weights.begin(), s.weights.end(), [](float w) { return w > 0; }));
  return fit_crease(s.positions, s.normals, s.weights, inner, {0, 0, 0}, 1, 4);
}

/// Samples near the origin of the boundary of {x < 0, y < 0 (and z < 0)}: two or three faces of a box; mirrored for
/// concave.
CornerSamples box_corner(int faces, float sign) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> uniform(-0.5f, 0), both(-0.5f, 0.5f);
  CornerSamples s;
  for (int i = 0; i < 120; ++i) {
    const auto axis = static_cast<std::size_t>(i % faces);
    Vec3f p{uniform(generator), uniform(generator), faces == 3 ? uniform(generator) : both(generator)}, n;
    p[axis] = 0;
    n[axis] = 1;
    s.positions.push_back(p * sign);
    s.normals.push_back(n);
    s.weights.push_back(1);
  }
  return s;
}

TEST(CreaseFit, FindsAConvexAndAConcaveEdge) {
  for (const bool convex : {true, false}) {
    const CornerSamples s = box_corner(2, convex ? 1.0f : -1.0f);
    const CreaseFit crease = crease_of(s);
    ASSERT_EQ(crease.pieces.size(), 2u);
    EXPECT_EQ(crease.pieces[0].convex != 0, convex);
    EXPECT_LT(crease.mean_square, 1e-10);
  }
}

TEST(CreaseFit, FindsACorner) {
  const CornerSamples s = box_corner(3, 1);
  const CreaseFit crease = crease_of(s);
  ASSERT_EQ(crease.pieces.size(), 3u);
  EXPECT_TRUE(crease.pieces[0].convex);
  EXPECT_TRUE(crease.pieces[1].convex);
  EXPECT_LT(crease.mean_square, 1e-10);
}

/// Samples of the boundary of {(x < 0 or y < 0) and z < 0}, most of its upper face beside one of the walls: that face
/// is on both sides of the wall's plane.
TEST(CreaseFit, FindsACornerThatIsNeitherConvexNorConcave) {
  CornerSamples s;
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> part(0, 0.5f);
  const auto add = [&](const Vec3f& p, const Vec3f& n) {
    s.positions.push_back(p);
    s.normals.push_back(n);
    s.weights.push_back(1);
  };
  for (int i = 0; i < 30; ++i) {
    add({0, part(generator), -part(generator)}, {1, 0, 0});
    add({part(generator), 0, -part(generator)}, {0, 1, 0});
    add({part(generator), -part(generator), 0}, {0, 0, 1});
    if (i % 5 == 0) add({-part(generator), part(generator), 0}, {0, 0, 1});
  }
  const CreaseFit crease = crease_of(s);
  ASSERT_EQ(crease.pieces.size(), 3u);
  const auto value = [&](const Vec3f& x) {
    const auto join = [](bool convex, float a, float b) { return convex ? std::max(a, b) : std::min(a, b); };
    const auto& p = crease.pieces;
    return join(p[1].convex != 0, join(p[0].convex != 0, local_value(p[0], x), local_value(p[1], x)),
                local_value(p[2], x));
  };
  for (const Vec3f& x : s.positions) EXPECT_NEAR(value(x), 0, 1e-5f);
  EXPECT_LT(value({0.2f, -0.2f, -0.2f}), 0);
  EXPECT_LT(value({-0.2f, 0.2f, -0.2f}), 0);
  EXPECT_GT(value({0.2f, 0.2f, -0.2f}), 0);
  EXPECT_GT(value({-0.2f, -0.2f, 0.2f}), 0);
}

/// A wall with a single sample in the ball: without the samples around, the other face would extend beyond the edge.
TEST(CreaseFit, TakesSamplesBeyondTheBallForABarelyTouchedSheet) {
  CornerSamples s;
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> part(-0.5f, 0.5f);
  const auto add = [&](const Vec3f& p, const Vec3f& n, float weight) {
    s.positions.push_back(p);
    s.normals.push_back(n);
    s.weights.push_back(weight);
  };
  for (int i = 0; i < 30; ++i) add({part(generator), part(generator), 0}, {0, 0, 1}, 1);
  add({0.6f, 0.1f, -0.5f}, {1, 0, 0}, 1);
  const CornerSamples alone = s;
  for (int i = 0; i < 5; ++i) add({0.6f, part(generator), -1 - part(generator) * part(generator)}, {1, 0, 0}, 0);
  ASSERT_EQ(crease_of(alone).pieces.size(), 1u);
  const CreaseFit crease = crease_of(s);
  ASSERT_EQ(crease.pieces.size(), 2u);
  EXPECT_TRUE(crease.pieces[0].convex);
  for (const LocalFunction& piece : crease.pieces)
    EXPECT_NEAR(local_value(piece, {0.8f, 0, 0}), piece.nu.x > 0.5f ? 0.2f : 0, 1e-5f);
}

TEST(CreaseFit, SeesNoneOnASmoothSurfaceOrInNoise) {
  CornerSamples smooth;
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  for (int i = 0; i < 100; ++i) {
    const Vec3f p{uniform(generator), uniform(generator), 0};
    smooth.positions.push_back({p.x, p.y, -0.05f * squared_norm(p)});
    smooth.normals.push_back(normalized(Vec3f{0.1f * p.x, 0.1f * p.y, 1}));
    smooth.weights.push_back(1);
  }
  EXPECT_TRUE(crease_of(smooth).pieces.empty());
  for (Vec3f& n : smooth.normals) n = normalized(n + Vec3f{uniform(generator), uniform(generator), 0} * 1.6f);
  EXPECT_TRUE(crease_of(smooth).pieces.empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
