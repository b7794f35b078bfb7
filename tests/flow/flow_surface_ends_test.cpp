// Where surfaces end, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "flow/flow_surfaces.h"
#include "sansmesh/error.h"
#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/flow_options.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

TEST(FlowSurface, EndsWithTheFieldAndWhereItStandsStill) {
  // Out through x = 4 and x = -4.
  FlowSurfaceOptions options;
  options.seeds = 30;
  const FlowSurface out = surface_of("saddle", seed_line({1, 2, 0}, {2, 2, 1}), options);
  expect_sound(out);
  EXPECT_GE(out.report.ends[static_cast<std::size_t>(TraceEnd::boundary)], 30u);
  double farthest = 0;
  for (const FlowPoint& p : out.points) farthest = std::max(farthest, p.position.x);
  EXPECT_LE(farthest, 4);
  EXPECT_NEAR(farthest, 4, 1e-4);
  EXPECT_TRUE(out.report.complete);
  // The whole area between the hyperbolas x y = 2 and 4, up to y = 2.
  const FlowSurface flat = surface_of("saddle", seed_line({1, 2, 0}, {2, 2, 0}), options);
  expect_sound(flat);
  EXPECT_NEAR(area(flat), 2, 2e-3);
  // Into the critical points on the z axis, backward, without end in time.
  options.direction = FlowDirection::backward;
  const FlowSurface rest = surface_of("saddle", seed_line({1, 0, 0}, {1, 0, 1}), options);
  expect_sound(rest);
  EXPECT_LT(rest.report.fronts, 200u);
  // Half of the curve inside the sphere.
  const FlowSurface half = surface_of("past-sphere", seed_line({0, 0, 0.2}, {0, 0, 2.2}), surface_for(2, 30));
  expect_sound(half);
  EXPECT_GT(half.report.ends[static_cast<std::size_t>(TraceEnd::outside)], 8u);
  for (const FlowPoint& p : half.points) EXPECT_GT(p.s, 0.75);
}

TEST(FlowSurface, EndsAfterFiveDiagonalsWhereNothingElseEndsIt) {
  // Endless rotation: the particle in the middle has unit speed.
  const SeedCurve curve = seed_line({0.9, 0, 0}, {1.1, 0, 0});
  const double five = 5 * analytic_flow("rotation")->bounds().diagonal();
  FlowSurfaceOptions options;
  options.seeds = 3;
  for (const FlowSurfaceKind kind : {FlowSurfaceKind::stream, FlowSurfaceKind::path}) {
    options.kind = kind;
    const FlowSurface whole = surface_of("rotation", curve, options);
    EXPECT_TRUE(whole.report.complete);
    double last = 0;
    for (const FlowPoint& p : whole.points) last = std::max(last, p.t);
    EXPECT_GE(last, five * (1 - 1e-3));
    EXPECT_LE(last, five + 0.2);
  }
  // Ends exactly at the requested length.
  options.length = 2, options.duration = 100;
  double last = 0;
  for (const FlowPoint& p : surface_of("rotation", curve, options).points) last = std::max(last, p.t);
  EXPECT_NEAR(last, 2, 0.2);
  options.length = {}, options.duration = five + 10;
  for (const FlowPoint& p : surface_of("rotation", curve, options).points) last = std::max(last, p.t);
  EXPECT_EQ(last, five + 10);
}

TEST(FlowSurface, IsTheSameForAnyNumberOfThreads) {
  for (const auto kind : {FlowSurfaceKind::path, FlowSurfaceKind::streak}) {
    FlowSurfaceOptions options = surface_for(0.8, 40);
    options.kind = kind;
    test::expect_equal_for_any_threads([&] {
      const FlowSurface s = surface_of("tornado", seed_line({0.2, 0.5, 0.05}, {0.8, 0.45, 0.1}), options);
      std::vector<std::tuple<double, double, double, double, double>> all;
      for (const FlowPoint& p : s.points) all.emplace_back(p.position.x, p.position.y, p.position.z, p.normal.x, p.s);
      return std::pair{all, s.mesh.triangles};
    });
  }
}

