#include "sansmesh/core/parallel.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sansmesh/core/progress.h"

namespace sansmesh {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
  std::vector<int> seen(10007, 0);
  parallel_for(0, seen.size(), 64, [&](std::size_t i) { ++seen[i]; });
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(Parallel, ReductionDoesNotDependOnThreadCount) {
  std::vector<float> values(100003);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0f / static_cast<float>(i + 1);
  const auto sum = [&] {
    return parallel_reduce(
        values.size(), 1000, 0.0f,
        [&](std::size_t a, std::size_t b) { return std::accumulate(&values[a], &values[a] + (b - a), 0.0f); },
        [](float a, float b) { return a + b; });
  };
  set_thread_count(1);
  const float one = sum();
  set_thread_count(8);
  EXPECT_EQ(one, sum());
  set_thread_count(0);
}

TEST(Parallel, ReductionOfTruthValuesLosesNone) {
  // Values of neighbouring chunks are written by several threads at a time.
  set_thread_count(8);
  for (int round = 0; round < 20; ++round) {
    std::size_t holds = 0;
    parallel_reduce(
        std::size_t{1} << 16, 1, false, [](std::size_t, std::size_t) { return true; },
        [&](bool, bool part) { return holds += part, part; });
    EXPECT_EQ(holds, std::size_t{1} << 16);
  }
  set_thread_count(0);
}

TEST(Progress, CancelThrowsAtTheNextStep) {
  Progress progress;
  progress.begin("work", 10);
  progress.advance();
  progress.cancel();
  EXPECT_THROW(progress.advance(), Cancelled);
}

TEST(Progress, RecordsStagesInOrder) {
  std::vector<double> fractions;
  Progress progress([&](const std::string&, double f) { fractions.push_back(f); });
  progress.begin("one", 2);
  progress.advance();
  progress.advance();
  progress.begin("two");
  progress.finish();
  ASSERT_EQ(progress.timings().size(), 2u);
  EXPECT_EQ(progress.timings()[0].stage, "one");
  EXPECT_EQ(progress.timings()[1].stage, "two");
  EXPECT_TRUE(std::find(fractions.begin(), fractions.end(), 0.5) != fractions.end());
}

}  // namespace
}  // namespace sansmesh
