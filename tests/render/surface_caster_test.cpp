#include "sansmesh/render/surface/surface_caster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "analytic_surfaces.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using test::cast;
using test::SphereCrossings;
using test::Spheres;

constexpr double kTolerance = 1e-3;

std::size_t count_hits(const std::vector<CastHit>& hits) {
  return static_cast<std::size_t>(std::count_if(hits.begin(), hits.end(), [](const CastHit& h) { return h.hit; }));
}

TEST(SurfaceCaster, FindsASphereWhereItIs) {
  const Spheres sphere({1});
  for (const double reach : {0.8, 1.5, 4.0}) {
    const BallUnion balls = test::sphere_balls(20000, 1, reach);
    const SurfaceCaster caster(sphere, balls);
    const auto rays = test::random_rays(20000, 1.2f);
    const auto hits = cast(caster, rays);
    EXPECT_GT(count_hits(hits), rays.size() / 4);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const SphereCrossings exact(rays[i], 1);
      const double radius = balls.radii[0], graze = std::abs(exact.closest - 1);
      if (graze < kTolerance * radius) continue;
      ASSERT_EQ(hits[i].hit, exact.near > 0) << "passes the centre at " << exact.closest;
      if (!hits[i].hit) continue;
      // For nearly tangent rays, a small distance to the surface is large along the ray.
      EXPECT_NEAR(norm(hits[i].position), 1, 2 * kTolerance * radius);
      EXPECT_NEAR(hits[i].distance, exact.near, 2 * kTolerance * radius + 1e-6) << exact.closest;
      EXPECT_GT(dot(Vec3(hits[i].normal), normalized(hits[i].position)), 0.9999);
      EXPECT_LT(norm(hits[i].position - Vec3(rays[i].origin + rays[i].direction * hits[i].distance)), 1e-5);
      EXPECT_EQ(hits[i].radius, balls.radii[0]);
    }
  }
}

/// The distance to a sphere, with a small error in every other of many slices.
class Patches : public ScalarField {
 public:
  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double slice = std::floor(20 * x[i].z + 20 * x[i].x);
      values[i] = norm(x[i]) - (std::fmod(slice, 2) == 0 ? 1 : 0.98);
      if (!gradients.empty()) gradients[i] = normalized(x[i]);
    }
  }
};

TEST(SurfaceCaster, PatchesThatDoNotMeetHaveNoGaps) {
  const Patches field;
  const BallUnion balls = test::sphere_balls(20000, 1, 2.5);
  SurfaceCastOptions options;
  const std::vector<CastRay> rays = test::random_rays(5000, 0.9f);
  const auto missed = [&] {
    const std::vector<CastHit> hits = cast(SurfaceCaster(field, balls, options), rays);
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const SphereCrossings inner(rays[i], 0.975);
      if (inner.near > 0) count += !hits[i].hit || static_cast<double>(hits[i].distance) > inner.near + 0.01;
    }
    return count;
  };
  EXPECT_GT(missed(), 20u) << "rays slip through where the sign jumps";
  options.jump = 0.5;
  EXPECT_EQ(missed(), 0u);
  options.jump = 2;
  EXPECT_THROW(SurfaceCaster(field, balls, options), ArgumentError);
}

TEST(SurfaceCaster, FindsGrazedSpheres) {
  const Spheres sphere({1});
  const BallUnion balls = test::sphere_balls(20000);
  const SurfaceCaster caster(sphere, balls);
  const double radius = balls.radii[0];
  // Rays parallel to x that dip into the sphere by shares of a ball's radius.
  std::vector<CastRay> rays;
  std::vector<double> depths;
  for (int i = 0; i < 400; ++i) {
    const double depth = radius * std::pow(10, -3.0 + 3.0 * i / 400), angle = 0.61 * i;
    const double at = 1 - depth;
    rays.push_back({Vec3f(Vec3{-3, at * std::cos(angle), at * std::sin(angle)}), {1, 0, 0}});
    depths.push_back(depth);
  }
  int found = 0, seen = 0;
  const auto hits = cast(caster, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (depths[i] < 2 * kTolerance * radius) continue;
    ++seen;
    found += hits[i].hit;
    if (hits[i].hit) {
      EXPECT_NEAR(norm(hits[i].position), 1, kTolerance * radius);
      EXPECT_LT(hits[i].position.x, 0) << "the first of both crossings";
    }
  }
  EXPECT_EQ(found, seen);
  // Rays that pass above miss it.
  for (CastRay& ray : rays) ray.origin = ray.origin * 1.0f, ray.origin.y *= 1.05f, ray.origin.z *= 1.05f;
  for (const CastHit& hit : cast(caster, rays)) EXPECT_TRUE(!hit.hit || norm(hit.position) < 1 + 1e-4);
}