TEST(FlowSurface, StopsAtItsLimits) {
  FlowSurfaceOptions options;
  options.seeds = 20, options.most_fronts = 5;
  const FlowSurface five = surface_of("rotation", seed_line({0.5, 0, 0}, {1.5, 0, 0}), options);
  EXPECT_EQ(five.report.fronts, 6u);
  EXPECT_FALSE(five.report.complete);
  options.most_fronts = 100'000, options.most_points = 1000;
  const FlowSurface thousand = surface_of("rotation", seed_line({0.5, 0, 0}, {1.5, 0, 0}), options);
  EXPECT_NEAR(static_cast<double>(thousand.points.size()), 1000, 20);
  EXPECT_FALSE(thousand.report.complete);
  options = surface_for(2.5, 20);
  options.kind = FlowSurfaceKind::streak, options.most_points = 2500;
  const FlowSurface streak = surface_of("abc", seed_line({0.5, 1, 0.2}, {1.5, 1.2, 0.8}), options);
  expect_sound(streak, true);
  EXPECT_LE(streak.report.particles, 2500u);
}

/// A slow rotation with a core thousands of times as fast as fronts can follow.
class CoreFlow final : public VectorField {
 public:
  Box3 bounds() const override { return {{-2, -2, -1}, {2, 2, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<const double>, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian>) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double turn = norm(x[i]) < 0.11 ? 1e5 : 0.5;
      vectors[i] = {-turn * x[i].y, turn * x[i].x, 0}, inside[i] = 1;
    }
  }
};

TEST(FlowSurface, EndsWhereParticlesAreFasterThanFrontsCanFollow) {
  FlowSurfaceOptions options = surface_for(1e9, 400);
  options.start = 0.1;  // moments are rounded
  options.most_fronts = 40;
  Progress progress;
  const FlowSurface surface = flow_surface(CoreFlow(), seed_line({0.05, 0, 0}, {1.5, 0, 0}), options, progress);
  EXPECT_FALSE(surface.report.complete);
  EXPECT_GT(surface.report.fronts, 30u);
}

