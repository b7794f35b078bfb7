#include "sansmesh/flow/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/flow/flow_integrator.h"
#include "sansmesh/flow_options.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;

Traces traced(const VectorField& field, const std::vector<Vec3>& seeds, const TraceOptions& options, double from = 0) {
  Progress progress;
  return trace_lines(field, seeds, std::vector<double>(seeds.size(), from), options, progress);
}

TraceOptions for_time(double duration, std::string_view integrator = "dopri5") {
  TraceOptions options;
  options.duration = duration, options.integrator = integrator;
  return options;
}

/// Error of a particle of the rotation after a quarter turn.
double error_of(std::string_view integrator, double step) {
  const auto flow = analytic_flow("rotation");
  TraceOptions options = for_time(kPi / 2, integrator);
  options.step = step, options.tolerance = 10;  // no shorter steps
  const Traces t = traced(*flow, {{1, 0, 0}}, options);
  EXPECT_EQ(t.ends[0], TraceEnd::time);
  EXPECT_EQ(t.times.back(), kPi / 2);
  return norm(t.positions.back() - Vec3{0, 1, 0});
}

/// Unknown integrators are an error that lists all names, before anything moves.
TEST(Trace, WhatIsNoIntegratorIsAnErrorThatListsThem) {
  const auto flow = analytic_flow("rotation");
  for (const char* const wrong : {"rk5", "", "Euler"}) {
    try {
      traced(*flow, {{1, 0, 0}}, for_time(1, wrong));
      ADD_FAILURE() << wrong;
    } catch (const ArgumentError& error) {
      EXPECT_EQ(error.fault().field, "integrator");
      EXPECT_EQ(error.what(), "`integrator` must be one of euler, rk4, dopri5, not '" + std::string(wrong) + "'");
    }
  }
}

/// Errors fall with the registered order, and default steps have the registered length.
TEST(Trace, IntegratorsAreWhatTheyAreRegisteredAs) {
  const auto flow = analytic_flow("rotation");
  const double diagonal = flow->bounds().diagonal();
  for (const FlowIntegrator* const one : FlowIntegrator::registry().all()) {
    SCOPED_TRACE(one->name);
    const double step = one->order == 1 ? 0.01 : one->order == 4 ? 0.1 : 0.2;
    EXPECT_NEAR(std::log2(error_of(one->name, step) / error_of(one->name, step / 2)), one->order, 0.3);
    const TraceOptions by_itself = for_time(kPi, one->name);
    TraceOptions told = by_itself;
    told.step = one->reach * diagonal;
    EXPECT_EQ(traced(*flow, {{1, 0, 0}}, by_itself).positions, traced(*flow, {{1, 0, 0}}, told).positions);
    told.step = 0.5 * one->reach * diagonal;
    EXPECT_NE(traced(*flow, {{1, 0, 0}}, by_itself).positions, traced(*flow, {{1, 0, 0}}, told).positions);
  }
}

TEST(Trace, ToleranceOfDormandAndPrinceIsKept) {
  const auto flow = analytic_flow("abc");
  TraceOptions tight = for_time(3);
  tight.tolerance = 1e-11;
  const Vec3 truth = traced(*flow, {{1, 2, 0.5}}, tight).positions.back();
  double before = 1;
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    TraceOptions options = for_time(3);
    options.tolerance = tolerance;
    const double error = norm(traced(*flow, {{1, 2, 0.5}}, options).positions.back() - truth);
    EXPECT_LT(error, 100 * tolerance);
    EXPECT_LT(error, before);
    before = error;
  }
}

TEST(Trace, PointsBetweenStepsLieOnTheLine) {
  const auto flow = analytic_flow("rotation");
  for (const std::string_view integrator : {"rk4", "dopri5"}) {
    TraceOptions options = for_time(2 * kPi, integrator);
    options.step = 0.1;
    const Traces t = traced(*flow, {{1, 0, 0}}, options);
    EXPECT_GT(t.positions.size(), 60u);
    for (std::size_t i = 0; i < t.positions.size(); ++i) {
      EXPECT_NEAR(norm(t.positions[i] - Vec3{std::cos(t.times[i]), std::sin(t.times[i]), 0}), 0, 5e-5);
      EXPECT_NEAR(norm(t.velocities[i]), 1, 0.01);
    }
    EXPECT_NEAR(norm(t.positions.back() - Vec3{1, 0, 0}), 0, 5e-5);  // a full turn
  }
}

