#include "sansmesh/measure/mesh_signed_distance.h"

#include <gtest/gtest.h>

#include <random>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/measure/field_signed_distance.h"
#include "sansmesh/measure/points_signed_distance.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

MeasuredPoint ask(const SignedDistance& surface, const Vec3& x, double farthest = 100) {
  MeasuredPoint found;
  surface.measure({&x, 1}, farthest, {&found, 1});
  return found;
}

/// Signed distance to a box, and whether the closest point is unique.
double box_distance(const Vec3& p, const Vec3& low, const Vec3& high) {
  Vec3 out, in;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = std::max({low[k] - p[k], p[k] - high[k], 0.0});
    in[k] = std::min(p[k] - low[k], high[k] - p[k]);
  }
  return squared_norm(out) > 0 ? norm(out) : -std::min({in.x, in.y, in.z});
}

TEST(MeshDistance, IsExactAroundABox) {
  const TriangleMesh box = test::box_mesh({-1, -1, -1}, {1, 2, 3});
  const MeshDistance surface(box);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> wide(-4, 5);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{wide(random), wide(random), wide(random)};
    const double truth = box_distance(p, {-1, -1, -1}, {1, 2, 3});
    const MeasuredPoint found = ask(surface, p);
    ASSERT_NEAR(found.distance, truth, 1e-12) << p.x << ' ' << p.y << ' ' << p.z;
    ASSERT_NEAR(norm(found.point - p), std::abs(truth), 1e-12);
    ASSERT_FALSE(found.border);
  }
  // Perpendicular to edges and corners, also at ends of face diagonals.
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? 1.0 : -1.0, i & 2 ? 2.0 : -1.0, i & 4 ? 3.0 : -1.0};
    const Vec3 outward{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0};
    EXPECT_NEAR(ask(surface, corner + outward * 0.1).distance, 0.1 * std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(ask(surface, corner - outward * 0.1).distance, -0.1, 1e-12);
    EXPECT_EQ(ask(surface, corner).distance, 0);
  }
}

/// A spike over a notched base: at its foot and tip the normal of the closest face gives the wrong side.
TEST(MeshDistance, SharpVerticesNeedWeightsByAngle) {
  TriangleMesh spike;
  spike.vertices = {{0, 0, 5}, {1, 0, 0}, {0, 0.2f, 0}, {-1, 0, 0}, {0, -0.2f, 0}};
  spike.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 4, 3}, {1, 3, 2}};
  const MeshDistance surface(spike);
  // Ground truth by the generalised winding number: solid angles of the triangles.
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 near = Vec3(spike.vertices[static_cast<std::size_t>(i) % 5]);
    const Vec3 p = near + Vec3{normal(random), normal(random), normal(random)} * (i % 2 ? 0.5 : 0.02);
    double angle = 0;
    for (const Triangle& t : spike.triangles) {
      const Vec3 a = Vec3(spike.vertices[t[0]]) - p, b = Vec3(spike.vertices[t[1]]) - p,
                 c = Vec3(spike.vertices[t[2]]) - p;
      const double x = norm(a), y = norm(b), z = norm(c);
      angle += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
    }
    const bool truth = angle > 6;
    const double d = ask(surface, p).distance;
    if (std::abs(d) < 1e-9) continue;
    ASSERT_EQ(d < 0, truth) << p.x << ' ' << p.y << ' ' << p.z << ": " << d;
    inside += truth;
  }
  EXPECT_GT(inside, 300);
}

TEST(MeshDistance, SoupsAreJoinedByPosition) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh soup;
  for (const Triangle& t : box.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(box.vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  for (Vec3f& v : soup.vertices)
    if (v.x == 0 && &v - soup.vertices.data() > 15) v.x = -0.0f;
  const MeshDistance surface(soup);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> wide(-0.7, 1.7);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p{wide(random), wide(random), wide(random)};
    const MeasuredPoint found = ask(surface, p);
    ASSERT_NEAR(found.distance, box_distance(p, {0, 0, 0}, {1, 1, 1}), 1e-12);
    ASSERT_FALSE(found.border);
  }
}

