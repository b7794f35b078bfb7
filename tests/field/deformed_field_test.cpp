#include "sansmesh/field/deformed_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "csg/catalogue.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/error.h"
#include "sansmesh/field/inverse_map.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "support/space_maps.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using namespace csg;

std::vector<Vec3> points_in(const Box3& box, std::size_t count, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> x(count);
  for (Vec3& p : x)
    for (std::size_t k = 0; k < 3; ++k) p[k] = box.lower[k] + u(random) * (box.upper[k] - box.lower[k]);
  return x;
}

std::shared_ptr<const Solid> shared(const Solid& s) { return std::make_shared<const Solid>(s); }

/// Shear and stretch with determinant 0.9 · 1.3 · 0.7.
AffineSpaceMap sheared() { return {{Vec3{0.9, 0, 0}, Vec3{0.2, 1.3, 0}, Vec3{-0.1, 0.3, 0.7}}, {0.3, -2, 0.1}}; }

void expect_gradients(const ScalarField& field, std::span<const Vec3> x, double tolerance) {
  constexpr double h = 1e-6;
  std::vector<double> value(x.size());
  std::vector<Vec3> gradient(x.size());
  field.evaluate(x, value, gradient);
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<Vec3> low(x.begin(), x.end()), high = low;
    for (Vec3& p : low) p[k] -= h;
    for (Vec3& p : high) p[k] += h;
    std::vector<double> a(x.size()), b(x.size());
    field.evaluate(low, a), field.evaluate(high, b);
    std::size_t off = 0;  // at creases of pieces and of the stretch lattice
    for (std::size_t i = 0; i < x.size(); ++i) off += !(std::abs(gradient[i][k] - (b[i] - a[i]) / (2 * h)) < tolerance);
    EXPECT_LE(off, x.size() / 200) << "axis " << k;
  }
}

void expect_ranges_hold(const ScalarField& field, const Box3& box, double radius) {
  const std::vector<Vec3> x = points_in(box, 300);
  std::vector<ValueRange> found(x.size());
  field.ranges(x, radius, found);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> y;
  for (const Vec3& p : x)
    for (int k = 0; k < 40; ++k)
      y.push_back(p + normalized(Vec3{normal(random), normal(random), normal(random)}) * (radius * u(random)));
  std::vector<double> values(y.size());
  field.evaluate(y, values);
  for (std::size_t i = 0; i < y.size(); ++i) {
    ASSERT_LE(found[i / 40].least, values[i] + 1e-12);
    ASSERT_GE(found[i / 40].most, values[i] - 1e-12);
  }
}

TEST(DeformedField, TheIdentityChangesNothing) {
  const auto map = std::make_shared<const AffineSpaceMap>(identity_map());
  for (const NamedSolid& s : catalogue()) {
    const DeformedField field(shared(s.solid), map);
    const std::vector<Vec3> x = points_in({{-2, -2, -2}, {2, 2, 2}}, 300);
    std::vector<double> a(x.size()), b(x.size());
    std::vector<Vec3> ga(x.size()), gb(x.size());
    s.solid.evaluate(x, a, ga), field.evaluate(x, b, gb);
    EXPECT_EQ(a, b) << s.name;
    EXPECT_EQ(ga, gb) << s.name;
    EXPECT_EQ(field.pieces(), s.solid.pieces());
    const Box3 before = s.solid.bounds(), after = field.bounds();
    if (!is_finite(before.lower) || !is_finite(before.upper)) continue;
    EXPECT_TRUE(after.contains(before.lower) && after.contains(before.upper)) << s.name;
    EXPECT_LT(after.diagonal(), 1.25 * before.diagonal()) << s.name;
  }
}