TEST(SurfaceCaster, FindsATorus) {
  const test::Torus torus;
  const BallUnion balls = test::torus_balls(30000, 3);
  const SurfaceCaster caster(torus, balls);
  const auto rays = test::random_rays(20000, 1.3f);
  const auto hits = cast(caster, rays);
  const double radius = balls.radii[0];
  int seen = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // Sphere tracing with the exact distance.
    double t = 0, value = 1;
    const Vec3 o(rays[i].origin), d(rays[i].direction);
    double least = 1;
    for (int k = 0; k < 3000 && t < 6 && value > 1e-9; ++k) {
      const Vec3 x = o + d * t;
      torus.evaluate(std::span(&x, 1), std::span(&value, 1));
      least = std::min(least, value);
      t += value;
    }
    const bool hit = value <= 1e-6;
    if (!hit && least < 2 * kTolerance * radius) continue;
    ASSERT_EQ(hits[i].hit, hit) << i << ": nearest " << least;
    if (!hit) continue;
    ++seen;
    EXPECT_NEAR(hits[i].distance, t, 0.02 * radius) << i;
  }
  EXPECT_GT(seen, 3000);
}

TEST(SurfaceCaster, StartsAnywhere) {
  const Spheres shell({1, 0.9});
  BallUnion balls = test::sphere_balls(8000, 1);
  const BallUnion inner = test::sphere_balls(8000, 0.9);
  balls.centers.insert(balls.centers.end(), inner.centers.begin(), inner.centers.end());
  balls.radii.insert(balls.radii.end(), inner.radii.begin(), inner.radii.end());
  const SurfaceCaster caster(shell, balls);
  // From all heights, outwards and inwards, radially and obliquely.
  for (const double height : {0.0, 0.5, 0.85, 0.89, 0.91, 0.95, 0.99, 0.9995, 1.0005, 1.01, 1.05, 1.5}) {
    std::vector<CastRay> rays;
    for (const CastRay& ray : test::random_rays(500, 1)) {
      const Vec3f out = normalized(ray.origin);
      rays.push_back({out * static_cast<float>(height), ray.direction});
      rays.push_back({out * static_cast<float>(height), out});
    }
    const auto hits = cast(caster, rays);
    // No ray leaves the outer sphere without a hit.
    EXPECT_GT(count_hits(hits), height < 1 ? rays.size() * 99 / 100 : 0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      double expected = std::numeric_limits<double>::infinity();
      bool grazes = false;
      for (const double radius : {1.0, 0.9}) {
        const SphereCrossings exact(rays[i], radius);
        for (const double t : {exact.near, exact.far})
          if (t > 0) expected = std::min(expected, t);
        grazes |= std::abs(exact.closest - radius) < 1e-4;
      }
      if (grazes) continue;
      ASSERT_EQ(hits[i].hit, std::isfinite(expected)) << height << " ray " << i;
      if (hits[i].hit) {
        EXPECT_NEAR(hits[i].distance, expected, 3e-4) << height;
      }
    }
  }
}

