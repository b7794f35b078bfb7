// Tests of failing outputs: full disks, closed and broken outputs, and partial series.
#include <sys/resource.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

class Outputs : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write_points(path("ball.ply"), sphere(2000));
  }
  /// Limits the size of files of the process, standard output included.
  static void limit_files(rlim_t bytes) {
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
};

const std::vector<std::string> kTalks[] = {{"info", "ball.ply"},
                                           {"info", "ball.ply", "--json"},
                                           {"help"},
                                           {"help", "volume", "render"},
                                           {"--version"},
                                           {"info", "--help"},
                                           {"completion", "bash"},
                                           {"manual", "reconstruct"},
                                           {"advise", "ball.ply"}};

TEST_F(Outputs, ResultsThatCannotBePrintedAreAnError) {
  for (const auto& arguments : kTalks) {
    const pid_t child = start(arguments, [] {
      const int full = ::open("/dev/full", O_WRONLY);
      ::dup2(full, 1);
    });
    const Outcome outcome = outcome_of(child);
    EXPECT_EQ(outcome.code, 1) << arguments[0];
    EXPECT_EQ(outcome.err, "sansmesh: standard output: cannot be written (the disk is full)\n") << arguments[0];
  }
}

TEST_F(Outputs, ClosedStandardOutputIsNoFileOfTheCommand) {
  for (const auto& arguments : kTalks) {
    const Outcome outcome = outcome_of(start(arguments, [] { ::close(1); }));
    EXPECT_EQ(outcome.code, 1) << arguments[0];
    EXPECT_EQ(outcome.err, "sansmesh: standard output: cannot be written (it is closed)\n") << arguments[0];
  }
  // A closed standard error is harmless.
  const Outcome outcome = outcome_of(start({"convert", "ball.ply", "-o", "out.ply"}, [] { ::close(2); }));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(read_points(path("out.ply")).size(), 2000u);
}

TEST_F(Outputs, ABrokenPipeEndsQuietlyWithTheFilesWritten) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  ::close(ends[0]);
  const Outcome outcome = outcome_of(start({"convert", "ball.ply", "-o", "out.ply"}, [&] { ::dup2(ends[1], 1); }));
  ::close(ends[1]);
  EXPECT_EQ(outcome.code, 1000 + SIGPIPE);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(read_points(path("out.ply")).size(), 2000u);
}

