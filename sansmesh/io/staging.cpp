#include "sansmesh/io/staging.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <string>

#include <atomic>
#include <ctime>
#include <fstream>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

namespace sansmesh::inline v1::io {
namespace {

constexpr std::string_view kStagingBegin = ".sansmesh-", kStagingEnd = ".tmp";
constexpr std::time_t kForeignAge = 24 * 60 * 60;  // seconds after which folders of other machines count as stale

/// Identifies the machine since its start: only there do locks reliably show which processes run. Empty: unknown.
const std::string& this_boot() {
  static const std::string boot = [] {
    std::string id;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
    std::erase(id, '-');
    return id.substr(0, 12);
  }();
  return boot;
}

std::string staging_prefix() { return fmt::format("{}{}-", kStagingBegin, this_boot().empty() ? "x" : this_boot()); }

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

/// Removes a staging folder with its files, locked by this process.
bool remove_folder(int fd, const std::filesystem::path& path) {
  std::error_code failed;
  std::vector<std::string> names;
  for (auto entry = std::filesystem::directory_iterator(path, failed);
       !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed))
    names.push_back(entry->path().filename().string());
  for (const std::string& name : names) ::unlinkat(fd, name.c_str(), 0);
  return ::rmdir(path.c_str()) == 0;
}

/// Opens a staging folder and locks it; -1 if it has another owner or is in use.
int take_over(const std::filesystem::path& path, struct stat& info) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) return -1;
  struct stat named {};
  // The lock may be on a folder that was removed meanwhile.
  if (::fstat(fd, &info) == 0 && info.st_uid == ::geteuid() && ::flock(fd, LOCK_EX | LOCK_NB) == 0 &&
      ::lstat(path.c_str(), &named) == 0 && same_file(info, named))
    return fd;
  ::close(fd);
  return -1;
}

/// Once per folder and process: later outputs need not check again.
void clean_once(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::tuple<std::string, dev_t, ino_t>> cleaned;
  struct stat info {};
  if (::stat(folder.c_str(), &info) != 0) return;
  {
    const std::lock_guard lock(mutex);
    if (!cleaned.insert({folder.string(), info.st_dev, info.st_ino}).second) return;
  }
  remove_stale_staging(folder);
}

}  // namespace

StagingFolder::StagingFolder(const std::filesystem::path& beside) : beside_(beside) {
  static std::atomic<unsigned> counter{0};
  clean_once(beside);
  for (int attempt = 0; attempt < 100; ++attempt) {
    // The leading dot hides it from listings and globs.
    path_ = beside / fmt::format("{}{}-{}{}", staging_prefix(), ::getpid(), counter.fetch_add(1), kStagingEnd);
    if (::mkdir(path_.c_str(), 0777) != 0) {
      if (errno == EEXIST) continue;
      throw std::system_error(errno, std::generic_category());
    }
    lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock_ < 0 && errno != ENOENT) {
      const int error = errno;
      ::rmdir(path_.c_str());
      throw std::system_error(error, std::generic_category());
    }
    // File systems without locks: proceeds without one, because no process can take over there.
    const bool locked = lock_ >= 0 && (::flock(lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK);
    struct stat mine {
    }, named{};
    if (locked && ::fstat(lock_, &mine) == 0 && ::lstat(path_.c_str(), &named) == 0 && same_file(mine, named)) return;
    // Another process removed it as stale before it was locked.
    if (lock_ >= 0) ::close(std::exchange(lock_, -1));
  }
  throw std::system_error(EEXIST, std::generic_category());
}

std::filesystem::path StagingFolder::next() { return path_ / std::to_string(count_++); }

void StagingFolder::remove() {
  if (lock_ < 0) return;
  remove_folder(lock_, path_);
  ::close(std::exchange(lock_, -1));
}

std::size_t remove_stale_staging(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  std::error_code failed;
  for (auto entry = std::filesystem::directory_iterator(folder, failed);
       !failed && entry != std::filesystem::directory_iterator(); entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(kStagingBegin) && name.ends_with(kStagingEnd)) found.push_back(entry->path());
  }
  std::size_t removed = 0;
  for (const std::filesystem::path& path : found) {
    struct stat info {};
    const int fd = take_over(path, info);
    if (fd < 0) continue;
    const bool ours = !this_boot().empty() && path.filename().string().starts_with(staging_prefix());
    if (ours || info.st_mtime < std::time(nullptr) - kForeignAge) removed += remove_folder(fd, path) ? 1 : 0;
    ::close(fd);
  }
  return removed;
}

}  // namespace sansmesh::inline v1::io