TEST(DeformedField, ABallUnderAnAffineMapIsAnEllipsoid) {
  const DeformedField field(shared(sphere({0.2, -0.1, 0.3}, 0.9)), std::make_shared<const AffineSpaceMap>(sheared()));
  Progress progress;
  CsgMeshReport report;
  CsgMeshOptions options;
  options.resolution = 96;
  mesh_csg(field, options, progress, &report);
  EXPECT_TRUE(report.closed);
  EXPECT_NEAR(report.volume, 4.0 / 3 * std::numbers::pi * std::pow(0.9, 3) / (0.9 * 1.3 * 0.7), 2e-3 * report.volume);
  expect_gradients(field, points_in(field.bounds(), 1000), 1e-6);
  expect_ranges_hold(field, field.bounds(), 0.3);
  // Values never exceed the distance, and equal it near the surface along the steepest direction.
  const std::vector<Vec3> x = points_in(field.bounds(), 2000);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  field.evaluate(x, values, gradients);
  double most = 0;
  for (const Vec3& g : gradients) most = std::max(most, norm(g));
  EXPECT_LE(most, 1 + 1e-9);
  EXPECT_GT(most, 0.95);
}

TEST(DeformedField, TwistedSolidsKeepTheirVolumeAndTheirCreases) {
  const Solid bar = box({-0.5, -0.3, -1}, {0.5, 0.3, 1});
  const auto map = std::make_shared<const TwistMap>(1.2);
  const DeformedField field(shared(bar), map);
  expect_gradients(field, points_in({{-0.7, -0.7, -1.1}, {0.7, 0.7, 1.1}}, 1000), 1e-5);
  expect_ranges_hold(field, {{-0.8, -0.8, -1.2}, {0.8, 0.8, 1.2}}, 0.1);
  Progress progress;
  CsgMeshReport report;
  CsgMeshOptions options;
  options.resolution = 64;
  const TriangleMesh mesh = mesh_csg(field, options, progress, &report);
  EXPECT_TRUE(report.closed);
  EXPECT_NEAR(report.volume, 1.2, 2e-3);
  // The long edges are helices with vertices on them, which no grid places there by itself.
  std::size_t on_edges = 0;
  for (const Vec3f& v : mesh.vertices) {
    const Vec3 p = mesh.origin + Vec3(v);
    Vec3 u;
    map->map(std::span(&p, 1), {std::span(&u, 1), {}, {}, {}});
    on_edges += std::abs(std::abs(u.x) - 0.5) < 1e-5 && std::abs(std::abs(u.y) - 0.3) < 1e-5;
  }
  EXPECT_GT(on_edges, 100u);
}

TEST(DeformedField, GapsAreClosedByOneMorePiece) {
  for (const double near : {0.15, 10.0}) {
    const DeformedField field(shared(sphere({}, 1)), std::make_shared<const SplitMap>(0.1, near));
    EXPECT_EQ(field.pieces(), 2u);
    Progress progress;
    CsgMeshReport report;
    CsgMeshOptions options;
    options.resolution = 48;
    const TriangleMesh mesh = mesh_csg(field, options, progress, &report);
    EXPECT_TRUE(report.closed);
    EXPECT_EQ(report.components, 2u);
    EXPECT_NEAR(report.volume, 4.0 / 3 * std::numbers::pi, 0.02);
    for (const Vec3f& v : mesh.vertices) EXPECT_GT(std::abs(mesh.origin.x + static_cast<double>(v.x)), 0.1 - 1e-4);
  }
}

/// Map that shifts the half-space above a plane: a cut whose sides slid or separated. As for cuts by handles, the gap
/// is the distance of both the point and its source from the plane.
class ShiftMap final : public SpaceMap {
 public:
  explicit ShiftMap(const Vec3& way, double at = 0) : way_(way), at_(at) {}
  bool has_gaps() const override { return true; }
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    identity_map().map(x, wanted);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double s = x[i].x - at_, z = s < 0 ? s : s + way_.x, sum = s + z;
      if (s >= 0 && !wanted.positions.empty()) wanted.positions[i] += way_;
      if (!wanted.gaps.empty()) wanted.gaps[i] = sum != 0 ? -s * z / std::abs(sum) : 0;
      if (!wanted.gap_gradients.empty())
        wanted.gap_gradients[i] = {(s < 0 ? 1 : -1) * (s * s + z * z) / (sum * sum), 0, 0};
    }
  }

 private:
  Vec3 way_;
  double at_;
};