/// Along x: slow at first, then accelerating.
class FasterFlow final : public VectorField {
 public:
  Box3 bounds() const override { return {{0, 0, 0}, {100, 1, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<const double>, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian>) const override {
    for (std::size_t i = 0; i < x.size(); ++i) vectors[i] = {std::exp(std::max(x[i].x, 0.0)), 0, 0}, inside[i] = 1;
  }
};

TEST(FlowSurface, SaysWhereMomentsAreTheSameNumber) {
  FlowSurfaceOptions options;
  options.seeds = 3, options.length = 90, options.start = 0.0;
  const SeedCurve seeds = seed_line({0, 0, 0.5}, {0, 1, 0.5});
  const auto surface = [&] {
    Progress progress;
    return flow_surface(FasterFlow(), seeds, options, progress);
  };
  // At x fronts are e^-x / 2 apart, and moments 2^-33.
  options.start = 1 << 20;
  const FlowSurface ended = surface();
  EXPECT_FALSE(ended.report.complete);
  EXPECT_TRUE(ended.report.moments_meet);
  EXPECT_GT(ended.report.fronts, 30u);
  for (const FlowPoint& p : ended.points) EXPECT_LT(p.position.x, 33 * std::log(2.0) + 3);
  // No later moment is representable from here on.
  options.start = 1e15, options.front_step = 1e-3;
  EXPECT_THROW(surface(), ArgumentError);
  options.duration = 1e-3;
  EXPECT_THROW(surface(), ArgumentError);
  options.length.reset();
  for (const FlowSurfaceKind kind : {FlowSurfaceKind::path, FlowSurfaceKind::streak, FlowSurfaceKind::time}) {
    options.kind = kind, options.sweep = {0.1, 0, 0};
    EXPECT_THROW(surface(), ArgumentError);
  }
  options.kind = FlowSurfaceKind::streak, options.duration = 0.5;
  EXPECT_THROW(surface(), ArgumentError);
  // Numbers are 1/8 apart: some rows would be released at the same moment, if not the first two.
  options.duration = 100, options.front_step = 0.13;
  EXPECT_THROW(surface(), ArgumentError);
  // The message also names values that are too small.
  options.start = 1, options.duration = 1e-17;
  try {
    surface();
    ADD_FAILURE();
  } catch (const ArgumentError& error) {
    EXPECT_STREQ(error.what(), "`duration` (1e-17) is too short for the magnitude of `start` (1)");
  }
}

TEST(FlowSurface, EndsWhereAFlowMixesWithoutAnEnd) {
  FlowSurfaceOptions options = surface_for(1e9, 60);
  options.most_points = 3000;
  const FlowSurface surface = surface_of("abc", seed_line({0.5, 1, 0.2}, {1.5, 1.2, 0.8}), options);
  EXPECT_FALSE(surface.report.complete);
  EXPECT_LT(surface.points.size(), 4000u);
}

TEST(FlowSurface, RefusesBadOptionsAndSeeds) {
  const SeedCurve curve = seed_line({0.5, 0, 0}, {1.5, 0, 0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& spoil : std::vector<void (*)(FlowSurfaceOptions&)>{
           [](FlowSurfaceOptions& o) { o.seeds = 1; }, [](FlowSurfaceOptions& o) { o.alpha = 1; },
           [](FlowSurfaceOptions& o) { o.beta = 0; }, [](FlowSurfaceOptions& o) { o.delta = 1; },
           [](FlowSurfaceOptions& o) { o.delta = 0.8, o.alpha = 1.5; }, [](FlowSurfaceOptions& o) { o.duration = 0; },
           [](FlowSurfaceOptions& o) { o.length = 0; },
           [](FlowSurfaceOptions& o) { o.kind = FlowSurfaceKind::streak, o.duration = 1, o.length = 1; },
           [](FlowSurfaceOptions& o) { o.front_step = 0; }, [](FlowSurfaceOptions& o) { o.most_fronts = 0; },
           [](FlowSurfaceOptions& o) { o.most_points = 0; }, [](FlowSurfaceOptions& o) { o.trace.tolerance = -1; },
           [](FlowSurfaceOptions& o) { o.kind = FlowSurfaceKind::time; },
           [](FlowSurfaceOptions& o) { o.kind = FlowSurfaceKind::streak, o.duration = INFINITY; },
           [](FlowSurfaceOptions& o) { o.kind = FlowSurfaceKind::streak, o.direction = FlowDirection::both; }}) {
    FlowSurfaceOptions options = surface_for(1, 10);
    spoil(options);
    EXPECT_THROW(surface_of("rotation", curve, options), ArgumentError);
  }
  FlowSurfaceOptions options = surface_for(1, 10);
  options.start = nan;
  EXPECT_THROW(surface_of("rotation", curve, options), ArgumentError);
  EXPECT_THROW(surface_of("rotation", seed_line({5, 0, 0}, {6, 0, 0}), surface_for(1, 10)), DataError);
  EXPECT_THROW(surface_of("rotation", seed_line({0, 0, -1}, {0, 0, 1}), surface_for(1, 10)), DataError);
  EXPECT_THROW(surface_of("rotation", seed_line({1, 0, 0}, {1, 0, 0}), surface_for(1, 10)), ArgumentError);
  EXPECT_THROW(surface_of("rotation", SeedCurve{{{1, 0, 0}, {1, 1, 0}, {0, 0, 0}}, true}, surface_for(1, 2)),
               ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
