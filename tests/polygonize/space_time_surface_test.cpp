#include "sansmesh/polygonize/space_time/space_time_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

/// A formula with a slope of at most `slope` in space and `speed` in time.
class FormulaInTime final : public TimeField {
 public:
  FormulaInTime(std::function<double(const Vec3&, double)> f, double speed, double reach = 2, double slope = 1)
      : f_(std::move(f)), speed_(speed), reach_(reach), slope_(slope) {}
  Box3 bounds() const override { return {Vec3{-1, -1, -1} * reach_, Vec3{1, 1, 1} * reach_}; }
  TimeRange times() const override { return {2, 3}; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_TRUE(times().contains(t[i]));
      values[i] = f_(x[i], t[i]);
    }
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
              std::span<ValueRange> found) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double v = f_(x[i], t[i]), d = slope_ * radius + speed_ * duration;
      found[i] = {v - d, v + d};
    }
  }
  double operator()(const Vec3& x, double t) const { return f_(x, t); }

 private:
  std::function<double(const Vec3&, double)> f_;
  double speed_, reach_, slope_;
};

/// A ball that moves along a parabola and grows.
Vec3 ball_center(double t) { return {0.9 * (t - 2.4), 0.8 * (t - 2.4) * (t - 2.4), 0.3 - 0.5 * (t - 2)}; }
double ball_radius(double t) { return 0.5 + 0.3 * (t - 2); }
FormulaInTime moving_ball() {
  return {[](const Vec3& x, double t) { return norm(x - ball_center(t)) - ball_radius(t); }, 2};
}
/// Two balls that approach each other with a smooth union: two components, then one.
FormulaInTime meeting_balls() {
  return {[](const Vec3& x, double t) {
            const double d = 1.1 - (t - 2), k = 8;
            const double a = norm(x - Vec3{d, 0.02, 0.03}) - 0.6, b = norm(x + Vec3{d, 0.02, 0.03}) - 0.6;
            return -std::log(std::exp(-k * a) + std::exp(-k * b)) / k;
          },
          1};
}

SpaceTimeSurface divided(const TimeField& field, double cell, double duration, double mesh_error = 0) {
  Progress progress;
  return {field, {cell, duration, mesh_error}, progress};
}

double area_of(const TriangleMesh& mesh) { return measure_size(mesh).area; }

void expect_solid(const TriangleMesh& mesh, std::size_t components, long genus) {
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_EQ(topology.boundary_edges, 0u);
  EXPECT_EQ(topology.nonmanifold_edges, 0u);
  EXPECT_EQ(topology.nonmanifold_vertices, 0u);
  EXPECT_EQ(topology.inconsistent_edges, 0u);
  EXPECT_EQ(topology.degenerate_triangles, 0u);
  EXPECT_EQ(topology.unused_vertices, 0u);
  EXPECT_EQ(topology.components, components);
  EXPECT_EQ(topology.genus(), genus);
  EXPECT_GT(measure_size(mesh).volume, 0);
}

// Moments of the lattice, close to it, and others.
const std::vector<double> kMoments{2,       2.0625, 2.0625 + 1e-13, 2.1,    2.25,    2.3333,
                                   2.46875, 2.5,    2.71828,        2.9375, 2.99999, 3};

TEST(SpaceTimeSurface, SlicesOfAMovingBallAreClosedAndNearIt) {
  const FormulaInTime ball = moving_ball();
  const SpaceTimeSurface surface = divided(ball, 0.125, 0.0625);
  for (const double t : kMoments) {
    SCOPED_TRACE(t);
    const TriangleMesh mesh = surface.slice(t);
    expect_solid(mesh, 1, 0);
    const double r = ball_radius(t);
    double most = 0;
    for (const Vec3f& v : mesh.vertices) most = std::max(most, std::abs(ball(Vec3(v), t)));
    EXPECT_LT(most, 0.02);
    EXPECT_NEAR(measure_size(mesh).volume, 4.0 / 3 * M_PI * r * r * r, 0.05 * r * r * r);
  }
}

