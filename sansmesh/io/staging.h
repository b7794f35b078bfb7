// Hidden folder beside an output, where the output waits until it is complete.
#pragma once

#include <filesystem>

namespace sansmesh::inline v1::io {

/// The folder has a lock that ends with the process. The first one of a process in a folder removes the folders of
/// processes that no longer run (docs/decisions/0015-outputs-in-batches.md).
class StagingFolder {
 public:
  /// Throws std::system_error with the cause.
  explicit StagingFolder(const std::filesystem::path& beside);
  ~StagingFolder() { remove(); }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const std::filesystem::path& beside() const { return beside_; }
  /// An unused name in the folder.
  std::filesystem::path next();
  /// Removes the folder with its content. The second call does nothing.
  void remove();

 private:
  std::filesystem::path beside_, path_;
  int lock_ = -1;
  unsigned count_ = 0;
};

/// Removes the folders of killed processes and returns their number. Folders whose state is unknown stay.
std::size_t remove_stale_staging(const std::filesystem::path& folder);

}  // namespace sansmesh::inline v1::io