TEST(Trace, BackwardReturns) {
  const auto flow = analytic_flow("double-gyre");
  TraceOptions options = for_time(8);
  options.tolerance = 1e-9;
  const Traces there = traced(*flow, {{0.4, 0.3, 0.5}, {1.7, 0.6, 0.5}}, options, 1);
  options.backward = true;
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3 end = there.positions[there.offsets[i + 1] - 1];
    const Traces back = traced(*flow, {end}, options, 9);
    EXPECT_EQ(back.times.back(), 1);
    EXPECT_LT(norm(back.positions.back() - there.positions[there.offsets[i]]), 1e-6);
  }
}

TEST(Trace, EndsAtTheBoundaryAndNotBeyond) {
  const auto flow = analytic_flow("saddle");
  for (const std::string_view integrator : {"euler", "rk4", "dopri5"}) {
    const Traces t = traced(*flow, {{0.01, 3, 1}}, for_time(100, integrator));
    EXPECT_EQ(t.ends[0], TraceEnd::boundary);
    EXPECT_LE(t.positions.back().x, 4);
    EXPECT_NEAR(t.positions.back().x, 4, 1e-5);
    // x grows as e^t.
    EXPECT_NEAR(t.times.back(), std::log(400), integrator == "euler" ? 0.1 : 1e-3);
  }
}

TEST(Trace, EndsAtCriticalPointsAfterALengthAndOfSteps) {
  const auto flow = analytic_flow("saddle");
  TraceOptions options;
  options.least_speed = 0.01;
  const Traces still = traced(*flow, {{0, 3, 0}, {0, 0, 0}}, options);
  EXPECT_EQ(still.ends[0], TraceEnd::critical_point);
  EXPECT_LT(norm(still.positions[still.offsets[1] - 1]), 0.011);
  EXPECT_EQ(still.ends[1], TraceEnd::critical_point);
  EXPECT_EQ(still.offsets[2] - still.offsets[1], 1u);

  const auto around = analytic_flow("rotation");
  TraceOptions by_length;
  by_length.length = 1.5;
  const Traces t = traced(*around, {{1, 0, 0}}, by_length);
  EXPECT_EQ(t.ends[0], TraceEnd::length);
  EXPECT_NEAR(t.times.back(), 1.5, 1e-3);
  TraceOptions few;
  few.most_steps = 5;
  EXPECT_EQ(traced(*around, {{1, 0, 0}}, few).ends[0], TraceEnd::steps);
}

/// A sink at the origin, around which particles spiral.
class Spiral final : public VectorField {
 public:
  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<const double>, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      inside[i] = bounds().contains(x[i]);
      // Stiff decay in one direction: steps are limited by stability, and particles do not approach closer than the
      // tolerance.
      vectors[i] = inside[i] != 0 ? Vec3{-x[i].x - x[i].y, x[i].x - x[i].y, -30 * x[i].z} : Vec3{};
      if (!jacobian.empty()) jacobian[i] = {};
    }
  }
};

TEST(Trace, ParticlesThatCannotGetNearerHaveArrived) {
  const Spiral field;
  TraceOptions options;
  options.tolerance = 1e-3, options.least_speed = 1e-9, options.duration = 1e6;
  const Traces t = traced(field, {{0.5, 0.2, 0.3}, {-0.7, 0.1, -0.4}}, options);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_EQ(t.ends[i], TraceEnd::critical_point);
    EXPECT_LT(norm(t.positions[t.offsets[i + 1] - 1]), 0.032);
    EXPECT_LT(t.offsets[i + 1] - t.offsets[i], 300u);
  }
  // Without a least speed the position at the end of the duration is required.
  options.least_speed = 0, options.duration = 100;
  EXPECT_EQ(traced(field, {{0.5, 0.2, 0.3}}, options).ends[0], TraceEnd::time);
}

TEST(Trace, BoundariesAreFoundInFewSteps) {
  const auto flow = analytic_flow("saddle");
  std::vector<Vec3> seeds;
  for (int i = 0; i < 50; ++i) seeds.push_back({0.5 + 0.03 * i, 1, 0});
  TraceOptions options;
  options.most_steps = 40;
  const Traces t = traced(*flow, seeds, options);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_EQ(t.ends[i], TraceEnd::boundary);
    EXPECT_NEAR(t.positions[t.offsets[i + 1] - 1].x, 4, 2e-6);
  }
}

/// Ten moments; fast eddies above, almost no motion below.
class FastAndSlow final : public VectorField {
 public:
  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  TimeRange times() const override { return {0, 10}; }
  std::span<const double> sample_times() const override { return moments_; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> /*jacobian*/) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      inside[i] = bounds().contains(x[i]) && times().contains(t[i]);
      vectors[i] = inside[i] == 0 ? Vec3{} : x[i].y > 0 ? Vec3{20 * (0.5 - x[i].y), 20 * x[i].x, 0} : Vec3{0.01, 0, 0};
    }
  }

 private:
  std::vector<double> moments_{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
};

