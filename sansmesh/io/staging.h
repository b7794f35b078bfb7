// A hidden folder beside an output, in which it waits until it is whole.
#pragma once

#include <filesystem>
#include <string>

namespace sansmesh::inline v1::io {

/// Made with a lock that ends with the process. The first of a process in a folder removes those whose processes are no
/// more (docs/decisions/0015-outputs-in-batches.md).
class StagingFolder {
 public:
  /// Throws std::system_error with the cause.
  explicit StagingFolder(const std::filesystem::path& beside);
  ~StagingFolder() { remove(); }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const std::filesystem::path& beside() const { return beside_; }
  /// A name in it that nobody has.
  std::filesystem::path next();
  /// With all that is in it. Nothing happens the second time.
  void remove();

 private:
  std::filesystem::path beside_, path_;
  int lock_ = -1;
  unsigned count_ = 0;
};

/// Removes those of killed processes; returns how many. What cannot be judged stays.
std::size_t remove_stale_staging(const std::filesystem::path& folder);

}  // namespace sansmesh::inline v1::io