TEST(SpaceTimeSurface, ErrorsFallWithTheSquareOfTheCell) {
  const FormulaInTime ball = moving_ball();
  std::vector<double> errors;
  for (const double cell : {0.25, 0.125, 0.0625}) {
    const SpaceTimeSurface surface = divided(ball, cell, cell / 2);
    double sum = 0;
    std::size_t n = 0;
    for (const double t : {2.3, 2.71828}) {
      for (const Vec3f& v : surface.slice(t).vertices) sum += std::abs(ball(Vec3(v), t)), ++n;
    }
    errors.push_back(sum / static_cast<double>(n));
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.8);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.8);
}

TEST(SpaceTimeSurface, TopologyChangesAsThatOfTheField) {
  SANSMESH_NOT_SANITIZED("judges topology; others make slices, too");
  const FormulaInTime balls = meeting_balls();
  // They touch when the midpoint becomes inside: −log(2 exp(−k a))/k = 0, that is a = log(2)/k.
  const double touch = 3.1 - std::sqrt(std::pow(0.6 + std::log(2) / 8, 2) - 0.02 * 0.02 - 0.03 * 0.03);
  const SpaceTimeSurface surface = divided(balls, 0.125, 0.0625);
  for (const double t : kMoments) {
    if (std::abs(t - touch) < 0.02) continue;
    SCOPED_TRACE(t);
    expect_solid(surface.slice(t), t < touch ? 2 : 1, 0);
  }
  // The hole of a ring closes.
  const FormulaInTime ring(
      [](const Vec3& x, double t) { return std::hypot(std::hypot(x.x, x.y) - 0.8, x.z) - (0.3 + 0.9 * (t - 2)); }, 0.9);
  const SpaceTimeSurface closing = divided(ring, 0.125, 0.0625);
  for (const double t : kMoments) {
    SCOPED_TRACE(t);
    if (std::abs(t - 2.5556) > 0.06) expect_solid(closing.slice(t), 1, t < 2.5556 ? 1 : 0);
  }
  // A ball that appears: nothing before.
  const FormulaInTime birth([](const Vec3& x, double t) { return norm(x - Vec3{0.1, 0.2, 0.3}) - (t - 2.4); }, 1);
  const SpaceTimeSurface born = divided(birth, 0.125, 0.0625);
  EXPECT_TRUE(born.slice(2).triangles.empty());
  EXPECT_TRUE(born.slice(2.3).triangles.empty());
  expect_solid(born.slice(2.7), 1, 0);
}

// Blocks as large as the field is flat: levels meet on the surface.
TEST(SpaceTimeSurface, BlocksOfDifferentSizesFitTogether) {
  const FormulaInTime ball = moving_ball();
  const SpaceTimeSurface all = divided(ball, 0.0625, 0.0625), some = divided(ball, 0.0625, 0.0625, 0.04);
  EXPECT_LT(some.blocks() * 2, all.blocks());
  for (const double t : {2.0, 2.2, 2.53125, 2.777}) {
    SCOPED_TRACE(t);
    const TriangleMesh mesh = some.slice(t);
    expect_solid(mesh, 1, 0);
    if (t == 2.2 || t == 2.777) {
      EXPECT_LT(mesh.triangles.size(), all.slice(t).triangles.size());
    }
    double most = 0;
    for (const Vec3f& v : mesh.vertices) most = std::max(most, std::abs(ball(Vec3(v), t)));
    EXPECT_LT(most, 0.06);
  }
}

using Point4 = std::array<double, 4>;

