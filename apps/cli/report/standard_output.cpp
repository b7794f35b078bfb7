#include "cli/report/standard_output.h"

#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "sansmesh/error.h"
#include "sansmesh/io/output_destination.h"

namespace sansmesh::cli {
namespace {

[[noreturn]] void fail_out(int error) {
  if (error == EPIPE) throw BrokenPipe();
  if (error == EBADF) throw FileError("standard output", "cannot be written (it is closed)");
  io::fail_output("standard output", error);
}

}  // namespace

void prepare_standard_output() {
  for (int d = STDIN_FILENO; d <= STDERR_FILENO; ++d)
    if (::fcntl(d, F_GETFD) < 0 && errno == EBADF)
      (void)!::open("/dev/null",
                    d == STDERR_FILENO ? O_WRONLY : O_RDONLY);  // receives the lowest free number, which is d
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void print_out(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_out(errno);
}

void finish_out() {
  if (std::fflush(stdout) != 0) fail_out(errno);
  // Some file systems report errors only on close.
  const int copy = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  if (copy >= 0 && ::close(copy) != 0 && errno != EINTR) fail_out(errno);
}

void end_by_broken_pipe() {
  std::signal(SIGPIPE, SIG_DFL);
  std::raise(SIGPIPE);
  std::_Exit(128 + SIGPIPE);  // if the signal is blocked
}

void print_err(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace sansmesh::cli