TEST(MeshDistance, DegenerateTrianglesHaveNoEffect) {
  // A vertex in the middle of an edge of its neighbours, closed by a triangle without area.
  TriangleMesh box = test::box_mesh({0, 0, 0}, {2, 1, 1});
  box.vertices.push_back({1, 1, 1});  // 8, on the edge 6-7
  for (Triangle& t : box.triangles)
    if (t == Triangle{3, 6, 7}) t = {3, 6, 8};
  box.triangles.push_back({3, 8, 7});
  box.triangles.push_back({6, 7, 8});
  box.triangles.push_back({5, 5, 7});
  box.triangles.push_back({0, 0, 0});
  box.vertices.push_back({NAN, 0, 0});
  box.triangles.push_back({0, 1, 9});
  box.triangles.push_back({0, 1, 77});
  const MeshDistance surface(box);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> wide(-1, 3);
  std::normal_distribution<double> small(0, 0.05);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = i % 2 ? Vec3{wide(random), wide(random), wide(random)}
                         : Vec3{0.5 * (1 + wide(random)), 1 + small(random), 1 + small(random)};
    ASSERT_NEAR(ask(surface, p).distance, box_distance(p, {0, 0, 0}, {2, 1, 1}), 1e-12)
        << p.x << ' ' << p.y << ' ' << p.z;
  }
}

