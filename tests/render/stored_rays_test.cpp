#include "sansmesh/render/surface/stored_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytic_surfaces.h"
#include "sansmesh/error.h"
#include "sansmesh/render/surface/surface_caster.h"

namespace sansmesh::inline v1 {
namespace {

/// Rays from stored polynomials find the same as marching rays, with fewer projections; also for spheres with a
/// projection that moves only part of the way.
TEST(SurfaceCaster, StoredPolynomialsLeadToTheSurface) {
  constexpr double tolerance = 1e-3;
  for (const double rate : {1.0, 0.7}) {
    const test::SphereProjection projection(1, true, rate);
    const BallUnion balls = test::sphere_balls(20000);
    SurfaceCastOptions options;
    const SurfaceCaster marching(projection, balls, options);
    options.stored = true;
    const SurfaceCaster stored(projection, balls, options);
    const auto rays = test::random_rays(20000, 1.2f);
    const auto hits = test::cast(stored, rays);
    test::cast(marching, rays);
    std::size_t seen = 0, found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const test::SphereCrossings exact(rays[i], 1);
      if (!(exact.near > 0)) EXPECT_FALSE(hits[i].hit && exact.closest > 1 + 2 * tolerance * balls.radii[0]);
      if (std::abs(exact.closest - 1) < 0.05 * balls.radii[0] || !(exact.near > 0)) continue;
      ++seen, found += hits[i].hit;
      if (!hits[i].hit) continue;
      EXPECT_NEAR(norm(hits[i].position), 1, 2 * tolerance * balls.radii[0]);
      EXPECT_NEAR(hits[i].distance, exact.near, 0.1 * balls.radii[0]);
      EXPECT_GT(dot(Vec3(hits[i].normal), normalized(hits[i].position)), 0.9999);
    }
    EXPECT_GT(seen, rays.size() / 4);
    EXPECT_EQ(found, seen);
    const CastCounts a = stored.counts(), b = marching.counts();
    EXPECT_EQ(a.rays, rays.size());
    EXPECT_LT(a.hit_evaluations + a.miss_evaluations, b.hit_evaluations + b.miss_evaluations);
  }
  SurfaceCastOptions options;
  options.stored = true;
  EXPECT_THROW(SurfaceCaster(test::Spheres({1}), test::sphere_balls(100), options), ArgumentError);
}

/// The first intersection with any polynomial inside its ball, by testing all.
TEST(StoredPolynomials, TheFirstMeetingIsThatOfAllBalls) {
  const test::SphereProjection projection(1);
  const BallUnion balls = test::sphere_balls(300, 1, 1.3);
  const detail::StoredPolynomials stored(projection, balls);
  const auto rays = test::random_rays(2000, 1.2f);
  std::vector<detail::StoredHit> hits(rays.size());
  stored.first(rays, hits);
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3 o(rays[i].origin), d(rays[i].direction);
    double first = 1e9;
    for (std::size_t b = 0; b < balls.centers.size(); ++b) {
      // z = −½ (u² + v²) over the tangent plane: heights along the ray change their sign.
      const Vec3 c(balls.centers[b]), n = normalized(c);
      const auto height = [&](double t) {
        const Vec3 q = o + d * t - n;
        const double z = dot(q, n);
        return z + 0.5 * (squared_norm(q) - z * z);
      };
      const double middle = dot(c - o, d), aside2 = squared_norm(o + d * middle - c);
      const double r = balls.radii[b];
      if (aside2 >= r * r) continue;
      const double half = std::sqrt(r * r - aside2);
      constexpr int kSteps = 400;
      for (int k = 0; k < kSteps; ++k) {
        const double t0 = middle - half + 2 * half * k / kSteps, t1 = middle - half + 2 * half * (k + 1) / kSteps;
        const double h0 = height(t0), h1 = height(t1);
        if ((h0 < 0) == (h1 < 0)) continue;
        first = std::min(first, t0 + (t1 - t0) * h0 / (h0 - h1));
        break;
      }
    }
    if (hits[i].found) ++count;
    if (hits[i].found && first < 1e9) EXPECT_NEAR(hits[i].distance, first, 1e-4);
    if (!hits[i].found) EXPECT_EQ(first, 1e9);
  }
  EXPECT_GT(count, 500u);
}

}  // namespace
}  // namespace sansmesh::inline v1
