#include "sansmesh/io/output_batch.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <utility>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/output_destination.h"
#include "sansmesh/io/staging.h"

namespace sansmesh::inline v1 {
namespace {

using Parts = std::vector<std::string_view>;

constexpr std::size_t kWriteBlock = std::size_t{1} << 24;  // bytes between two checks for cancellation
constexpr std::size_t kMostNamed = 5;                      // files in a message
constexpr std::size_t kSyncsAtOnce = 8;

/// Blocks SIGXFSZ and SIGPIPE in the calling thread, so that a write that is too large, or into a pipe without a
/// reader, fails with an error; a signal that arrives is consumed.
class HeldSignals {
 public:
  HeldSignals() {
    sigset_t pending;
    sigemptyset(&held_);
    ::sigpending(&pending);
    for (const int signal : {SIGXFSZ, SIGPIPE})
      if (sigismember(&pending, signal) != 1) sigaddset(&held_, signal);
    ::pthread_sigmask(SIG_BLOCK, &held_, &before_);
  }
  ~HeldSignals() {
    const int error = errno;
    const timespec at_once{};
    while (::sigtimedwait(&held_, nullptr, &at_once) > 0) {
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    errno = error;
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

 private:
  sigset_t held_, before_;
};

/// Writes everything or returns the error. `blocks`: the descriptor is a pipe in blocking mode, which would delay
/// cancellation; each write is limited to what a ready pipe accepts.
int write_all(int fd, const Parts& parts, bool blocks = false) {
  const HeldSignals held;
  for (const std::string_view part : parts) {
    const char* data = part.data();
    for (std::size_t left = part.size(); left > 0;) {
      check_cancelled();
      if (blocks) detail::wait_for(fd, POLLOUT);
      const ssize_t done = ::write(fd, data, std::min(left, blocks ? std::size_t{PIPE_BUF} : kWriteBlock));
      if (done < 0 && errno == EINTR) continue;
      if (done < 0 && errno == EAGAIN) {
        detail::wait_for(fd, POLLOUT);
        continue;
      }
      if (done < 0) return errno;
      data += done, left -= static_cast<std::size_t>(done);
    }
  }
  return 0;
}

/// Opens a file that cannot be replaced. Waits for the reader of a named pipe.
int open_stream(const std::string& file, const io::OutputDestination& destination) {
  const int flags = O_WRONLY | O_CLOEXEC | O_NOCTTY | (destination.pipe ? O_NONBLOCK : 0);
  if (destination.descriptor >= 0) {
    // A second, non-blocking description of the same pipe. It does not exist if the pipe's reader is gone or another
    // user created the pipe; then the original descriptor is used.
    const std::string name = fmt::format("/proc/self/fd/{}", destination.descriptor);
    int fd = destination.pipe ? ::open(name.c_str(), flags) : -1;
    if (fd < 0) fd = ::fcntl(destination.descriptor, F_DUPFD_CLOEXEC, 0);
    if (fd < 0) io::fail_output(file, errno);
    return fd;
  }
  for (;;) {
    const int fd = ::open(destination.path.c_str(), flags);
    if (fd >= 0) return fd;
    if (!destination.pipe || errno != ENXIO) io::fail_output(file, errno);
    check_cancelled();
    const timespec pause{0, 50'000'000};
    ::nanosleep(&pause, nullptr);
  }
}

void write_stream(const std::string& file, const io::OutputDestination& destination, const Parts& parts) {
  detail::Descriptor d(open_stream(file, destination));
  int error = write_all(d.fd, parts, destination.pipe && (::fcntl(d.fd, F_GETFL) & O_NONBLOCK) == 0);
  if (::close(std::exchange(d.fd, -1)) != 0 && error == 0) error = errno;
  if (error != 0) io::fail_output(file, error);
}

/// Writes a file or folder to disk; returns the error. File systems without this operation count as synchronised.
int sync_path(const std::filesystem::path& path) {
  const detail::Descriptor d(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (d.fd < 0) return errno == EACCES ? 0 : errno;
  if (::fsync(d.fd) == 0) return 0;
  return errno == EINVAL || errno == ENOTSUP || errno == ENOSYS || errno == EROFS ? 0 : errno;
}

std::string named(const std::vector<std::string>& files) {
  const std::vector<std::string> first(files.begin(),
                                       files.begin() + static_cast<std::ptrdiff_t>(std::min(files.size(), kMostNamed)));
  return fmt::format("{}{}", fmt::join(first, ", "),
                     files.size() > kMostNamed ? fmt::format(" and {} more", files.size() - kMostNamed) : "");
}

}  // namespace

struct OutputBatch::Files {
  struct Waiting {
    std::string file;  ///< name given by the caller
    std::filesystem::path target, staged;
  };

  void write(const std::string& file, const Parts& parts);
  void commit();
  void sync_files();
  void check_abandoned() const;
  std::filesystem::path folder_for(const std::filesystem::path& target, const std::string& file);

  std::vector<Waiting> waiting;
  std::vector<std::unique_ptr<io::StagingFolder>> folders;
  std::vector<std::string> placed;
  bool standard_output = false;
  bool abandoned = false;
};

namespace {

/// The batches of all threads; the mutex also guards the data that abandon_outputs() reads.
struct Registry {
  std::mutex mutex;
  std::vector<OutputBatch::Files*> batches;
};
Registry& registry() {
  static auto* const r = new Registry;  // never destroyed: a program may end while a thread writes
  return *r;
}

thread_local std::shared_ptr<OutputBatch::Files> current_batch;

}  // namespace

/// A name in the hidden folder beside the target.
std::filesystem::path OutputBatch::Files::folder_for(const std::filesystem::path& target, const std::string& file) {
  std::filesystem::path beside = target.parent_path();
  if (beside.empty()) beside = ".";
  const auto found = std::find_if(folders.begin(), folders.end(), [&](const auto& f) { return f->beside() == beside; });
  if (found != folders.end()) return (*found)->next();
  try {
    folders.push_back(std::make_unique<io::StagingFolder>(beside));
  } catch (const std::system_error& error) {
    io::fail_output(file, error.code().value());
  }
  return folders.back()->next();
}

void OutputBatch::Files::write(const std::string& file, const Parts& parts) {
  const io::OutputDestination destination = io::find_output_destination(file);
  if (destination.stream) {
    standard_output = standard_output || destination.descriptor == STDOUT_FILENO;
    return write_stream(file, destination, parts);
  }
  const auto same =
      std::find_if(waiting.begin(), waiting.end(), [&](const Waiting& w) { return w.target == destination.path; });
  const bool again = same != waiting.end();
  Waiting w{file, destination.path, again ? same->staged : std::filesystem::path()};
  if (again) waiting.erase(same);
  int fd = -1;
  {
    const std::lock_guard lock(registry().mutex);
    if (abandoned) throw Cancelled();
    if (!again) w.staged = folder_for(w.target, file);
    // Overwrites the blocks of the replaced file: a full disk may have no others.
    fd = ::open(w.staged.c_str(), O_WRONLY | O_CLOEXEC | (again ? 0 : O_CREAT | O_EXCL), 0666);
  }
  if (fd < 0) io::fail_output(file, errno);
  int error = 0;
  try {
    if (destination.exists)
      (void)!::fchmod(fd, destination.mode);  // keeps the old file's mode if the system permits it
    error = write_all(fd, parts);
    std::size_t size = 0;
    for (const std::string_view part : parts) size += part.size();
    if (error == 0 && again && ::ftruncate(fd, static_cast<off_t>(size)) != 0) error = errno;
  } catch (...) {
    ::close(fd);
    ::unlink(w.staged.c_str());
    throw;
  }
  if (::close(fd) != 0 && error == 0) error = errno;
  if (error != 0) {
    ::unlink(w.staged.c_str());
    io::fail_output(file, error);
  }
  waiting.push_back(std::move(w));
}

void OutputBatch::Files::check_abandoned() const {
  const std::lock_guard lock(registry().mutex);
  if (abandoned) throw Cancelled();
}

/// Drops files that cannot be written to disk: a second fsync would report success.
void OutputBatch::Files::sync_files() {
  if (waiting.empty()) return;
  std::vector<int> errors(waiting.size());
  {
    // These threads only wait for the disk, which writes many files in hardly more time than one.
    const ThreadScope waits(static_cast<int>(std::min(waiting.size(), kSyncsAtOnce)));
    parallel_for(0, waiting.size(), 1, [&](std::size_t i) { errors[i] = sync_path(waiting[i].staged); });
  }
  const auto first = std::find_if(errors.begin(), errors.end(), [](int error) { return error != 0; });
  if (first == errors.end()) return;
  check_abandoned();  // they no longer exist
  const std::string culprit = waiting[static_cast<std::size_t>(first - errors.begin())].file;
  std::vector<Waiting> there;
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    if (errors[i] == 0)
      there.push_back(std::move(waiting[i]));
    else
      ::unlink(waiting[i].staged.c_str());
  }
  waiting = std::move(there);
  io::fail_output(culprit, *first);
}

void OutputBatch::Files::commit() {
  sync_files();
  check_cancelled();
  std::vector<Waiting> all;
  std::vector<std::filesystem::path> parents;
  int failed = 0;
  const Waiting* culprit = nullptr;
  {
    const std::lock_guard lock(registry().mutex);
    if (abandoned) throw Cancelled();
    all = std::exchange(waiting, {});
    for (const Waiting& w : all) {
      if (::rename(w.staged.c_str(), w.target.c_str()) != 0) {
        failed = errno, culprit = &w;
        break;
      }
      placed.push_back(w.file);
      std::filesystem::path folder = w.target.parent_path();
      if (folder.empty()) folder = ".";
      if (std::find(parents.begin(), parents.end(), folder) == parents.end()) parents.push_back(std::move(folder));
    }
    folders.clear();
  }
  int lost = 0;
  for (const std::filesystem::path& folder : parents)
    if (const int error = sync_path(folder); error != 0) lost = error;
  if (culprit) {
    if (placed.empty()) io::fail_output(culprit->file, failed);
    try {
      io::fail_output(culprit->file, failed);
    } catch (const FileError& error) {
      const std::string cause = std::string(error.what()).substr(printable(culprit->file).size() + 2);
      throw FileError(culprit->file, cause + "; written are " + named(placed));
    }
  }
  if (lost != 0)
    throw FileError(all.front().file, fmt::format("is written, but the disk does not confirm its name ({})",
                                                  std::generic_category().message(lost)));
}

OutputBatch::OutputBatch() : files_(current_batch), within_another_(files_ != nullptr) {
  if (within_another_) return;
  files_ = current_batch = std::make_shared<Files>();
  const std::lock_guard lock(registry().mutex);
  registry().batches.push_back(files_.get());
}

OutputBatch::~OutputBatch() {
  if (within_another_) return;
  current_batch.reset();
  const std::lock_guard lock(registry().mutex);
  std::erase(registry().batches, files_.get());
  files_->folders.clear();
}

void OutputBatch::commit() {
  if (!within_another_) files_->commit();
}

std::uint64_t written_size(const std::string& file) {
  std::filesystem::path path = file;
  if (current_batch)
    for (const OutputBatch::Files::Waiting& w : current_batch->waiting)
      if (w.file == file) path = w.staged;
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  return unknown ? 0 : size;
}

std::size_t OutputBatch::waiting() const { return files_->waiting.size(); }
bool OutputBatch::used_standard_output() const { return files_->standard_output; }

std::vector<std::string> abandon_outputs() {
  const std::lock_guard lock(registry().mutex);
  std::vector<std::string> placed;
  for (OutputBatch::Files* files : registry().batches) {
    files->abandoned = true;
    for (const auto& folder : files->folders) folder->remove();
    placed.insert(placed.end(), files->placed.begin(), files->placed.end());
  }
  return placed;
}

void io::write_bytes(const std::string& file, const std::vector<std::string_view>& parts) {
  OutputBatch batch;
  current_batch->write(file, parts);
  batch.commit();
}

}  // namespace sansmesh::inline v1