double determinant4(const std::array<Point4, 4>& rows) {
  std::array<Point4, 4> m = rows;
  double d = 1;
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t best = c;
    for (std::size_t r = c; r < 4; ++r)
      if (std::abs(m[r][c]) > std::abs(m[best][c])) best = r;
    if (m[best][c] == 0) return 0;
    if (best != c) std::swap(m[best], m[c]), d = -d;
    d *= m[c][c];
    for (std::size_t r = c + 1; r < 4; ++r)
      for (std::size_t k = 4; k-- > c;) m[r][k] -= m[r][c] / m[c][c] * m[c][k];
  }
  return d;
}

// The 3-manifold: every triangle belongs to two tetrahedra of opposite orientation, or is at the first or last moment.
// Cutting its tetrahedra gives the slices.
TEST(SpaceTimeSurface, TetrahedraAreAManifoldWhoseCutsAreTheSlices) {
  SANSMESH_NOT_SANITIZED("others make slices, too");
  const FormulaInTime balls = meeting_balls();
  const SpaceTimeSurface surface = divided(balls, 0.25, 0.125, 0.02);
  const SpaceTimeMesh mesh = surface.mesh();
  ASSERT_GT(mesh.tetrahedra.size(), 1000u);
  std::map<std::array<std::uint32_t, 3>, int> faces, turns;
  for (const auto& tet : mesh.tetrahedra)
    for (std::size_t left = 0; left < 4; ++left) {
      std::array<std::uint32_t, 3> face{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != left) face[n++] = tet[k];
      int turn = left % 2 == 0 ? 1 : -1;
      for (std::size_t i = 1; i < 3; ++i)
        for (std::size_t k = i; k > 0 && face[k] < face[k - 1]; --k) std::swap(face[k], face[k - 1]), turn = -turn;
      ++faces[face];
      turns[face] += turn;
    }
  std::size_t ends = 0;
  for (const auto& [face, count] : faces) {
    if (count == 2) {
      EXPECT_EQ(turns[face], 0);
      continue;
    }
    ASSERT_EQ(count, 1);
    ++ends;
    const double t = mesh.vertices[face[0]][3];
    EXPECT_TRUE(std::abs(t - 2) < 1e-12 || std::abs(t - 3) < 1e-12) << t;
    for (const std::uint32_t v : face) EXPECT_EQ(mesh.vertices[v][3], t);
  }
  EXPECT_GT(ends, 100u);
  // Tetrahedra are oriented towards larger field values.
  std::size_t right = 0, judged = 0;
  for (const auto& tet : mesh.tetrahedra) {
    Point4 middle{};
    std::array<Point4, 4> rows{};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < 4; ++i) middle[k] += mesh.vertices[tet[i]][k] / 4;
    for (std::size_t i = 1; i < 4; ++i)
      for (std::size_t k = 0; k < 4; ++k) rows[i - 1][k] = mesh.vertices[tet[i]][k] - mesh.vertices[tet[0]][k];
    const double h = 1e-5;
    for (std::size_t k = 0; k < 4; ++k) {
      Point4 p = middle, m = middle;
      p[k] += h, m[k] -= h;
      rows[3][k] = (balls({p[0], p[1], p[2]}, p[3]) - balls({m[0], m[1], m[2]}, m[3])) / (2 * h);
    }
    const double d = determinant4(rows);
    if (std::abs(d) < 1e-5) continue;
    ++judged;
    right += d > 0;
  }
  EXPECT_GT(judged, 1000u);
  EXPECT_GT(static_cast<double>(right), 0.99 * static_cast<double>(judged));

  for (const double t : {2.2, 2.54321, 2.9}) {
    double area = 0;
    for (const auto& tet : mesh.tetrahedra) {
      std::vector<Vec3> low;
      std::vector<std::size_t> below, above;
      for (std::size_t i = 0; i < 4; ++i) (mesh.vertices[tet[i]][3] < t ? below : above).push_back(i);
      if (below.empty() || above.empty()) continue;
      std::vector<Vec3> corners;
      const auto add = [&](std::size_t i, std::size_t k) {
        const Point4 &a = mesh.vertices[tet[i]], &b = mesh.vertices[tet[k]];
        const double u = (t - a[3]) / (b[3] - a[3]);
        corners.push_back(Vec3{a[0], a[1], a[2]} * (1 - u) + Vec3{b[0], b[1], b[2]} * u);
      };
      // In order around the quadrilateral.
      for (std::size_t i = 0; i < below.size(); ++i)
        for (std::size_t k = 0; k < above.size(); ++k) add(below[i], above[i % 2 == 0 ? k : above.size() - 1 - k]);
      for (std::size_t k = 2; k < corners.size(); ++k)
        area += norm(cross(corners[k - 1] - corners[0], corners[k] - corners[0])) / 2;
    }
    EXPECT_NEAR(area, area_of(surface.slice(t)), 1e-3 * area);
  }
}

