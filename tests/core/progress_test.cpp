// Progress subclasses: an observer and a stop condition.
#include "sansmesh/progress.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::test {
namespace {

class Watcher : public Progress {
 public:
  std::vector<std::string> seen;
  bool stop = false;

 protected:
  void report(const std::string& stage, double fraction) override {
    seen.push_back(stage + " " + std::to_string(fraction).substr(0, 4));
  }
  bool wants_stop() const override { return stop; }
};

TEST(Progress, IsObservedByOverriding) {
  Watcher watcher;
  watcher.begin("fit", 4);
  watcher.advance();
  watcher.advance(3);
  watcher.begin("mesh");
  watcher.finish();
  EXPECT_EQ(watcher.seen,
            (std::vector<std::string>{"fit 0.00", "fit 0.25", "fit 1.00", "fit 1.00", "mesh 0.00", "mesh 1.00"}));
  ASSERT_EQ(watcher.timings().size(), 2u);
  EXPECT_EQ(watcher.timings()[0].stage, "fit");
  EXPECT_GE(watcher.timings()[0].wall_seconds, 0);
}

TEST(Progress, StopsWhereItsOwnerWantsIt) {
  Watcher watcher;
  watcher.begin("fit", 10);
  EXPECT_NO_THROW(watcher.check());
  watcher.stop = true;
  EXPECT_THROW(watcher.advance(), Cancelled);
  EXPECT_THROW(watcher.begin("mesh"), Cancelled);
  watcher.stop = false;
  EXPECT_NO_THROW(watcher.check());
  watcher.cancel();
  EXPECT_THROW(watcher.check(), Cancelled);
}

TEST(Progress, CallsItsCallbackOnceAPercent) {
  int calls = 0;
  Progress progress([&](const std::string& stage, double) {
    EXPECT_EQ(stage, "fit");
    ++calls;
  });
  progress.begin("fit", 100000);
  for (int i = 0; i < 100000; ++i) progress.advance();
  progress.finish();
  EXPECT_GT(calls, 50);
  EXPECT_LE(calls, 103);
}

}  // namespace
}  // namespace sansmesh::test