TEST(Trace, TriesAreCountedForEachParticle) {
  // A particle that needs many steps does not end the others.
  const FastAndSlow field;
  TraceOptions options;
  options.most_steps = 100;
  const Traces t = traced(field, {{0, -0.5, 0}, {0.3, 0.5, 0}}, options);
  EXPECT_EQ(t.ends[0], TraceEnd::time);
  EXPECT_EQ(t.ends[1], TraceEnd::steps);
  EXPECT_NEAR(t.positions[t.offsets[1] - 1].x, 0.1, 1e-9);
}

TEST(Trace, LinesAreAsFineAsTheyTurn) {
  const auto turning = analytic_flow("rotation"), straight = analytic_flow("saddle");
  const Traces circle = traced(*turning, {{0.5, 0, 0}}, for_time(2 * kPi));
  const std::size_t round = circle.positions.size();
  EXPECT_GE(round, 31u);
  EXPECT_LE(round, 80u);
  for (std::size_t i = 0; i + 1 < round; ++i)
    EXPECT_LT(norm(circle.positions[i + 1] - circle.positions[i]), 0.5 * 0.2 * 1.05);
  TraceOptions options;
  options.step = 0.4;
  const Traces line = traced(*straight, {{0.5, 0, 0}}, options);
  for (std::size_t i = 0; i + 12 < line.positions.size(); ++i)
    EXPECT_GT(norm(line.positions[i + 1] - line.positions[i]), 0.02) << i;
}

TEST(Trace, SeedsOutsideHaveNoLine) {
  const auto flow = analytic_flow("past-sphere");
  const Traces t = traced(*flow, {{0, 0, 0}, {-3, 0.2, 0}, {9, 0, 0}}, for_time(20));
  EXPECT_EQ(t.ends[0], TraceEnd::outside);
  EXPECT_EQ(t.ends[1], TraceEnd::boundary);
  EXPECT_EQ(t.ends[2], TraceEnd::outside);
  EXPECT_EQ(t.offsets[1], 0u);
  EXPECT_EQ(t.offsets[3], t.offsets[2]);
  for (const Vec3& x : t.positions) EXPECT_GE(norm(x), 1 - 1e-9);  // around the sphere
}

TEST(Trace, ParticlesMoveTogetherToOneMoment) {
  const auto flow = analytic_flow("rotation");
  const std::vector<Vec3> seeds{{0.5, 0, 0}, {1, 0, 0}, {1.5, 0, 0}};
  Particles p = particles_at(*flow, seeds, std::vector<double>(3, 0.0));
  const std::vector<std::uint32_t> all{0, 1, 2};
  for (const double t : {0.3, 0.9, 2.5}) {
    move_particles(*flow, p, all, t, {});
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(p.times[i], t);
      EXPECT_FALSE(p.ends[i]);
      EXPECT_LT(norm(p.positions[i] - Vec3{std::cos(t), std::sin(t), 0} * seeds[i].x), 1e-4);
    }
  }
}

TEST(Trace, ALineDoesNotDependOnTheOthersNorOnThreads) {
  const auto flow = analytic_flow("tornado");
  std::vector<Vec3> seeds;
  for (int i = 0; i < 40; ++i) seeds.push_back({0.3 + 0.01 * i, 0.5, 0.02});
  test::expect_equal_for_any_threads([&] { return traced(*flow, seeds, for_time(3)).positions; });
  const Traces all = traced(*flow, seeds, for_time(3)), one = traced(*flow, {seeds[17]}, for_time(3));
  EXPECT_EQ(one.positions, std::vector<Vec3>(all.positions.begin() + static_cast<std::ptrdiff_t>(all.offsets[17]),
                                             all.positions.begin() + static_cast<std::ptrdiff_t>(all.offsets[18])));
}

TEST(Trace, RefusesBadOptions) {
  const auto flow = analytic_flow("rotation");
  for (const auto& spoil : std::vector<void (*)(TraceOptions&)>{
           [](TraceOptions& o) { o.duration = 0; }, [](TraceOptions& o) { o.length = -1; },
           [](TraceOptions& o) { o.step = 0; }, [](TraceOptions& o) { o.tolerance = -1; },
           [](TraceOptions& o) { o.most_steps = 0; },
           [](TraceOptions& o) { o.least_speed = std::numeric_limits<double>::quiet_NaN(); }}) {
    TraceOptions options;
    spoil(options);
    EXPECT_THROW(traced(*flow, {{1, 0, 0}}, options), ArgumentError);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