TEST(SpaceTimeSurface, WhatLeavesTheBoxIsClosedThere) {
  const FormulaInTime everywhere([](const Vec3& x, double t) { return x.x - (t - 2.5) + 0.013; }, 1, 1);
  const SpaceTimeSurface surface = divided(everywhere, 0.25, 0.125);
  for (const double t : {2.0, 2.3, 3.0}) {
    const TriangleMesh mesh = surface.slice(t, {5, 6, 7});
    expect_solid(mesh, 1, 0);
    EXPECT_EQ(mesh.origin.x, 5);
    EXPECT_NEAR(measure_size(mesh).volume, 4 * (1 + (t - 2.5) - 0.013), 0.3);
    for (const Vec3f& v : mesh.vertices)
      for (const double c : {v.x + 5, v.y + 6, v.z + 7}) EXPECT_LT(std::abs(c), 1.001);
  }
}

TEST(SpaceTimeSurface, MovesContinuously) {
  const FormulaInTime ball = moving_ball();
  const SpaceTimeSurface surface = divided(ball, 0.125, 0.0625);
  // Across moments of the lattice, where the connectivity changes.
  for (const double t : {2.0625, 2.5, 2.515625}) {
    const TriangleMesh before = surface.slice(t - 1e-4), at = surface.slice(t), after = surface.slice(t + 1e-4);
    EXPECT_NEAR(area_of(before), area_of(at), 3e-3);
    EXPECT_NEAR(area_of(after), area_of(at), 3e-3);
    EXPECT_NEAR(measure_size(before).volume, measure_size(at).volume, 1e-3);
    EXPECT_NEAR(measure_size(after).volume, measure_size(at).volume, 1e-3);
  }
}

TEST(SpaceTimeSurface, AnyNumberOfThreadsGivesTheSame) {
  const FormulaInTime balls = meeting_balls();
  test::expect_equal_for_any_threads([&] {
    const TriangleMesh mesh = divided(balls, 0.25, 0.125).slice(2.3);
    std::vector<float> numbers;
    for (const Vec3f& v : mesh.vertices) numbers.insert(numbers.end(), {v.x, v.y, v.z});
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t i : t) numbers.push_back(static_cast<float>(i));
    return numbers;
  });
}

TEST(SpaceTimeSurface, RefusesBadOptions) {
  const FormulaInTime ball = moving_ball();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(divided(ball, 0, 0.1), ArgumentError);
  EXPECT_THROW(divided(ball, nan, 0.1), ArgumentError);
  EXPECT_THROW(divided(ball, 0.1, -1), ArgumentError);
  EXPECT_THROW(divided(ball, 0.1, 0.1, nan), ArgumentError);
  EXPECT_THROW(divided(ball, 1e-5, 0.1), ArgumentError);
  EXPECT_THROW(divided(ball, 0.004, 0.004), ArgumentError);
  const SpaceTimeSurface surface = divided(ball, 0.5, 0.25);
  EXPECT_THROW(surface.slice(1.9), ArgumentError);
  EXPECT_THROW(surface.slice(nan), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
