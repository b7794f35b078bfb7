// Reproduction by local shapes, and detection and combination of faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/surface/mpu/local_shape.h"
#include "sansmesh/surface/mpu/piecewise_shape.h"
#include "sansmesh/surface/mpu/shape_fits.h"

namespace sansmesh::inline v1 {
namespace {

struct Ball {
  std::vector<Vec3> positions, normals;
  std::vector<double> weights;

  void add(const Vec3& p, const Vec3& n, double w = 1) {
    positions.push_back(p), normals.push_back(normalized(n)), weights.push_back(w);
  }
  BallSamples samples() const { return {positions, normals, weights}; }
};

std::vector<Vec3> constraints(std::size_t n, unsigned seed = 2) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> x(n);
  for (Vec3& p : x) p = {uniform(generator), uniform(generator), uniform(generator)};
  return x;
}

TEST(MpuShapes, HeightsReproduceAnyParaboloidOverTheirFrame) {
  const Vec3 up = normalized(Vec3{1, -2, 3});
  Vec3 u, v;
  tangent_frame(up, u, v);
  const auto height = [](double a, double b) {
    return 0.3 + 0.2 * a - 0.1 * b + 0.5 * a * a - 0.7 * a * b + 0.4 * b * b;
  };
  Ball ball;
  for (const Vec3& p : constraints(40)) ball.add(u * p.x + v * p.y + up * height(p.x, p.y), up, 1.5 + p.z);
  const QuadricPiece q = height_quadric(ball.samples(), up, 2);
  for (const Vec3& p : constraints(40, 5)) {
    const double w = 2 * p.z;
    EXPECT_NEAR(q.value(u * p.x + v * p.y + up * w), w - height(p.x, p.y), 1e-7);
  }
}

TEST(MpuShapes, WhatALineOfSamplesDoesNotTellIsFlat) {
  Ball ball;
  for (int i = -5; i <= 5; ++i) ball.add({0.1 * i, 0, 0}, {0, 0, 1});
  const QuadricPiece q = height_quadric(ball.samples(), {0, 0, 1}, 2);
  for (const Vec3& p : constraints(20)) EXPECT_NEAR(q.value(p), p.z, 1e-6);
}

TEST(MpuShapes, GeneralQuadricsReproduceSpheresAndWalls) {
  Ball ball, wall;
  std::vector<DistanceConstraint> around, off;
  for (const Vec3& p : constraints(60)) {
    const Vec3 n = normalized(p);
    ball.add(n * 0.8, n);
    wall.add({p.x, p.y, p.z > 0 ? 0.2 : -0.2}, {0, 0, p.z});
  }
  for (const Vec3& p : constraints(9, 7)) {
    around.push_back({p, (squared_norm(p) - 0.64) / 1.6});
    off.push_back({p, (p.z * p.z - 0.04) / 0.4});
  }
  const QuadricPiece q = general_quadric(ball.samples(), around, 1), w = general_quadric(wall.samples(), off, 1);
  for (const Vec3& p : constraints(40, 9)) {
    EXPECT_NEAR(q.value(p), (squared_norm(p) - 0.64) / 1.6, 1e-6);
    EXPECT_NEAR(w.value(p), (p.z * p.z - 0.04) / 0.4, 1e-6);
  }
}

TEST(MpuShapes, SeenFromElsewhereTheyAreTheSame) {
  QuadricPiece q;
  q.add_square({1, 2, 3}, 0.3), q.add_product({1, 0, -1}, {0, 2, 1}, -0.4);
  q.b = {1, -1, 2}, q.c = 0.7;
  const Vec3 by{0.3, -0.2, 0.9};
  const QuadricPiece there = q.seen_from(by);
  for (const Vec3& p : constraints(20)) {
    EXPECT_NEAR(there.value(p), q.value(p + by), 1e-12);
    const double step = 1e-5;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 a = p, b = p;
      a[k] += step, b[k] -= step;
      EXPECT_NEAR(q.gradient(p)[k], (q.value(a) - q.value(b)) / (2 * step), 1e-8);
    }
  }
}

/// Samples of the faces of a combination of three half spaces, on the boundary of it.
template <class Inside>
Ball corner_of(const std::array<Vec3, 3>& normals, const Inside& combined) {
  Ball ball;
  for (const Vec3& n : normals) {
    Vec3 u, v;
    tangent_frame(n, u, v);
    int taken = 0;
    for (const Vec3& p : constraints(400)) {
      const Vec3 x = u * p.x + v * p.y;
      if (taken < 10 && std::abs(combined(x)) < 1e-12) ball.add(x, n), ++taken;
    }
  }
  return ball;
}

