// Output batches: atomicity, pipes, full disks, leftovers of killed programs.
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <thread>

#include "io_test_tools.h"
#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/io/output_batch.h"
#include "sansmesh/io/staging.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Names of the hidden files in the folder.
std::vector<std::string> hidden_in(const Folder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (const std::string name = entry.path().filename().string(); name[0] == '.') names.push_back(name);
  return names;
}

/// Runs `work` in a child process, which may end in any way.
template <class Work>
pid_t start_child(Work&& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(::testing::Test::HasFailure() ? 1 : 0);
  }
  return child;
}

int end_of(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(Batches, ShowAllFilesAtOnce) {
  const Folder folder;
  folder.put("old.txt", "old");
  {
    OutputBatch batch;
    write_text(folder / "old.txt", "new");
    write_text(folder / "other.txt", "x");
    EXPECT_EQ(batch.waiting(), 2u);
    EXPECT_EQ(slurp(folder / "old.txt"), "old");
    EXPECT_FALSE(std::filesystem::exists(folder / "other.txt"));
    batch.commit();
    EXPECT_EQ(slurp(folder / "old.txt"), "new");
    EXPECT_EQ(slurp(folder / "other.txt"), "x");
  }
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(Batches, LeaveNothingWithoutCommit) {
  const Folder folder;
  folder.put("old.txt", "old");
  {
    const OutputBatch batch;
    {
      OutputBatch inner;  // a part of the outer one
      write_text(folder / "old.txt", "new");
      inner.commit();
    }
    write_text(folder / "other.txt", "x");
    EXPECT_EQ(slurp(folder / "old.txt"), "old");
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Batches, KeepWhatIsSaidTwiceInTheSpaceOfTheFirst) {
  const Folder folder;
  OutputBatch batch;
  write_text(folder / "series.pvd", std::string(100'000, 'x'));
  write_text(folder / "series.pvd", "short");
  EXPECT_EQ(batch.waiting(), 1u);
  batch.commit();
  EXPECT_EQ(slurp(folder / "series.pvd"), "short");
}

TEST(Batches, AFileThatIsTooLargeTakesTheOthersWithIt) {
  const Folder folder;
  folder.put("first.txt", "old");
  // SIGXFSZ ends programs that do not handle it: the library blocks it.
  const int status = end_of(start_child([&] {
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    OutputBatch batch;
    write_text(folder / "first.txt", "new");
    expect_file_error(folder / "large.txt", "exceeds the size limit",
                      [&] { write_text(folder / "large.txt", std::string(2000, 'x')); });
  }));
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_EQ(slurp(folder / "first.txt"), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Batches, SayWhichFilesAreInPlace) {
  const Folder folder;
  OutputBatch batch;
  write_text(folder / "a.txt", "a");
  write_text(folder / "b.txt", "b");
  std::filesystem::create_directory(folder / "b.txt");
  const std::string message = expect_file_error(folder / "b.txt", "it is a directory", [&] { batch.commit(); });
  EXPECT_NE(message.find("written are " + (folder / "a.txt")), std::string::npos) << message;
  EXPECT_TRUE(hidden_in(folder).empty());
}

TEST(Batches, GoOnWaitingWhereOneDoesNotGetOntoTheDisk) {
  const Folder folder;
  OutputBatch batch;
  for (const char* const name : {"a.txt", "b.txt", "c.txt"}) write_text(folder / name, name);
  ASSERT_EQ(hidden_in(folder).size(), 1u);
  ASSERT_TRUE(std::filesystem::remove(folder.path() / hidden_in(folder)[0] / "1"));
  expect_file_error(folder / "b.txt", "cannot be written", [&] { batch.commit(); });
  EXPECT_EQ(batch.waiting(), 2u);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
  batch.commit();
  EXPECT_EQ(slurp(folder / "a.txt"), "a.txt");
  EXPECT_EQ(slurp(folder / "c.txt"), "c.txt");
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(Batches, GoOnWaitingWhereTheyAreCancelled) {
  const Folder folder;
  OutputBatch batch;
  write_text(folder / "a.txt", "a");
  {
    Progress progress;
    const CancelScope scope(progress);
    progress.cancel();
    EXPECT_THROW(batch.commit(), Cancelled);
  }
  EXPECT_EQ(batch.waiting(), 1u);
  batch.commit();
  EXPECT_EQ(slurp(folder / "a.txt"), "a");
}

TEST(Batches, OfProgramsThatEndInTheMiddle) {
  const Folder folder;
  OutputBatch batch;
  write_text(folder / "a.txt", "a");
  batch.commit();
  write_text(folder / "b.txt", "b");
  EXPECT_EQ(abandon_outputs(), std::vector<std::string>{folder / "a.txt"});
  EXPECT_THROW(write_text(folder / "c.txt", "c"), Cancelled);
  EXPECT_THROW(batch.commit(), Cancelled);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Staging, OfAKilledProgramIsRemovedByTheNext) {
  const Folder folder;
  const int status = end_of(start_child([&] {
    const OutputBatch batch;
    write_text(folder / "a.txt", "a");
    ::kill(::getpid(), SIGKILL);
  }));
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(hidden_in(folder).size(), 1u);
  write_text(folder / "b.txt", "b");
  EXPECT_TRUE(hidden_in(folder).empty());
  EXPECT_EQ(slurp(folder / "b.txt"), "b");
}

TEST(Staging, OfALivingProgramStays) {
  const Folder folder;
  int ready[2], go[2];
  ASSERT_EQ(::pipe(ready), 0);
  ASSERT_EQ(::pipe(go), 0);
  char byte = 0;
  const pid_t child = start_child([&] {
    OutputBatch batch;
    write_text(folder / "a.txt", "a");
    (void)!::write(ready[1], "x", 1);
    (void)!::read(go[0], &byte, 1);
    batch.commit();
  });
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_EQ(io::remove_stale_staging(folder.path()), 0u);
  (void)!::write(go[1], "x", 1);
  EXPECT_EQ(end_of(child), 0);
  EXPECT_EQ(slurp(folder / "a.txt"), "a");
  EXPECT_EQ(folder.entries(), 1u);
  for (const int fd : {ready[0], ready[1], go[0], go[1]}) ::close(fd);
}

TEST(Staging, OfOtherMachinesIsGivenADay) {
  const Folder folder;
  const std::string foreign = folder / ".sansmesh-000000000000-1-0.tmp";
  std::filesystem::create_directory(foreign);
  EXPECT_EQ(io::remove_stale_staging(folder.path()), 0u);
  std::filesystem::last_write_time(foreign, std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
  EXPECT_EQ(io::remove_stale_staging(folder.path()), 1u);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Places, ADanglingLinkIsFollowed) {
  const Folder folder;
  std::filesystem::create_directory(folder / "there");
  std::filesystem::create_symlink("there/far.txt", folder / "link.txt");
  std::filesystem::create_symlink("nowhere/far.txt", folder / "lost.txt");
  std::filesystem::create_symlink("round.txt", folder / "round.txt");
  EXPECT_NO_THROW(check_writable(folder / "link.txt", "text"));
  write_text(folder / "link.txt", "x");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(slurp(folder / "there/far.txt"), "x");
  for (const char* const bad : {"lost.txt", "round.txt"}) {
    const std::string cause = bad[0] == 'l' ? "its folder does not exist" : "circle";
    expect_file_error(folder / bad, cause, [&] { check_writable(folder / bad, "text"); });
    expect_file_error(folder / bad, cause, [&] { write_text(folder / bad, "x"); });
    EXPECT_TRUE(std::filesystem::is_symlink(folder / bad));
  }
}

TEST(Places, ANameThatIsTooLongIsToldBeforeTheWork) {
  const Folder folder;
  const std::string file = folder / (std::string(300, 'x') + ".txt");
  expect_file_error(file, "its name is too long", [&] { check_writable(file, "text"); });
}

/// Cancels work that would wait for ever after two seconds.
class Patience {
  Progress progress_;
  CancelScope scope_{progress_};
  std::jthread late_{[this](const std::stop_token& over) {
    for (int k = 0; k < 200 && !over.stop_requested(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    progress_.cancel();
  }};
};

class Pipes : public ::testing::Test {
 protected:
  Pipes() { ::mkfifo(pipe().c_str(), 0600); }
  std::string pipe() const { return folder_ / "pipe"; }
  /// Seconds until `work` is cancelled; cancellation is requested after a twentieth of a second.
  template <class Work>
  double seconds_until_cancelled(Work&& work) {
    Progress progress;
    const CancelScope scope(progress);
    std::jthread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      progress.cancel();
    });
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THROW(work(), Cancelled);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  const Folder folder_;
};

TEST_F(Pipes, AreWrittenAndRead) {
  const std::string text(1'000'000, 'x');
  std::string got;
  std::jthread reader([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    got = read_text(pipe());
  });
  write_text(pipe(), text);
  reader.join();
  EXPECT_EQ(got, text);
}

TEST_F(Pipes, OfSlowWritersAreReadToTheEnd) {
  std::jthread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    std::ofstream stream(pipe());
    for (int i = 0; i < 3; ++i) {
      stream << i << " 0 0\n" << std::flush;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  const std::string text = read_text(pipe());
  EXPECT_EQ(text, "0 0 0\n1 0 0\n2 0 0\n");
}

TEST_F(Pipes, WhoseWritersAreGoneAreReadToTheEnd) {
  // A second opening, like that of /dev/stdin, of a full pipe without a writer.
  const int first = ::open(pipe().c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  std::ofstream(pipe()) << "0 0 0\n";
  std::string text;
  {
    const Patience patience;
    EXPECT_NO_THROW(text = read_text(pipe()));
  }
  EXPECT_EQ(text, "0 0 0\n");
  ::close(first);
}

TEST_F(Pipes, WaitsAreCancelled) {
  // No writer; no reader.
  EXPECT_LT(seconds_until_cancelled([&] { read_points(pipe()); }), 1.0);
  EXPECT_LT(seconds_until_cancelled([&] { write_text(pipe(), "x"); }), 1.0);
  // The other end is open, but inactive.
  const int end = ::open(pipe().c_str(), O_RDWR | O_CLOEXEC);
  EXPECT_LT(seconds_until_cancelled([&] { read_points(pipe()); }), 1.0);
  EXPECT_LT(seconds_until_cancelled([&] { write_text(pipe(), std::string(1 << 20, 'x')); }), 1.0);
  ::close(end);
}

TEST_F(Pipes, ThatNobodyReadsAnyMoreAreAnError) {
  std::jthread reader([&] {
    const int fd = ::open(pipe().c_str(), O_RDONLY);
    char byte = 0;
    (void)!::read(fd, &byte, 1);
    ::close(fd);
  });
  // SIGPIPE would end this program.
  expect_file_error(pipe(), "its reader is gone", [&] { write_text(pipe(), std::string(1 << 20, 'x')); });
}

/// Like standard output by the name /dev/stdout.
TEST_F(Pipes, ThatAreDescriptorsOfOursAreWrittenWhoeverReads) {
  const int reader = ::open(pipe().c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const int writer = ::open(pipe().c_str(), O_WRONLY | O_CLOEXEC);
  const std::string name = "/proc/self/fd/" + std::to_string(writer);
  ::close(reader);
  const Patience patience;
  expect_file_error(name, "its reader is gone", [&] { write_text(name, "x"); });
  ::close(writer);
}

TEST_F(Pipes, ThatCannotBeOpenedAgainAreWrittenAsTheyAre) {
  const int reader = ::open(pipe().c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const int writer = ::open(pipe().c_str(), O_WRONLY | O_CLOEXEC);
  ::fcntl(reader, F_SETFL, 0);
  ASSERT_EQ(::chmod(pipe().c_str(), 0), 0);  // as of another user
  const std::string name = "/proc/self/fd/" + std::to_string(writer), text(1'000'000, 'x');
  const pid_t child = start_child([&] {
    // Permissions do not apply to root.
    if (::geteuid() == 0 && (::setuid(65534) != 0 || ::prctl(PR_SET_DUMPABLE, 1) != 0)) ::_exit(3);
    EXPECT_LT(::open(name.c_str(), O_WRONLY | O_NONBLOCK), 0);
    EXPECT_NO_THROW(write_text(name, text));
    // Cancellation interrupts a wait for an inactive reader.
    EXPECT_LT(seconds_until_cancelled([&] { write_text(name, text); }), 1.0);
  });
  std::string got;
  std::vector<char> block(1 << 16);
  for (ssize_t n; got.size() < text.size();) {
    n = ::read(reader, block.data(), std::min(block.size(), text.size() - got.size()));
    if (n <= 0) break;
    got.append(block.data(), static_cast<std::size_t>(n));
  }
  EXPECT_EQ(end_of(child), 0);
  EXPECT_EQ(got, text);
  ::close(reader), ::close(writer);
}

}  // namespace
}  // namespace sansmesh::inline v1