TEST(DeformedField, RangesHoldWhereTheMapJumps) {
  for (const Vec3& way : {Vec3{0, 2, 0}, Vec3{0, 0.3, 0}, Vec3{1, 0, 0}, Vec3{3, 0, 0}}) {
    const DeformedField field(shared(sphere({}, 1)), std::make_shared<const ShiftMap>(way));
    for (const double radius : {0.02, 0.1, 0.3}) {
      expect_ranges_hold(field, {{-0.1, -2, -1}, {0.1, 2, 1}}, radius);
      // Away from the cut, ranges are no wider than those of a smooth map.
      std::vector<Vec3> x{{-0.95, 0.3, 0.1}};
      std::vector<ValueRange> range(1);
      field.ranges(x, radius, range);
      if (radius < 0.2) {
        EXPECT_LT(range[0].most - range[0].least, 4 * radius);
      }
    }
  }
}

TEST(DeformedField, SolidsReachTheFacesOfCuts) {
  // The upper part of the ball is removed: the rest extends to the plane.
  const std::vector<Vec3> x = points_in({{-0.1, -1, -1}, {0.1, 1, 1}}, 20'000);
  std::vector<double> values(x.size());
  for (const double at : {-0.03, -0.01, 0.0, 0.01, 0.03}) {
    const DeformedField field(shared(sphere({}, 1)), std::make_shared<const ShiftMap>(Vec3{3, 0, 0}, at));
    field.evaluate(x, values);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (values[i] < 0) {
        ASSERT_TRUE(field.bounds().contains(x[i])) << at << " " << x[i].x;
      }
    if (at < 0.03) continue;
    Progress progress;
    CsgMeshReport report;
    CsgMeshOptions options;
    options.resolution = 64;
    mesh_csg(field, options, progress, &report);
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, std::numbers::pi * (2.0 / 3 + at - at * at * at / 3), 4e-3);
  }
}

TEST(DeformedField, NothingIsWhereTheMapIsNotDefined) {
  class Half final : public SpaceMap {
   public:
    void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
      identity_map().map(x, wanted);
      for (std::size_t i = 0; i < x.size(); ++i)
        if (x[i].x > 0 && !wanted.positions.empty()) wanted.positions[i] = {NAN, NAN, NAN};
    }
  };
  const DeformedField field(shared(sphere({}, 1)), std::make_shared<const Half>());
  const std::vector<Vec3> x{{-0.5, 0, 0}, {0.5, 0, 0}};
  std::vector<double> values(2);
  std::vector<std::uint8_t> inside(2);
  field.evaluate_in_domain(x, values, {}, inside);
  EXPECT_NEAR(values[0], -0.5, 1e-12);
  EXPECT_GT(values[1], 1);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 0}));
}

TEST(DeformedField, BoundsAreFoundFarAway) {
  Jacobian small{Vec3{0.01, 0, 0}, Vec3{0, 0.01, 0}, Vec3{0, 0, 0.01}};  // the image is a hundred times larger
  const DeformedField large(shared(sphere({1, 2, 3}, 1)), std::make_shared<const AffineSpaceMap>(small, Vec3{5, 5, 5}));
  const Vec3 center{-400, -300, -200};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(large.bounds().lower[k], center[k] - 100);
    EXPECT_GT(large.bounds().lower[k], center[k] - 130);
    EXPECT_GT(large.bounds().upper[k], center[k] + 100);
    EXPECT_LT(large.bounds().upper[k], center[k] + 130);
  }
  const AffineSpaceMap nowhere({Vec3{}, Vec3{}, Vec3{}}, {9, 9, 9});
  EXPECT_THROW(DeformedField(shared(sphere({}, 1)), std::make_shared<const AffineSpaceMap>(nowhere)), DataError);
  const AffineSpaceMap everywhere({Vec3{}, Vec3{}, Vec3{}}, {});
  EXPECT_THROW(DeformedField(shared(sphere({}, 1)), std::make_shared<const AffineSpaceMap>(everywhere)), DataError);
}

