// Flows in time: values between and at steps, and the number of reads.
#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/flow/trace.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/flow/flow_lines.h"
#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kStepBytes = 1000;

/// v(x) of a step in the cube [-2, 2]³; counts existing instances.
class StepField final : public VolumeField {
 public:
  StepField(std::function<Vec3(const Vec3&)> v, std::shared_ptr<int> alive)
      : v_(std::move(v)), alive_(std::move(alive)) {
    ++*alive_;
  }
  ~StepField() override { --*alive_; }
  StepField(const StepField&) = delete;
  StepField& operator=(const StepField&) = delete;

  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  std::size_t components() const override { return 3; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 v = v_(x[i]);
      for (std::size_t c = 0; c < 3 && !wanted.values.empty(); ++c) wanted.values[3 * i + c] = v[c];
      for (std::size_t c = 0; c < 3 && !wanted.gradients.empty(); ++c)
        wanted.gradients[3 * i + c] = Vec3{1, 2, 3} * v[c];
      if (!wanted.inside.empty()) wanted.inside[i] = std::abs(x[i].x) <= 2 && std::abs(x[i].y) <= 2;
    }
  }
  void spacing(std::span<const Vec3>, std::span<double> found) const override {
    std::fill(found.begin(), found.end(), 0.1);
  }

 private:
  std::function<Vec3(const Vec3&)> v_;
  std::shared_ptr<int> alive_;
};

/// n steps at 0, 1, …, n − 1, of v(x, t).
struct Series {
  Series(std::size_t n, std::function<Vec3(const Vec3&, double)> v) : v(std::move(v)) {
    for (std::size_t i = 0; i < n; ++i) times.push_back(static_cast<double>(i));
  }
  std::unique_ptr<VectorField> flow(TimeInterpolation interpolation, std::uint64_t memory) {
    const auto load = [this](std::size_t i) {
      const std::lock_guard lock(mutex);
      if (i == broken) throw DataError("broken");
      loads.push_back(i);
      most = std::max(most, *alive + 1);
      return FlowStep{std::make_shared<StepField>([this, t = times[i]](const Vec3& x) { return v(x, t); }, alive),
                      kStepBytes};
    };
    return flow_in_time(times, load, {interpolation, memory});
  }

  std::function<Vec3(const Vec3&, double)> v;
  std::vector<double> times;
  std::vector<std::size_t> loads;
  std::shared_ptr<int> alive = std::make_shared<int>(0);
  int most = 0;  ///< largest number of simultaneous instances
  std::size_t broken = ~std::size_t{0};
  std::mutex mutex;
};

Vec3 swaying(const Vec3& x, double t) { return Vec3{-x.y, x.x, 0} * (0.1 + 0.01 * t); }

Vec3 at(const VectorField& flow, double t) {
  const Vec3 x{0.5, 0.25, 0};
  Vec3 v;
  std::uint8_t inside = 0;
  flow.evaluate({&x, 1}, {&t, 1}, {&v, 1}, {&inside, 1});
  EXPECT_EQ(inside, 1) << t;
  return v;
}

TEST(FlowInTime, InterpolatesBetweenStepsAndIsExactAtThem) {
  const auto square = [](const Vec3&, double t) { return Vec3{t * t, t, 1}; };
  Series series(6, square);
  const auto constant = series.flow(TimeInterpolation::constant, 0), linear = series.flow(TimeInterpolation::linear, 0),
             cubic = series.flow(TimeInterpolation::cubic, 0);
  for (double t = 0; t <= 5; t += 0.125) {
    const double before = std::floor(t), u = t - before;
    EXPECT_EQ(at(*constant, t), square({}, before));
    EXPECT_NEAR(at(*linear, t).x, before * before + u * (2 * before + 1), 1e-12);
    // The slopes at the first and last step come from one interval only.
    if (t >= 1 && t <= 4) EXPECT_NEAR(at(*cubic, t).x, t * t, 1e-12);
    for (const auto* flow : {&linear, &cubic}) EXPECT_NEAR(at(**flow, t).y, t, 1e-12);
    if (u == 0)
      for (const auto* flow : {&constant, &linear, &cubic}) EXPECT_EQ(at(**flow, t), square({}, t));
  }
}

/// Batches within one interval use another code path than mixed ones.
TEST(FlowInTime, AnswersDependOnPointAndTimeAlone) {
  for (const auto interpolation : {TimeInterpolation::constant, TimeInterpolation::linear, TimeInterpolation::cubic}) {
    Series series(6, swaying);
    const auto flow = series.flow(interpolation, 10 * kStepBytes);
    const std::vector<double> t{3.25, 0.5, 3.25, -1, 5, 2, std::nan(""), 3.75, 0, 7, 4.5, 1.5};
    std::vector<Vec3> x, vectors(t.size());
    for (std::size_t i = 0; i < t.size(); ++i) x.push_back({0.2 * static_cast<double>(i), 1, 0});  // the last beyond 2
    std::vector<std::uint8_t> inside(t.size(), 7);
    std::vector<Jacobian> jacobian(t.size());
    flow->evaluate(x, t, vectors, inside, jacobian);
    EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 1, 0, 1, 1, 0, 1, 1, 0, 1, 0}));
    for (std::size_t i = 0; i < t.size(); ++i) {
      Vec3 v{1, 1, 1};
      std::uint8_t in = 7;
      Jacobian j{Vec3{1, 1, 1}};
      flow->evaluate({&x[i], 1}, {&t[i], 1}, {&v, 1}, {&in, 1}, {&j, 1});
      EXPECT_EQ(v, vectors[i]) << i;
      EXPECT_EQ(in, inside[i]) << i;
      EXPECT_EQ(j, jacobian[i]) << i;
      if (in != 0) EXPECT_NE(norm(j[2]), 0) << i;
    }
  }
}

