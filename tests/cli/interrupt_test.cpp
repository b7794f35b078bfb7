// Tests of Ctrl-C and similar signals: commands stop at once and leave nothing.
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

/// The promise is half a second; the limit allows for other load of the machine.
constexpr double kSecondsToEnd = kAddressSanitizer || kThreadSanitizer ? 10 : 2;

class Interrupts : public ToolTest {
 protected:
  /// Waits until the tool has its signal handler, as /proc shows; before, a signal ends it like any program.
  static void wait_until_heard(pid_t child, int signal) {
    for (int tries = 0; tries < 3000; ++tries) {
      std::istringstream status(slurp("/proc/" + std::to_string(child) + "/status"));
      for (std::string line; std::getline(status, line);)
        if (line.starts_with("SigCgt:") && (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "the tool never listens";
  }
  /// The command reports the signal in one line and leaves the folder unchanged.
  void expect_heard(const std::vector<std::string>& arguments, int signal, int delay_ms, int again = 0) {
    std::string shown;
    for (const std::string& a : arguments) shown += a + " ";
    const auto before = listing();
    const pid_t child = start(arguments, [] {});
    wait_until_heard(child, signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    const auto begin = std::chrono::steady_clock::now();
    ::kill(child, signal);
    if (again != 0) ::kill(child, again);
    const Outcome outcome = outcome_of(child);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_EQ(outcome.code, 130) << shown << outcome.err;
    EXPECT_EQ(outcome.err, "sansmesh: interrupted, nothing was written\n") << shown;
    EXPECT_EQ(outcome.out, "") << shown;
    EXPECT_LT(seconds, kSecondsToEnd) << shown;
    EXPECT_EQ(listing(), before) << shown;
  }
};

TEST_F(Interrupts, AreHeardInTheMiddleOfWork) {
  write_points(path("large.ply"), sphere(600000));
  expect_heard({"reconstruct", "large.ply", "-o", "out.ply", "--threads", "1"}, SIGINT, 400);
  expect_heard({"reconstruct", "large.ply", "-o", "out.ply", "--threads", "2"}, SIGTERM, 400);
  expect_heard({"info", "large.ply", "large.ply", "large.ply", "--threads", "1"}, SIGTERM, 200);
}

TEST_F(Interrupts, AreHeardInWaitsForPipes) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  write_points(path("small.ply"), sphere(1000));
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) expect_heard({"info", "pipe"}, signal, 200);
  expect_heard({"convert", "small.ply", "-o", "out.ply", "--transform", "pipe"}, SIGTERM, 200);
  expect_heard({"deform", "small.ply", "-o", "out.ply", "--handles", "pipe"}, SIGTERM, 200);
  // The pipe has no reader, so the result waits.
  ASSERT_EQ(::mkfifo(path("pipe.ply").c_str(), 0600), 0);
  expect_heard({"convert", "small.ply", "-o", "pipe.ply"}, SIGINT, 300);
}

TEST_F(Interrupts, ThatWhoeverStartedItIgnoresAreIgnored) {
  for (const int ignored : {SIGINT, SIGHUP}) {
    const std::string pipe = "pipe" + std::to_string(ignored) + ".xyz";
    ASSERT_EQ(::mkfifo(path(pipe).c_str(), 0600), 0);
    const pid_t child = start({"info", pipe}, [&] { std::signal(ignored, SIG_IGN); });
    wait_until_heard(child, SIGTERM);
    ::kill(child, ignored);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    write(pipe, "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    const Outcome outcome = outcome_of(child);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("points      4\n"), std::string::npos) << outcome.out;
  }
}

TEST_F(Interrupts, CannotBeListenedToWhereThereAreNoMoreThreads) {
  SANSMESH_NOT_SANITIZED("stacks of any size");
  write_points(path("small.ply"), sphere(1000));
  const Outcome outcome = outcome_of(start({"info", "small.ply", "--threads", "1"}, [] {
    // No thread can have a stack of this size.
    const rlimit stack{rlim_t{1} << 47, RLIM_INFINITY};
    ::setrlimit(RLIMIT_STACK, &stack);
  }));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("points      1,000\n"), std::string::npos) << outcome.out;
}

TEST_F(Interrupts, TheSecondEndsAtOnce) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  expect_heard({"info", "pipe"}, SIGINT, 200, SIGTERM);
}

}  // namespace
}  // namespace sansmesh::test