TEST(SurfaceCaster, SeesBothSidesAndKeepsWithinTheRay) {
  const Spheres sphere({1});
  const SurfaceCaster caster(sphere, test::sphere_balls(5000));
  const std::vector<CastRay> rays{{{0, 0, 0}, {0, 1, 0}},
                                  {{0, -3, 0}, {0, 1, 0}},
                                  {{0, -3, 0}, {0, 1, 0}, 3},
                                  {{0, -3, 0}, {0, 1, 0}, 0, 1.9f},
                                  {{0, -3, 0}, {0, 1, 0}, 3, 3.9f},
                                  {{0, -3, 0}, {0, 1, 0}, 2.5f, 4.1f},
                                  {{0, -3, 0}, {0, 1, 0}, 0, 2.001f}};
  const auto hits = cast(caster, rays);
  const double expected[] = {1, 2, 4, -1, -1, 4, 2};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(hits[i].hit, expected[i] > 0) << i;
    if (!hits[i].hit) continue;
    EXPECT_NEAR(hits[i].distance, expected[i], 1e-4);
    EXPECT_NEAR(std::abs(hits[i].normal.y), 1, 1e-3);
    EXPECT_GT(hits[i].normal.y * hits[i].position.y, 0) << "normals point outwards from either side";
  }
  // A ray that starts on the surface does not hit it there.
  for (const CastRay& ray : test::random_rays(1000, 0.2f)) {
    const Vec3f at = normalized(ray.origin);
    const std::vector<CastRay> from{{at + at * 1e-3f, at},
                                    {at + at * 1e-3f, normalized(at + ray.direction * 0.3f)},
                                    {at - at * 1e-3f, ray.direction}};
    const auto next = cast(caster, from);
    EXPECT_FALSE(next[0].hit);
    EXPECT_FALSE(next[1].hit);
    EXPECT_TRUE(next[2].hit && next[2].distance > 0.5f);
  }
}

TEST(SurfaceCaster, NothingExistsOutsideOfTheBalls) {
  const Spheres sphere({1});
  BallUnion balls = test::sphere_balls(20000, 1, 1);
  BallUnion half;
  for (std::size_t i = 0; i < balls.centers.size(); ++i) {
    if (balls.centers[i].z > 0) continue;
    half.centers.push_back(balls.centers[i]);
    half.radii.push_back(balls.radii[i]);
  }
  const double radius = balls.radii[0];
  const SurfaceCaster caster(sphere, half);
  const auto rays = test::random_rays(20000, 1);
  const auto hits = cast(caster, rays);
  const auto held = [&](const Vec3& p, double slack) {
    for (const Vec3f& c : half.centers)
      if (norm(Vec3(c) - p) < radius * (1 + slack)) return true;
    return false;
  };
  int through = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SphereCrossings exact(rays[i], 1);
    if (std::abs(exact.closest - 1) < 2e-3 * radius) continue;
    if (exact.near < 0) {
      EXPECT_FALSE(hits[i].hit);
      continue;
    }
    const auto at = [&](double t) { return Vec3(rays[i].origin) + Vec3(rays[i].direction) * t; };
    const double z[] = {at(exact.near).z, at(exact.far).z};
    double expected = -1;
    bool rim = false;
    for (const int side : {1, 0}) {
      if (std::abs(z[side]) < 2 * radius) {  // cut exactly at the edges of the balls, up to rounding
        rim |= held(at(side ? exact.far : exact.near), 0.01) != held(at(side ? exact.far : exact.near), -0.01);
        if (held(at(side ? exact.far : exact.near), 0)) expected = side ? exact.far : exact.near;
      } else if (z[side] < 0) {
        expected = side ? exact.far : exact.near;
      }
    }
    if (rim) continue;
    ASSERT_EQ(hits[i].hit, expected > 0) << z[0] << " " << z[1];
    if (expected > 0) {
      EXPECT_NEAR(hits[i].distance, expected, 1e-4);
      through += expected == exact.far;
    }
  }
  EXPECT_GT(through, 1000) << "seen from inside, through the opening";
}