/// Moving grids: between two steps both must contain the point.
TEST(FlowInTime, OnlyOneStepIsUsedAtItsTime) {
  Series series(4, swaying);
  series.broken = 2;
  const auto flow = series.flow(TimeInterpolation::linear, 0);
  EXPECT_EQ(at(*flow, 1), swaying({0.5, 0.25, 0}, 1));
  EXPECT_NO_THROW(at(*flow, 0.5));
  EXPECT_THROW(at(*flow, 1.5), DataError);
  EXPECT_THROW(at(*flow, 2), DataError);
  EXPECT_NO_THROW(at(*flow, 3));  // a failure to read ahead is ignored
  EXPECT_NO_THROW(at(*flow, 0.5));
}

TEST(FlowInTime, ErrorsNameWrongTimes) {
  const auto load = [](std::size_t) -> FlowStep { throw DataError("nothing is to be read"); };
  const auto why = [&](const std::vector<double>& times) {
    try {
      flow_in_time(times, load);
    } catch (const ArgumentError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(why({1}).find("two steps"), std::string::npos);
  EXPECT_NE(why({0, 2, 1}).find("step 2 is of 1"), std::string::npos);
  EXPECT_NE(why({0, 1, 1}).find("must increase"), std::string::npos);
  EXPECT_NE(why({0, std::nan(""), 1}).find("time of step 1"), std::string::npos);
}

/// Particles that reach a step in different tries do not cause repeated reads of neighbouring steps.
TEST(FlowInTime, OnePassReadsEachStepOnce) {
  for (const auto interpolation : {TimeInterpolation::constant, TimeInterpolation::linear, TimeInterpolation::cubic}) {
    Series series(30, swaying);
    const auto flow = series.flow(interpolation, 0);
    std::vector<Vec3> seeds;
    for (int i = 0; i < 300; ++i) seeds.push_back({0.005 * i, 0.1, 0});
    TraceOptions options;
    Progress progress;
    trace_lines(*flow, seeds, std::vector<double>(seeds.size(), 0.0), options, progress);
    EXPECT_EQ(series.loads.size(), 30u);
    // The current steps, the one ahead, and one that is added before another is removed.
    EXPECT_LE(series.most, (interpolation == TimeInterpolation::cubic ? 4 : 2) + 2);
  }
}

TEST(FlowInTime, KeepsAsManyStepsAsTheMemoryHolds) {
  const auto pass = [](const VectorField& flow, std::size_t n) {
    for (std::size_t i = 0; i + 1 < n; ++i) at(flow, static_cast<double>(i) + 0.5);
  };
  for (const std::size_t room : {0, 10, 15, 21, 40}) {
    Series series(20, swaying);
    {
      const auto flow = series.flow(TimeInterpolation::linear, room * kStepBytes);
      for (int k = 0; k < 3; ++k) pass(*flow, 20);
      if (room > 20) {
        EXPECT_EQ(series.loads.size(), 20u);
      } else {
        // Later passes begin with the steps kept; the slot for the one ahead may be empty temporarily.
        EXPECT_GE(series.loads.size(), 20 + 2 * (20 - std::max<std::size_t>(room, 3))) << room;
        EXPECT_LE(series.loads.size(), 20 + 2 * std::min<std::size_t>(20, 24 - std::max<std::size_t>(room, 4))) << room;
      }
      EXPECT_LE(series.most, static_cast<int>(std::max<std::size_t>(room, 4)) + 1) << room;
    }
    EXPECT_EQ(*series.alive, 0);
  }
}

TEST(FlowInTime, ReadingAheadOutlivesTheCall) {
  std::atomic<bool> go = false;
  std::vector<std::size_t> taken;
  const auto load = [&](std::size_t i) {
    while (i == 2 && !go) {
      check_cancelled();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return FlowStep{std::make_shared<StepField>([](const Vec3& x) { return swaying(x, 1); }, std::make_shared<int>(0)),
                    kStepBytes, [&taken, i] { taken.push_back(i); }};
  };
  auto flow = flow_in_time({0, 1, 2, 3, 4}, load);
  {
    Progress first;
    const CancelScope scope(first);
    at(*flow, 0.5);  // reads step 2 ahead from here on
  }
  {
    Progress second;
    second.cancel();
    const CancelScope scope(second);
    EXPECT_THROW(at(*flow, 1.5), Cancelled);
  }
  EXPECT_EQ(taken, (std::vector<std::size_t>{0, 1}));
  go = true;
  at(*flow, 1.5);
  EXPECT_EQ(taken, (std::vector<std::size_t>{0, 1, 2}));
  go = false;
  flow = flow_in_time({0, 1, 2, 3, 4}, load);
  at(*flow, 0.5);
  flow.reset();  // does not wait for the step
}

TEST(FlowInTime, PathSurfacesOfEqualStepsAreStreamSurfaces) {
  const auto saddle = [](const Vec3& x, double) { return Vec3{x.x, -x.y, 0} * 0.5; };
  const SeedCurve curve{{{-0.1, 1.5, 0}, {0.15, 1.5, 0.3}}, false};
  for (const auto interpolation : {TimeInterpolation::constant, TimeInterpolation::linear, TimeInterpolation::cubic}) {
    Series series(5, saddle);
    const auto flow = series.flow(interpolation, 0);
    FlowSurfaceOptions options;
    options.seeds = 30, options.front_step = 0.1, options.duration = 4, options.trace.tolerance = 1e-9;
    Progress progress;
    const FlowSurface stream = flow_surface(*flow, curve, options, progress);
    options.kind = FlowSurfaceKind::path;
    const FlowSurface path = flow_surface(*flow, curve, options, progress);
    EXPECT_GT(path.report.inserted, 10u);
    EXPECT_EQ(path.report.tears, 0u);
    EXPECT_EQ(path.mesh.triangles, stream.mesh.triangles);
    ASSERT_EQ(path.points.size(), stream.points.size());
    for (std::size_t i = 0; i < path.points.size(); ++i)
      EXPECT_LT(norm(path.points[i].position - stream.points[i].position), 1e-7);
  }
}

/// Fronts with inserted particles restart at the seeds' time, partly in parallel.
TEST(FlowInTime, SurfacesDoNotDependOnTheStepsKept) {
  const auto shear = [](const Vec3& x, double t) { return Vec3{0.05 + 0.2 * x.y * x.y * (1 + 0.1 * t), 0, 0}; };
  const SeedCurve curve{{{-1.9, -1, 0}, {-1.9, 1, 0}}, false};
  FlowSurfaceOptions options;
  options.kind = FlowSurfaceKind::path, options.seeds = 300;
  options.front_step = 0.25;
  const auto surface = [&](Series& series, std::uint64_t memory, int threads) {
    const ThreadScope scope(threads);
    Progress progress;
    return flow_surface(*series.flow(TimeInterpolation::linear, memory), curve, options, progress);
  };
  Series all(16, shear), some(16, shear), none(16, shear);
  const FlowSurface kept = surface(all, 1'000'000, 2), partly = surface(some, 8 * kStepBytes, 2),
                    read_again = surface(none, 0, 1);
  EXPECT_GT(kept.report.inserted, 50u);
  EXPECT_EQ(kept.mesh.vertices, read_again.mesh.vertices);
  EXPECT_EQ(kept.mesh.vertices, partly.mesh.vertices);
  EXPECT_EQ(kept.mesh.triangles, read_again.mesh.triangles);
  EXPECT_EQ(all.loads.size(), 16u);
  EXPECT_GT(some.loads.size(), 16u);
  EXPECT_GT(none.loads.size(), some.loads.size());
  // Restarted traces include others that will be needed: a few passes in all, not one per front.
  EXPECT_LT(none.loads.size(), 16 * 8u);
}

/// Particles traced ahead of their front are on the surface like all others.
TEST(FlowInTime, ParticlesTracedAheadAreOnTheSurface) {
  const auto shear = [](const Vec3& x, double t) { return Vec3{0.02 + 0.1 * x.y * x.y * (1 + 0.1 * t), 0, 0}; };
  for (const std::string_view integrator : {"dopri5", "euler"}) {
    Series series(16, shear);
    FlowSurfaceOptions options;
    options.kind = FlowSurfaceKind::path, options.seeds = 200, options.direction = FlowDirection::both;
    options.start = 6.5, options.front_step = 0.25;
    options.trace.integrator = integrator;
    Progress progress;
    const FlowSurface surface = flow_surface(*series.flow(TimeInterpolation::linear, 0),
                                             {{{-0.5, -1, 0}, {-0.5, 1, 0}}, false}, options, progress);
    EXPECT_GT(surface.report.inserted, 50u);
    EXPECT_EQ(surface.report.tears, 0u);
    for (const FlowPoint& p : surface.points) {
      const double y = p.s - 1, t = p.t, t0 = 6.5;
      const double way = (0.02 + 0.1 * y * y) * (t - t0) + 0.005 * y * y * (t * t - t0 * t0);
      EXPECT_NEAR(p.position.x, -0.5 + way, integrator == "euler" ? 2e-2 : 1e-5);
      EXPECT_NEAR(p.position.y, y, 1e-12);
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