TEST(MpuShapes, CornersOfEveryKindAreReproduced) {
  const std::array<Vec3, 3> n{normalized(Vec3{1, 0.1, 0}), normalized(Vec3{0, 1, -0.1}), normalized(Vec3{0.1, 0, 1})};
  const auto check = [&](const auto& combined) {
    const Ball ball = corner_of(n, combined);
    ASSERT_GT(ball.positions.size(), 20u);
    EXPECT_EQ(split_by_normals(ball.normals).faces, 3u);
    const auto shape = piecewise_shape(ball.samples(), 2);
    ASSERT_TRUE(shape);
    for (const Vec3& x : constraints(100, 4))
      EXPECT_NEAR(shape_value(shape->pieces.data(), shape->combination, x).value, combined(x), 1e-6);
  };
  const auto d = [&](std::size_t k, const Vec3& x) { return dot(n[k], x); };
  check([&](const Vec3& x) { return std::max({d(0, x), d(1, x), d(2, x)}); });
  check([&](const Vec3& x) { return std::min({d(0, x), d(1, x), d(2, x)}); });
  check([&](const Vec3& x) { return std::max(d(0, x), std::min(d(1, x), d(2, x))); });
  check([&](const Vec3& x) { return std::min(d(1, x), std::max(d(0, x), d(2, x))); });
}

TEST(MpuShapes, CornersOfFourFacesAreToldFromEdges) {
  // The tip of a pyramid over a square.
  Ball tip, edge, smooth, wall;
  const std::array<Vec3, 4> n{Vec3{1, 0, 0.7}, {-1, 0, 0.7}, {0, 1, 0.7}, {0, -1, 0.7}};
  const auto pyramid = [&](const Vec3& x) {
    double most = -10;
    for (const Vec3& m : n) most = std::max(most, dot(normalized(m), x));
    return most;
  };
  for (const Vec3& m : n) {
    Vec3 u, v;
    tangent_frame(normalized(m), u, v);
    for (const Vec3& p : constraints(60))
      if (const Vec3 x = u * p.x + v * p.y; std::abs(pyramid(x)) < 1e-12) tip.add(x, m);
  }
  for (const Vec3& p : constraints(30)) {
    edge.add(p.x > 0 ? Vec3{p.x, p.y, 0} : Vec3{0, p.y, -std::abs(p.x)}, p.x > 0 ? Vec3{0, 0, 1} : Vec3{-1, 0, 0});
    smooth.add({p.x, p.y, 0}, {0.1 * p.x, 0.1 * p.y, 1});
    wall.add({p.x, p.y, p.z > 0 ? 0.1 : -0.1}, {0, 0, p.z});
  }
  EXPECT_EQ(split_by_normals(tip.normals).faces, 4u);
  EXPECT_EQ(split_by_normals(edge.normals).faces, 2u);
  EXPECT_EQ(split_by_normals(wall.normals).faces, 2u);
  EXPECT_EQ(split_by_normals(smooth.normals).faces, 1u);
  EXPECT_FALSE(piecewise_shape(smooth.samples(), 2));
  const auto shape = piecewise_shape(tip.samples(), 2);
  ASSERT_TRUE(shape);
  for (const Vec3& x : constraints(100, 4))
    EXPECT_NEAR(shape_value(shape->pieces.data(), shape->combination, x).value, pyramid(x), 1e-6);
  const auto slab = piecewise_shape(wall.samples(), 2);
  ASSERT_TRUE(slab);
  for (const Vec3& x : constraints(100, 4))
    EXPECT_NEAR(shape_value(slab->pieces.data(), slab->combination, x).value, std::abs(x.z) - 0.1, 1e-6);
}

TEST(MpuShapes, RangesHoldAllValues) {
  LocalShape shape;
  shape.combination = {.pieces = 3, .maxima = 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<Vec3> p = constraints(3, static_cast<unsigned>(k));
    shape.pieces[k].add_square(p[0], 0.8), shape.pieces[k].add_product(p[1], p[2], -0.6);
    shape.pieces[k].b = p[1], shape.pieces[k].c = p[2].x;
  }
  for (const Vec3& x : constraints(20, 8)) {
    const double radius = 0.3;
    const ValueRange r = shape_range(shape.pieces.data(), shape.combination, x, radius);
    for (const Vec3& d : constraints(300, 6)) {
      const double v = shape_value(shape.pieces.data(), shape.combination, x + normalized(d) * radius).value;
      ASSERT_LE(r.least, v + 1e-12);
      ASSERT_GE(r.most, v - 1e-12);
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
