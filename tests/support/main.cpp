// Options of every test program besides GoogleTest's own (see --help):
//
//   --threads=N     number of threads of the library's loops unless the test sets it; default 1, since ctest runs
//                   several programs in parallel
//   --simd=NAME     instruction set of the kernels (SCALAR, SSE4, AVX2 …), of those in the library
//   --simd=others   runs the tests once for every instruction set of this processor except the best one, which is the
//                   default; skips tests that begin with SANSMESH_RUNS_ONCE
//   --files=A,B     runs only tests from these sources; replaces --gtest_filter
//
// Exits with the number of failed runs, at most 1.
#include "sansmesh/core/simd_targets.h"
// Must follow simd_targets.h, which defines the library's instruction sets.
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

/// Returns the value of --name=… and removes it from the arguments; empty if absent.
std::string take(int& argc, char** argv, const std::string& name) {
  const std::string start = "--" + name + "=";
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (!argument.starts_with(start)) continue;
    std::string value(argument.substr(start.size()));
    for (int k = i; k < argc; ++k) argv[k] = argv[k + 1];  // including the terminating null pointer
    --argc;
    return value;
  }
  return {};
}

bool is_one_of(std::string_view path, const std::string& files) {
  const std::string_view name = path.substr(path.rfind('/') + 1);
  for (std::size_t at = 0; at < files.size();) {
    const std::size_t end = std::min(files.find(',', at), files.size());
    if (std::string_view(files).substr(at, end - at) == name) return true;
    at = end + 1;
  }
  return false;
}

/// GoogleTest filter for the tests of some sources.
std::string filter_of(const std::string& files) {
  std::string names;
  const ::testing::UnitTest& all = *::testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const ::testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const ::testing::TestInfo& test = *suite.GetTestInfo(t);
      if (is_one_of(test.file(), files)) names += std::string(suite.name()) + '.' + test.name() + ':';
    }
  }
  return names;
}

void use_simd(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

int run(int threads) {
  const ThreadScope scope(threads);
  return RUN_ALL_TESTS();
}

/// Runs the tests in a separate process per instruction set, since some cache results.
int run_on_others(const std::vector<std::int64_t>& targets, int threads) {
  int failed = 0;
  for (const std::int64_t target : targets) {
    if (target == targets.front()) continue;  // sorted, best first
    std::printf("kernels: %s\n", hwy::TargetName(target));
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
      use_simd(target);
      on_other_simd = true;
      std::exit(run(threads));
    }
    int status = 0;
    if (child < 0 || ::waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) failed = 1;
  }
  return failed;
}

int main(int argc, char** argv) {
  const std::string threads = take(argc, argv, "threads"), simd = take(argc, argv, "simd"),
                    files = take(argc, argv, "files");
  ::testing::InitGoogleTest(&argc, argv);
  if (argc > 1) {
    std::fprintf(stderr, "%s: what is %s?\n", argv[0], argv[1]);
    return 2;
  }
  if (!files.empty()) {
    const std::string filter = filter_of(files);
    if (filter.empty()) {
      std::fprintf(stderr, "%s: no tests are in %s\n", argv[0], files.c_str());
      return 2;
    }
    GTEST_FLAG_SET(filter, filter);
  }
  const int count = threads.empty() ? 1 : std::atoi(threads.c_str());
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  if (simd == "others") return run_on_others(targets, count);
  for (const std::int64_t target : targets) {
    if (simd != hwy::TargetName(target)) continue;
    use_simd(target);
    return run(count);
  }
  if (!simd.empty()) {
    std::fprintf(stderr, "%s: this processor or library has no %s\n", argv[0], simd.c_str());
    return 2;
  }
  return run(count);
}

}  // namespace
}  // namespace sansmesh::test

int main(int argc, char** argv) { return sansmesh::test::main(argc, argv); }