TEST_F(Outputs, AFileThatIsTooLargeIsAnError) {
  const auto before = listing();
  const Outcome outcome =
      outcome_of(start({"convert", "ball.ply", "-o", "out.obj", "--quiet"}, [] { limit_files(10'000); }));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "sansmesh: out.obj: cannot be written (it exceeds the size limit of files, see ulimit -f)\n");
  EXPECT_EQ(listing(), before);
}

TEST_F(Outputs, AllFilesOfACommandOrNone) {
  const auto before = listing();
  // The mesh fits the limit, its picture does not.
  const Outcome outcome = outcome_of(start({"reconstruct", "ball.ply", "-o", "out.ply", "--triangles", "20",
                                            "--preview", "out.png", "--width", "600", "--height", "600", "--quiet"},
                                           [] { limit_files(6'000); }));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err.find("sansmesh: out.png: cannot be written"), 0u) << outcome.err;
  EXPECT_EQ(listing(), before);
}

TEST_F(Outputs, TheResultMayGoToStandardOutput) {
  std::filesystem::create_symlink("/dev/stdout", path("out.xyz"));
  const Outcome outcome = run({"convert", "ball.ply", "-o", "out.xyz"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 2000);
  EXPECT_NE(outcome.err.find("2,000 points"), std::string::npos) << "words go elsewhere: " << outcome.err;
}

/// `-` is standard input and output, `-.csv` with a format.
TEST_F(Outputs, FilesMayBeStandardInputAndOutput) {
  const auto piped = [&](const std::vector<std::string>& arguments, const std::string& file) {
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    std::signal(SIGPIPE, SIG_IGN);
    const pid_t child = start(arguments, [&] { ::dup2(ends[0], 0); });
    ::close(ends[0]);
    const std::string bytes = slurp(path(file));
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t done = ::write(ends[1], bytes.data() + at, bytes.size() - at);
      if (done <= 0) break;
      at += static_cast<std::size_t>(done);
    }
    ::close(ends[1]);
    const Outcome outcome = outcome_of(child);
    std::signal(SIGPIPE, SIG_DFL);
    EXPECT_EQ(outcome.code, 0) << arguments[0] << ": " << outcome.err;
    return outcome;
  };
  EXPECT_NE(piped({"info", "-"}, "ball.ply").out.find("points      2,000"), std::string::npos);
  // Points and a table of them.
  const std::string table = piped({"convert", "-", "-o", "-.csv"}, "ball.ply").out;
  EXPECT_TRUE(table.starts_with("x,y,z")) << table.substr(0, 60);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2001);
  write("ball.csv", table);
  EXPECT_EQ(piped({"convert", "-.csv", "-o", "again.xyz", "--json"}, "ball.csv").err, "");
  EXPECT_EQ(read_points(path("again.xyz")).size(), 2000u);
  // A mesh, a function, its values, a picture.
  EXPECT_TRUE(piped({"reconstruct", "-", "-o", "-"}, "ball.ply").out.starts_with("ply\n"));
  write("ball.smf", piped({"fit", "-", "-o", "-"}, "ball.ply").out);
  EXPECT_NE(piped({"mesh", "-", "-o", "-.off"}, "ball.smf").out.substr(0, 8).find("OFF"), std::string::npos);
  EXPECT_NE(piped({"probe", "-", "--at", "1,0,0", "-o", "-.csv"}, "ball.smf").out.find("gradient_x"),
            std::string::npos);
  EXPECT_TRUE(piped({"section", "-.smf", "--plane", "z=0", "-o", "-.csv"}, "ball.smf").out.starts_with("plane"));
  EXPECT_TRUE(
      piped({"render", "-", "-o", "-", "--width", "40", "--height", "30"}, "ball.ply").out.starts_with("\x89PNG"));
  // Text and JSON are printed to standard error then.
  EXPECT_NE(piped({"convert", "-", "-o", "-", "--json"}, "ball.ply").err.find("\"schema\""), std::string::npos);

  expect_failures({{{"convert", "-", "-", "-o", "x.ply"}, 2, {"only one file can be standard input"}},
                   {{"reconstruct", "ball.ply", "-o", "-", "--preview", "-"}, 2, {"standard output"}},
                   {{"render", "ball.ply", "-o", "-", "--frames", "3"}, 2, {"one file"}},
                   {{"convert", "ball.ply", "-o", "-.doc"}, 1, {"doc"}}});
}

const char* const kTet =
    "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\n"
    "End\n";

TEST_F(Outputs, OfASeriesTheFramesBeforeTheErrorAreKept) {
  write("tet.mesh", kTet);
  // The third frame cannot be written.
  std::filesystem::create_directory(path("out_0002.vtu"));
  const Outcome outcome = run({"simulate", "tet.mesh", "-o", "out.vtu", "--duration", "0.4", "--fps", "10"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("out_0002.vtu: cannot be written (it is a directory); 3 files before it are kept"),
            std::string::npos)
      << outcome.err;
  const std::string collection = slurp(path("out.pvd"));
  EXPECT_NE(collection.find("out_0001.vtu"), std::string::npos) << collection;
  EXPECT_EQ(collection.find("out_0002.vtu"), std::string::npos) << collection;
  EXPECT_TRUE(std::filesystem::exists(path("out_0001.vtu")));
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "out.pvd", "out_0000.vtu", "out_0001.vtu", "out_0002.vtu",
                                                 "tet.mesh"}));
}

TEST_F(Outputs, OfASeriesTheFramesAreKeptWhateverTheError) {
  SANSMESH_NOT_SANITIZED("takes more memory than is left");
  write("tet.mesh", kTet);
  // Meshes are written first; the pictures exceed the limit.
  const Outcome outcome =
      outcome_of(start({"simulate", "tet.mesh", "-o", "out.ply", "-o", "out.png", "--duration", "0.4", "--fps", "10",
                        "--width", "16000", "--height", "16000", "--threads", "1"},
                       [] {
                         const rlimit memory{rlim_t{2} << 30, rlim_t{2} << 30};
                         ::setrlimit(RLIMIT_AS, &memory);
                       }));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "sansmesh: not enough memory; 5 files before it are kept\n");
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "out_0000.ply", "out_0001.ply", "out_0002.ply",
                                                 "out_0003.ply", "out_0004.ply", "tet.mesh"}));
}

}  // namespace
}  // namespace sansmesh::test
