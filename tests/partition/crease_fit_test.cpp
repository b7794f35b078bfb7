#include "sansmesh/partition/crease_fit.h"

#include <gtest/gtest.h>

#include <random>

namespace sansmesh {
namespace {

struct CornerSamples {
  std::vector<Vec3f> positions, normals;
  std::vector<float> weights;
};

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
    const CreaseFit fit = fit_crease(s.positions, s.normals, s.weights, {0, 0, 0}, 1, 4);
    ASSERT_EQ(fit.pieces.size(), 2u);
    EXPECT_EQ(fit.pieces[0].convex != 0, convex);
    EXPECT_LT(fit.mean_square, 1e-10);
  }
}

TEST(CreaseFit, FindsACorner) {
  const CornerSamples s = box_corner(3, 1);
  const CreaseFit fit = fit_crease(s.positions, s.normals, s.weights, {0, 0, 0}, 1, 4);
  ASSERT_EQ(fit.pieces.size(), 3u);
  EXPECT_TRUE(fit.pieces[0].convex);
  EXPECT_TRUE(fit.pieces[1].convex);
  EXPECT_LT(fit.mean_square, 1e-10);
}

TEST(CreaseFit, SeesNoneOnASmoothSurfaceOrInNoise) {
  CornerSamples smooth;
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  for (int i = 0; i < 100; ++i) {
    const Vec3f p{uniform(generator), uniform(generator), 0};
    smooth.positions.push_back({p.x, p.y, -0.1f * squared_norm(p)});
    smooth.normals.push_back(normalized(Vec3f{0.2f * p.x, 0.2f * p.y, 1}));
    smooth.weights.push_back(1);
  }
  EXPECT_TRUE(fit_crease(smooth.positions, smooth.normals, smooth.weights, {0, 0, 0}, 1, 4).pieces.empty());
  for (Vec3f& n : smooth.normals) n = normalized(n + Vec3f{uniform(generator), uniform(generator), 0} * 1.6f);
  EXPECT_TRUE(fit_crease(smooth.positions, smooth.normals, smooth.weights, {0, 0, 0}, 1, 4).pieces.empty());
}

}  // namespace
}  // namespace sansmesh