TEST(InverseMap, GoesBackAndSaysWhereItCannot) {
  const TwistMap twist(1.5);
  const std::vector<Vec3> x = points_in({{-1, -1, -1}, {1, 1, 1}}, 500);
  std::vector<Vec3> u(x.size());
  twist.map(x, {u, {}, {}, {}});
  const InvertedPoints back = inverse_map(twist, u, u);
  EXPECT_EQ(back.missed, 0u);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT(norm(back.positions[i] - x[i]), 1e-9);
  const AffineSpaceMap flat({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{}}, {});
  const std::vector<Vec3> targets{{0.5, 0.5, 0}, {0.5, 0.5, 1}}, starts{{0, 0, 0.3}, {0, 0, 0.3}};
  const InvertedPoints some = inverse_map(flat, targets, starts);
  EXPECT_EQ(some.found, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(some.missed, 1u);
  EXPECT_LT(norm(some.positions[1] - Vec3{0.5, 0.5, 0.3}), 1e-9);  // nearest point
  EXPECT_THROW(inverse_map(flat, targets, std::span(starts).first(1)), ArgumentError);
}

TEST(InverseMap, IsAMap) {
  const auto twist = std::make_shared<const TwistMap>(1.5);
  const InverseMap back(twist, 1e-12), started(twist, 1e-12, std::make_shared<const TwistMap>(-1.5));
  const std::vector<Vec3> u = points_in({{-1, -1, -1}, {1, 1, 1}}, 100);
  std::vector<Vec3> x(u.size()), y(u.size()), exact(u.size());
  std::vector<Jacobian> j(u.size()), expected(u.size());
  std::vector<double> gaps(u.size(), 5);
  back.map(u, {x, j, gaps, {}});
  started.map(u, {y, {}, {}, {}});
  TwistMap(-1.5).map(u, {exact, expected, {}, {}});
  for (std::size_t i = 0; i < u.size(); ++i) {
    EXPECT_LT(norm(x[i] - exact[i]), 1e-11);
    EXPECT_LT(norm(y[i] - exact[i]), 1e-11);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(norm(j[i][k] - expected[i][k]), 1e-9);
    EXPECT_LT(gaps[i], -1e300);
  }
  const AffineSpaceMap flat({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{}}, {});
  const std::vector<Vec3> off{{0, 0, 1}};
  std::vector<Vec3> nowhere(1);
  InverseMap(std::make_shared<const AffineSpaceMap>(flat), 1e-9).map(off, {nowhere, {}, {}, {}});
  EXPECT_TRUE(std::isnan(nowhere[0].x));
}

TEST(MapStretch, IsTheLargestSingularValue) {
  // Rotation between two stretches.
  const double c = std::cos(0.7), s = std::sin(0.7);
  EXPECT_NEAR(largest_stretch({Vec3{2 * c, 3 * s, 0}, Vec3{-2 * s, 3 * c, 0}, Vec3{0, 0, 0.5}}), 3, 1e-12);
  EXPECT_EQ(largest_stretch({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}), 1);
  EXPECT_NEAR(largest_stretch({Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}}), 1, 1e-12);
  EXPECT_EQ(largest_stretch({Vec3{}, Vec3{}, Vec3{}}), 0);
  // On a lattice: a twist stretches most far from its axis.
  const MapStretch stretch(TwistMap(1), {{-1, -1, -1}, {1, 1, 1}});
  const Vec3 axis{0, 0, 0}, far{1, 1, 0.3};
  EXPECT_NEAR(stretch.at(axis), 1, 1e-9);
  EXPECT_NEAR(stretch.at(far), largest_stretch({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 1, 1}}), 1e-9);
  EXPECT_LE(stretch.around(axis, 0.1).most, stretch.range().most);
  EXPECT_GE(stretch.around(far, 0.1).most, stretch.at(far));
}

}  // namespace
}  // namespace sansmesh::inline v1
