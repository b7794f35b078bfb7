#include "sansmesh/dynamics/tet_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/dynamics/tet_embedding.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

/// A twisted bar: its vertices at rest and moved.
struct Twisted {
  TetMesh mesh = test::box_of_tets({0, 0, 0}, {3, 1, 1}, 12, 4, 4);
  std::vector<Vec3> moved = mesh.vertices;

  Twisted() {
    for (Vec3& p : moved) {
      const double angle = 0.4 * p.x;
      p = {p.x + 0.2 * p.y * p.y, p.y * std::cos(angle) - p.z * std::sin(angle),
           p.y * std::sin(angle) + p.z * std::cos(angle)};
    }
  }
};

std::vector<Vec3> points_in(const Box3& box, std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) {
    const Vec3 s = box.size();
    p = box.lower + Vec3{s.x * uniform(random), s.y * uniform(random), s.z * uniform(random)};
  }
  return points;
}

TEST(TetMap, GoesBackToWhereThingsCameFrom) {
  const Twisted bar;
  const TetMap forward(bar.mesh.tets, bar.mesh.vertices, bar.moved), back(bar.mesh.tets, bar.moved, bar.mesh.vertices);
  const std::vector<Vec3> x = points_in(bounds(bar.mesh), 2000, 3);
  std::vector<Vec3> there(x.size()), again(x.size());
  forward.map(x, {there, {}, {}, {}});
  back.map(there, {again, {}, {}, {}});
  for (std::size_t i = 0; i < x.size(); ++i) ASSERT_LT(norm(again[i] - x[i]), 1e-12) << i;
}

TEST(TetMap, JacobiansAreThoseOfDifferences) {
  const Twisted bar;
  const TetMap back(bar.mesh.tets, bar.moved, bar.mesh.vertices);
  Box3 box;
  for (const Vec3& p : bar.moved) box.extend(p);
  const std::vector<Vec3> x = points_in(box, 1000, 5);
  std::vector<Jacobian> jacobians(x.size());
  std::vector<std::uint32_t> tets(x.size());
  back.map(x, {{}, jacobians, {}, {}});
  back.find(x, tets);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool outside = tets[i] == TetMap::kNowhere;
    EXPECT_EQ(outside, std::isnan(jacobians[i][0].x));
    for (std::size_t k = 0; k < 3 && !outside; ++k) {
      std::vector<Vec3> ends{x[i], x[i]}, images(2);
      std::vector<std::uint32_t> there(2);
      constexpr double kStep = 1e-6;
      ends[0][k] -= kStep, ends[1][k] += kStep;
      back.find(ends, there);
      if (there[0] != tets[i] || there[1] != tets[i]) continue;
      back.map(ends, {images, {}, {}, {}});
      ++compared;
      ASSERT_LT(norm((images[1] - images[0]) / (2 * kStep) - jacobians[i][k]), 1e-8);
    }
  }
  EXPECT_GT(compared, 500);
}

TEST(TetMap, FindsWhatLookingThroughAllFinds) {
  const Twisted bar;
  const TetMap map(bar.mesh.tets, bar.moved, bar.mesh.vertices);
  const std::vector<Vec3> x = points_in({{-0.5, -2, -2}, {4, 2, 2}}, 3000, 6);
  std::vector<std::uint32_t> found(x.size());
  map.find(x, found);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::uint32_t first = TetMap::kNowhere;
    for (std::uint32_t t = 0; t < bar.mesh.tets.size() && first == TetMap::kNowhere; ++t) {
      const Tet& c = bar.mesh.tets[t];
      const Vec3 o = bar.moved[c[0]];
      const Vec3 w = Matrix3{bar.moved[c[1]] - o, bar.moved[c[2]] - o, bar.moved[c[3]] - o}.solve(x[i] - o);
      if (w.x >= 0 && w.y >= 0 && w.z >= 0 && w.x + w.y + w.z <= 1) first = t;
    }
    ASSERT_EQ(found[i], first) << i;
    inside += first != TetMap::kNowhere;
  }
  EXPECT_GT(inside, 100);
  EXPECT_LT(inside, 2500);
}