TEST(SurfaceCaster, NothingExistsOutsideOfTheDomain) {
  const Spheres sphere({1});
  const test::Within cap(sphere, [](const Vec3& p) { return p.z < 0.3; });
  const BallUnion balls = test::sphere_balls(5000, 1, 2);
  const SurfaceCaster caster(cap, balls);
  const auto rays = test::random_rays(10000, 1);
  const auto hits = cast(caster, rays);
  // The rim is found within a share of the balls' radius.
  const double rim = 0.1 * balls.radii[0];
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SphereCrossings exact(rays[i], 1);
    const double z_near = rays[i].origin.z + rays[i].direction.z * exact.near;
    const double z_far = rays[i].origin.z + rays[i].direction.z * exact.far;
    if (hits[i].hit) {
      EXPECT_LE(hits[i].position.z, 0.3 + 1e-6);
    }
    if (exact.near < 0 || std::abs(exact.closest - 1) < 0.01 || std::abs(z_near - 0.3) < rim ||
        std::abs(z_far - 0.3) < rim)
      continue;
    const double expected = z_near < 0.3 ? exact.near : z_far < 0.3 ? exact.far : -1;
    ASSERT_EQ(hits[i].hit, expected > 0) << z_near << " " << z_far;
    if (hits[i].hit) {
      EXPECT_NEAR(hits[i].distance, expected, 1e-4);
    }
  }
}

/// A step from −1 to 1 has a change of sign, but no zero.
class Cliff : public ScalarField {
 public:
  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = norm(x[i]) < 1 ? -0.5 : 0.5;
      if (!gradients.empty()) gradients[i] = {};
    }
  }
};

TEST(SurfaceCaster, JumpsAndNonsenseAreNoSurface) {
  const auto rays = test::random_rays(500, 1);
  const Cliff cliff;
  const SurfaceCaster caster(cliff, test::sphere_balls(2000));
  for (const CastHit& hit : cast(caster, rays)) EXPECT_FALSE(hit.hit);
  class Nonsense : public Cliff {
   public:
    void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
      for (std::size_t i = 0; i < x.size(); ++i) {
        values[i] = std::nan("");
        if (!gradients.empty()) gradients[i] = {values[i], 0, 1};
      }
    }
  };
  const Nonsense nonsense;
  const SurfaceCaster lost(nonsense, test::sphere_balls(2000));
  for (const CastHit& hit : cast(lost, rays)) EXPECT_FALSE(hit.hit);
}

TEST(SurfaceCaster, FollowsProjections) {
  const BallUnion balls = test::sphere_balls(20000, 1, 2);
  const double radius = balls.radii[0];
  const auto rays = test::random_rays(20000, 1.2f);
  for (const bool curvature : {true, false})
    for (const double rate : {1.0, 0.6}) {
      const test::SphereProjection projection(1, curvature, rate);
      const SurfaceCaster caster(projection, balls);
      const auto hits = cast(caster, rays);
      EXPECT_GT(count_hits(hits), rays.size() / 4);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const SphereCrossings exact(rays[i], 1);
        // Next to the silhouette the ray comes within the tolerance of the surface without touching it.
        if (std::abs(exact.closest - 1) < 2 * kTolerance * radius / rate) continue;
        ASSERT_EQ(hits[i].hit, exact.near > 0) << exact.closest << " " << curvature << rate << " " << i;
        if (!hits[i].hit) continue;
        EXPECT_NEAR(norm(hits[i].position), 1, 2 * kTolerance * radius / rate);
        const double slant = std::sqrt(1 - exact.closest * exact.closest);
        EXPECT_NEAR(hits[i].distance, exact.near, 3 * kTolerance * radius / slant / rate) << exact.closest;
        EXPECT_GT(dot(Vec3(hits[i].normal), normalized(hits[i].position)), 0.9999);
      }
      const CastCounts counts = caster.counts();
      const double a_hit = static_cast<double>(counts.hit_evaluations) / static_cast<double>(counts.hits);
      if (rate == 1) {
        EXPECT_LT(a_hit, curvature ? 4 : 5);
      }
    }
}