TEST(MeshDistance, PlaneWithAHole) {
  // Squares of a grid in z = 0 without the middle ones.
  TriangleMesh plane;
  for (int j = 0; j <= 10; ++j)
    for (int i = 0; i <= 10; ++i) plane.vertices.push_back({float(i), float(j), 0});
  for (std::uint32_t j = 0; j < 10; ++j)
    for (std::uint32_t i = 0; i < 10; ++i) {
      if (i >= 4 && i < 6 && j >= 4 && j < 6) continue;
      const std::uint32_t a = j * 11 + i;
      plane.triangles.push_back({a, a + 1, a + 12});
      plane.triangles.push_back({a, a + 12, a + 11});
    }
  plane.origin = {1000, 2000, 3000};
  const MeshDistance surface(plane);
  const auto at = [&](double x, double y, double z) { return ask(surface, plane.origin + Vec3{x, y, z}); };
  EXPECT_NEAR(at(2.3, 2.2, 0.5).distance, 0.5, 1e-12);
  EXPECT_NEAR(at(2.3, 2.2, -0.5).distance, -0.5, 1e-12);
  EXPECT_FALSE(at(2.3, 2.2, -0.5).border);
  EXPECT_FALSE(at(2, 2, 0.1).border);
  EXPECT_NEAR(at(5, 4.5, 0.5).distance, std::hypot(0.5, 0.5), 1e-12);
  EXPECT_NEAR(at(5, 4.5, -0.5).distance, -std::hypot(0.5, 0.5), 1e-12);
  EXPECT_TRUE(at(5, 4.5, 0.5).border);
  EXPECT_TRUE(at(-1, -1, 1).border);
  EXPECT_NEAR(at(-1, -1, 1).distance, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(norm(at(5, 4.5, 0.5).point - Vec3{1005, 2004, 3000}), 0, 1e-12);
}

TEST(MeshDistance, NothingToMeasureFrom) {
  TriangleMesh none;
  EXPECT_THROW(MeshDistance{none}, DataError);
  EXPECT_THROW(PointsDistance{none}, DataError);
  none.vertices = {{NAN, 0, 0}};
  EXPECT_THROW(PointsDistance{none}, DataError);
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(std::isnan(ask(MeshDistance(box), {NAN, 0, 0}).distance));
  EXPECT_TRUE(std::isnan(ask(PointsDistance(box), {0, INFINITY, 0}).distance));
  const test::SphereField sphere(1);
  EXPECT_TRUE(std::isnan(ask(FieldDistance(sphere), {0, NAN, 0}).distance));
}

TEST(PointsDistance, ApproximatesTheSurfaceBetweenSamples) {
  TriangleMesh sphere = test::octasphere(5);
  sphere.normals = sphere.vertices;
  sphere.triangles.clear();
  sphere.origin = {10, 0, 0};
  const PointsDistance surface(sphere);
  EXPECT_TRUE(surface.has_sides());
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> radius(0.9, 1.1);
  for (int i = 0; i < 5000; ++i) {
    const double r = radius(random);
    const Vec3 p = Vec3{10, 0, 0} + normalized(Vec3{normal(random), normal(random), normal(random)}) * r;
    // Samples are 0.05 apart; the tangent plane deviates from the sphere by the square of half of that.
    ASSERT_NEAR(ask(surface, p).distance, r - 1, 1.5e-3);
  }
  EXPECT_NEAR(ask(surface, {13, 0, 0}).distance, 2, 1e-2);
  sphere.normals.clear();
  const PointsDistance plain(sphere);
  EXPECT_FALSE(plain.has_sides());
  EXPECT_NEAR(ask(plain, {10.5, 0, 0}).distance, 0.5, 2e-3);
}

TEST(PointsDistance, BeyondTheLastSampleTheDistanceIsToTheRim) {
  TriangleMesh patch;
  for (int j = 0; j <= 20; ++j)
    for (int i = 0; i <= 20; ++i) {
      patch.vertices.push_back({float(i) / 20, float(j) / 20, 0});
      patch.normals.push_back({0, 0, 1});
    }
  const PointsDistance surface(patch);
  EXPECT_NEAR(ask(surface, {0.5, 0.5, 0.3}).distance, 0.3, 1e-6);
  EXPECT_NEAR(ask(surface, {0.51, 0.52, -0.3}).distance, -0.3, 1e-6);
  const double off = ask(surface, {3, 0.5, 0.4}).distance;
  EXPECT_NEAR(off, std::hypot(2.0, 0.4), 0.12);
  EXPECT_GT(off, 1.8);
}

TEST(FieldDistance, ScaledValuesGiveTrueDistances) {
  const test::TorusField torus;  // its values are not distances
  const FieldDistance surface(torus);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> angle(0, 6.2831853), radius(0.1, 0.55);
  for (int i = 0; i < 3000; ++i) {
    const double u = angle(random), v = angle(random), r = radius(random), q = 1 + r * std::cos(v);
    const Vec3 p{q * std::cos(u), q * std::sin(u), r * std::sin(v)};
    const MeasuredPoint found = ask(surface, p);
    ASSERT_NEAR(found.distance, r - 0.35, 1e-7) << r;
    double value = 0;
    torus.evaluate({&found.point, 1}, {&value, 1});
    ASSERT_NEAR(value, 0, 1e-7);
  }
}

TEST(FieldDistance, AgreesWithTheMesh) {
  const test::TorusField torus;
  const TriangleMesh mesh = test::torus_mesh(400, 200);
  const FieldDistance field(torus);
  const MeshDistance triangles(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> wide(-1.5, 1.5);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p{wide(random), wide(random), 0.4 * wide(random)};
    const double a = ask(field, p).distance, b = ask(triangles, p).distance;
    if (std::isnan(a) || std::hypot(p.x, p.y) < 0.3) continue;  // near the axis two sides are equally close
    if (std::abs(b + 0.35) < 0.05) continue;                    // and in the middle of the tube all are
    ++compared;
    ASSERT_NEAR(a, b, 1e-3) << p.x << ' ' << p.y << ' ' << p.z;
  }
  EXPECT_GT(compared, 2000);
}

TEST(FieldDistance, StopsAtFarPoints) {
  const test::SphereField sphere(1);
  const FieldDistance kept(sphere);
  EXPECT_TRUE(std::isnan(ask(kept, {3, 0, 0}, 0.5).distance));
  EXPECT_NEAR(ask(kept, {3, 0, 0}, 2.5).distance, 2, 1e-9);
  EXPECT_TRUE(std::isnan(ask(kept, {0, 0, 0}).distance));  // no direction leads out of the centre
}

/// A fitted function in the coordinates of its input.
struct Fitted {
  explicit Fitted(PointSet points, const FitOptions& options = {})
      : function(fit_surface_function(std::move(points), options, progress)), field(function.field, function.frame) {}
  Progress progress;
  FittedFunction function;
  PlacedField field;
};

std::vector<MeasuredPoint> ask_all(const SignedDistance& surface, const std::vector<Vec3>& x, double farthest = 100) {
  std::vector<MeasuredPoint> found(x.size());
  surface.measure(x, farthest, found);
  return found;
}

/// Values of fitted functions are floats: Newton's steps end in noise, which must count as convergence.
TEST(FieldDistance, ConvergesAtAllSamplesOfFittedFunctions) {
  const double noise = 0.02;
  PointSet cloud = test::sphere(6000);
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Vec3> samples;
  for (Vec3f& p : cloud.positions) {
    p = Vec3f(Vec3(p) * (1 + normal(random)));
    samples.push_back(cloud.origin + Vec3(p));
  }
  const Fitted fitted(cloud);
  double sum = 0, squares = 0;
  std::size_t measured = 0;
  for (const MeasuredPoint& m : ask_all(FieldDistance(fitted.field), samples)) {
    EXPECT_FALSE(m.lost);
    if (std::isnan(m.distance)) continue;
    ++measured;
    sum += m.distance, squares += m.distance * m.distance;
  }
  EXPECT_GE(static_cast<double>(measured), 0.999 * static_cast<double>(samples.size()));
  const double n = static_cast<double>(measured);
  EXPECT_NEAR(std::sqrt(squares / n), noise, 0.1 * noise);
  EXPECT_NEAR(sum / n, 0, 0.1 * noise);
}

TEST(FieldDistance, FittedFunctionOfASphereNearAndFar) {
  const PointSet cloud = test::sphere(5000);
  const Fitted fitted(cloud);
  const FieldDistance surface(fitted.field);
  for (const double r : {0.3, 0.95, 1.0, 1.05, 1.5, 2.5, 5.0, 40.0}) {
    std::vector<Vec3> x;
    for (const Vec3f& p : cloud.positions) x.push_back((cloud.origin + Vec3(p)) * r);
    double sum = 0, worst = 0;
    std::size_t measured = 0;
    for (const MeasuredPoint& m : ask_all(surface, x)) {
      if (std::isnan(m.distance)) continue;
      ++measured;
      sum += m.distance;
      worst = std::max(worst, std::abs(m.distance - (r - 1)));
    }
    EXPECT_GE(static_cast<double>(measured), 0.999 * static_cast<double>(x.size())) << r;
    EXPECT_NEAR(sum / static_cast<double>(measured), r - 1, 0.01 * std::abs(r - 1) + 1e-4) << r;
    EXPECT_LT(worst, 0.01 * std::abs(r - 1) + 2e-3) << r;
  }
}

TEST(FieldDistance, FittedFunctionAgainstItself) {
  const Fitted fitted(test::sphere(5000));
  Progress progress;
  const TriangleMesh mesh = mesh_function(fitted.function, {}, progress);
  std::vector<Vec3> x;
  for (const Vec3f& p : mesh.vertices) x.push_back(mesh.origin + Vec3(p));
  std::size_t measured = 0;
  for (const MeasuredPoint& m : ask_all(FieldDistance(fitted.field), x, 0.1)) {
    measured += std::isfinite(m.distance);
    EXPECT_LT(std::abs(m.distance), 3e-3);
  }
  EXPECT_EQ(measured, x.size());
}

TEST(FieldDistance, BisectsWhereNewtonFails) {
  // Steep and flat regions and float-like noise: wrong gradients, but correct signs. Newton's step from d leads to −2
  // d.
  const test::FormulaField rough([](const Vec3& x, Vec3& gradient) {
    const double d = norm(x) - 1;
    gradient = normalized(x) * (1 / (3 * std::max(1e-12, std::cbrt(d * d))));
    return std::cbrt(d) * (1 + 1e-7 * std::sin(1e9 * x.x));
  });
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> radius(0.2, 4);
  std::vector<Vec3> x;
  std::vector<double> truth;
  for (int i = 0; i < 2000; ++i) {
    const double r = radius(random);
    x.push_back(normalized(Vec3{normal(random), normal(random), normal(random)}) * r);
    truth.push_back(r - 1);
  }
  const std::vector<MeasuredPoint> found = ask_all(FieldDistance(rough), x);
  for (std::size_t i = 0; i < x.size(); ++i)
    ASSERT_NEAR(found[i].distance, truth[i], 7e-6) << i;  // 1e-6 of the diagonal
}

TEST(FieldDistance, SkipsNoPartOfTheSurface) {
  // Two balls in a row: from beyond one, a long step leads to the other. Flat, so that every step is several times too
  // long.
  const test::FormulaField balls(
      [](const Vec3& x, Vec3& gradient) {
        const Vec3 to{std::abs(x.x) - 1, x.y, x.z};
        const double flat = std::tanh(norm(to) - 0.5);
        gradient = Vec3{std::copysign(to.x, x.x * to.x), to.y, to.z} * ((1 - flat * flat) / norm(to));
        return flat;
      },
      Box3{{-4, -2, -2}, {4, 2, 2}});
  const FieldDistance surface(balls);
  for (const double x : {1.6, 2.0, 2.5, 3.0, 4.0, 6.0}) EXPECT_NEAR(ask(surface, {x, 0, 0}).distance, x - 1.5, 1e-6);
}

TEST(FieldDistance, DistinguishesFarAndLostPoints) {
  const test::SphereField sphere(1);
  const FieldDistance surface(sphere);
  EXPECT_FALSE(ask(surface, {3, 0, 0}, 0.5).lost);
  EXPECT_FALSE(ask(surface, {1.2, 0, 0}, 0.5).lost);
  EXPECT_TRUE(ask(surface, {0, 0, 0}).lost);
}

TEST(PointsDistance, ThePartThatSamplingAndNoiseCauseIsKnown) {
  constexpr int kSamples = 20000;
  for (const double noise : {0.0, 0.3, 1.0, 4.0})  // in spacings
    for (const bool normals : {false, true}) {
      std::mt19937 random(5);
      const double side = std::sqrt(static_cast<double>(kSamples));
      std::uniform_real_distribution<double> place(0, side);
      std::normal_distribution<double> height;
      TriangleMesh plane;
      for (int i = 0; i < kSamples; ++i) {
        plane.vertices.push_back(Vec3f(Vec3{place(random), place(random), noise * height(random)}));
        if (normals) plane.normals.push_back({0, 0, 1});
      }
      const PointsDistance surface(plane);
      double sum = 0;
      constexpr int kQueries = 4000;
      for (int i = 0; i < kQueries; ++i) {
        const double x = 0.1 * side + 0.8 * place(random), y = 0.1 * side + 0.8 * place(random);
        const double d = ask(surface, {x, y, 0}).distance;
        sum += d * d;
      }
      const double found = std::sqrt(sum / kQueries);
      EXPECT_NEAR(rms_to_samples(1, noise, normals), found, 0.03 * found + 0.005) << noise << ' ' << normals;
    }
  EXPECT_EQ(rms_to_samples(0, 1, true), 0);
}

}  // namespace
}  // namespace sansmesh::inline v1