TEST(TetMap, ImagesOfBoxesHoldThoseOfTheirPoints) {
  const Twisted bar;
  const TetMap map(bar.mesh.tets, bar.moved, bar.mesh.vertices);
  const std::vector<Vec3> corners = points_in({{-0.5, -2, -2}, {4, 2, 2}}, 200, 8);
  std::vector<Box3> boxes, images(100);
  for (std::size_t i = 0; i < 100; ++i) {
    Box3 box;
    box.extend(corners[2 * i]), box.extend(i % 2 ? corners[2 * i] + Vec3{0.1, 0.1, 0.1} : corners[2 * i + 1]);
    boxes.push_back(box);
  }
  map.images(boxes, images);
  for (std::size_t i = 0; i < 100; ++i) {
    const std::vector<Vec3> x = points_in(boxes[i], 500, 9);
    std::vector<Vec3> there(x.size());
    map.map(x, {there, {}, {}, {}});
    Box3 seen;
    for (const Vec3& p : there) {
      if (!std::isnan(p.x)) seen.extend(p);
    }
    if (seen.empty()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(images[i].lower[k], seen.lower[k] + 1e-12);
      EXPECT_GE(images[i].upper[k], seen.upper[k] - 1e-12);
    }
  }
  std::vector<Box3> far{{{9, 9, 9}, {10, 10, 10}}}, none(1);
  map.images(far, none);
  EXPECT_TRUE(none[0].empty());
}

TEST(TetMap, OneAnswerForAnyNumberOfThreads) {
  const Twisted bar;
  const TetMap map(bar.mesh.tets, bar.moved, bar.mesh.vertices);
  const std::vector<Vec3> x = points_in({{0, -0.5, -0.5}, {3, 1, 1}}, 5000, 6);
  test::expect_equal_for_any_threads([&] {
    std::vector<std::uint32_t> found(x.size());
    map.find(x, found);
    return found;
  });
}

TEST(TetMap, NeedsVolumeAndPositions) {
  const TetMesh mesh = test::box_of_tets({0, 0, 0}, {1, 1, 1}, 1, 1, 1);
  const std::vector<Vec3> flat(mesh.vertices.size()), few(3);
  EXPECT_THROW(TetMap(mesh.tets, flat, mesh.vertices), DataError);
  EXPECT_THROW(TetMap(mesh.tets, few, mesh.vertices), ArgumentError);
}

TEST(TetEmbedding, CarriesPointsAndTheirNormals) {
  const Twisted bar;
  // Affine: positions and normals are known everywhere, also outside the tetrahedra.
  const Matrix3 a{{1.2, 0.1, 0}, {0.3, 0.8, 0.2}, {0, -0.1, 1.1}};
  const auto moved_by = [&](const Vec3& p) { return Vec3{1, 2, 3} + a.a * p.x + a.b * p.y + a.c * p.z; };
  const std::vector<Vec3> points = points_in({{-0.2, -0.2, -0.2}, {3.2, 1.2, 1.2}}, 2000, 11);
  std::vector<Vec3> normals(points.size()), moved;
  for (std::size_t i = 0; i < points.size(); ++i) normals[i] = normalized(points[i] - Vec3{1.5, 0.5, 0.5});
  for (const Vec3& p : bar.mesh.vertices) moved.push_back(moved_by(p));
  const TetEmbedding embedding(bar.mesh, points);
  const auto x = embedding.positions(moved), n = embedding.normals(moved, normals);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_LT(norm(x[i] - moved_by(points[i])), 1e-12);
    ASSERT_LT(norm(n[i] - normalized(a.solve_transposed(normals[i]))), 1e-12);
    const Vec3 p = points[i];
    outside += p.x < 0 || p.y < 0 || p.z < 0 || p.x > 3 || p.y > 1 || p.z > 1;
  }
  EXPECT_EQ(embedding.outside(), outside);
  EXPECT_GT(outside, 100);
}

}  // namespace
}  // namespace sansmesh::inline v1
