// Fixture that runs the command line tool in a temporary folder.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/clean_text.h"
#include "support/places.h"

namespace sansmesh::test {

/// The bundled scan.
inline const std::string kOwl = source_file("examples/data/owl.vtp");

struct Outcome {
  int code = -1;
  std::string out, err;
  long peak_megabytes = 0;  ///< peak memory; at least that of this process
  double cpu_seconds = 0;
  long lines_of_error() const { return std::count(err.begin(), err.end(), '\n'); }
};

inline std::string slurp(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Rows of a table of comma-separated numbers without its header, which is stored in `header` if given.
inline std::vector<std::vector<double>> number_rows(const std::filesystem::path& file, std::string* header = nullptr) {
  std::istringstream text(slurp(file));
  std::string line;
  std::getline(text, line);
  if (header) *header = line;
  std::vector<std::vector<double>> rows;
  while (std::getline(text, line)) {
    std::istringstream words(line);
    std::string word;
    rows.emplace_back();
    while (std::getline(words, word, ',')) rows.back().push_back(std::stod(word));
  }
  return rows;
}

/// A command line that must fail.
struct Failing {
  std::vector<std::string> arguments;
  int code;
  std::vector<std::string> parts;  ///< parts of the message
};

/// Temporary folder for one test.
class ToolTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "sansmesh-cli-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(folder_, ignored);
  }

  /// The program under test.
  virtual const char* program() const { return tool(); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  /// Sorted names in the folder, without files of captured output.
  std::vector<std::string> listing() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      if (const std::string name = entry.path().filename().string(); !name.starts_with("captured-"))
        names.push_back(name);
    std::sort(names.begin(), names.end());
    return names;
  }

  /// Starts the tool in the folder; `prepare` is called first, in its process.
  template <class Prepare>
  pid_t start(const std::vector<std::string>& arguments, Prepare&& prepare) const {
    const std::string out = path("captured-out"), err = path("captured-err");
    const pid_t child = ::fork();
    if (child == 0) {
      if (::chdir(folder_.c_str()) != 0) ::_exit(126);
      const int o = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const int e = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      ::dup2(o, 1), ::dup2(e, 2);
      std::signal(SIGINT, SIG_DFL);  // independent of the settings of the test runner
      prepare();
      std::vector<char*> argv{const_cast<char*>(program())};
      for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
      argv.push_back(nullptr);
      ::execv(program(), argv.data());
      ::_exit(127);
    }
    return child;
  }
  Outcome outcome_of(pid_t child) const {
    int status = 0;
    rusage used{};
    ::wait4(child, &status, 0, &used);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), slurp(path("captured-out")),
            slurp(path("captured-err")), used.ru_maxrss / 1024, seconds(used.ru_utime) + seconds(used.ru_stime)};
  }

  /// Runs the tool in the folder; sends `signal` after `delay_ms` unless 0.
  Outcome run(const std::vector<std::string>& arguments, int signal = 0, int delay_ms = 0) const {
    const pid_t child = start(arguments, [] {});
    if (signal != 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
      ::kill(child, signal);
    }
    return outcome_of(child);
  }

  /// The object that a command prints with --json; null and a failure otherwise.
  nlohmann::json json_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
  }

  /// Checks that each command fails with one printable line and leaves the folder unchanged.
  void expect_failures(const std::vector<Failing>& failing) const {
    const std::vector<std::string> before = listing();
    for (const Failing& f : failing) {
      std::string shown = "sansmesh";
      for (const std::string& a : f.arguments) shown += " " + a;
      const Outcome outcome = run(f.arguments);
      EXPECT_EQ(outcome.code, f.code) << shown << "\n" << outcome.err;
      EXPECT_EQ(outcome.lines_of_error(), 1) << shown << "\n" << outcome.err;
      EXPECT_TRUE(is_clean(outcome.err.substr(0, outcome.err.find('\n')))) << shown << "\n" << outcome.err;
      for (const std::string& part : f.parts)
        EXPECT_NE(outcome.err.find(part), std::string::npos) << shown << "\n" << outcome.err;
      EXPECT_EQ(outcome.out, "") << shown;
      EXPECT_EQ(listing(), before) << shown;
    }
  }
  void expect_failure(const std::vector<std::string>& arguments, int code, const std::string& words) const {
    expect_failures({{arguments, code, {words}}});
  }

  std::filesystem::path folder_;
};

}  // namespace sansmesh::test