TEST(SurfaceCaster, ProjectionsWithoutStationaryPointsHaveNoSurface) {
  /// Moves all points by the same vector, on either side.
  class Drift : public test::SphereProjection {
   public:
    Drift() : SphereProjection(1) {}
    void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override {
      SphereProjection::project(x, feet);
      for (std::size_t i = 0; i < x.size(); ++i) feet[i].position += cross(feet[i].normal, Vec3{0, 0.01, 0.02});
    }
  };
  const Drift drift;
  const SurfaceCaster caster(drift, test::sphere_balls(20000, 1, 2));
  int hits = 0;
  for (const CastHit& hit : cast(caster, test::random_rays(3000, 1))) hits += hit.hit;
  EXPECT_LT(hits, 10);
}

TEST(SurfaceCaster, FeetLieOnTheSurface) {
  const Spheres sphere({1});
  BallUnion balls = test::sphere_balls(3000, 1, 2);
  for (std::size_t i = 0; i < balls.centers.size(); ++i)
    balls.centers[i] *= 1 + 0.02f * (static_cast<float>(i % 3) - 1);
  balls.centers.push_back({0, 0, 0.3f});  // too far away
  balls.radii.push_back(0.05f);
  const test::SphereProjection projection(1);
  const SurfaceCaster by_field(sphere, balls), by_projection(projection, balls);
  for (const SurfaceCaster* caster : {&by_field, &by_projection}) {
    std::vector<Vec3f> positions(balls.centers.size()), normals(balls.centers.size());
    caster->surface_points(positions, normals);
    for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
      EXPECT_NEAR(norm(positions[i]), 1, 1e-5);
      EXPECT_GT(dot(normals[i], positions[i]), 0.9999f);
    }
    EXPECT_EQ(normals.back(), Vec3f{});
  }
}

TEST(SurfaceCaster, DoesNotDependOnThreadsOrNeighbours) {
  const test::Torus torus;
  const BallUnion balls = test::torus_balls(20000, 2);
  const auto rays = test::random_rays(5000, 1.3f);
  std::vector<CastHit> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadScope scope(threads);
    const SurfaceCaster caster(torus, balls);
    const auto hits = cast(caster, rays);
    if (first.empty()) first = hits;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i].hit, first[i].hit);
      ASSERT_EQ(hits[i].position, first[i].position);
      ASSERT_EQ(hits[i].normal, first[i].normal);
    }
    for (std::size_t i = 0; i < rays.size(); i += 97) {
      CastHit alone;
      caster.cast(std::span(&rays[i], 1), std::span(&alone, 1));
      ASSERT_EQ(alone.position, first[i].position);
    }
  }
}

TEST(SurfaceCaster, RefusesBadInput) {
  const Spheres sphere({1});
  const BallUnion balls = test::sphere_balls(100);
  const auto refused = [&](const std::string& name, const SurfaceCastOptions& options) {
    try {
      const SurfaceCaster caster(sphere, balls, options);
      ADD_FAILURE() << name << " accepted";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused("tolerance", {.tolerance = 0});
  refused("tolerance", {.tolerance = std::nan("")});
  refused("smallest_step", {.smallest_step = 0});
  refused("largest_step", {.smallest_step = 0.5, .largest_step = 0.2});
  EXPECT_THROW(SurfaceCaster(sphere, BallUnion{}), DataError);
  BallUnion broken = balls;
  broken.radii.pop_back();
  EXPECT_THROW(SurfaceCaster(sphere, broken), ArgumentError);
  broken.centers.assign(99, Vec3f{std::nanf(""), 0, 0});
  EXPECT_THROW(SurfaceCaster(sphere, broken), DataError);
  broken = balls;
  broken.centers[3].y = INFINITY, broken.radii[7] = -1, broken.radii[9] = std::nanf("");
  EXPECT_EQ(SurfaceCaster(sphere, broken).balls().centers.size(), 97u);
  std::vector<CastRay> rays(3);
  std::vector<CastHit> hits(2);
  EXPECT_THROW(SurfaceCaster(sphere, balls).cast(rays, hits), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
