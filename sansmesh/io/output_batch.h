// Output files that appear together or not at all.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// While a batch exists, all files that the calling thread writes with this library wait in a hidden folder beside
/// their destination. commit() writes them to disk (fsync) and renames them; without it they are discarded. Files that
/// cannot wait (pipes, devices) are written immediately. A nested batch is part of the outer one, which alone commits.
/// A thread without a batch commits each call separately.
///
/// A second file of the same name replaces the first within the batch, in the same disk space if it is not longer. So a
/// report of saved results fits even on a full disk.
class OutputBatch {
 public:
  OutputBatch();
  ~OutputBatch();
  OutputBatch(const OutputBatch&) = delete;
  OutputBatch& operator=(const OutputBatch&) = delete;

  /// Throws FileError if a file cannot be written to disk. Then either no file has its name yet and all still wait, or
  /// the message lists those that have. Throws Cancelled (CancelScope) while no file has its name.
  void commit();
  /// Number of waiting files.
  std::size_t waiting() const;
  /// Whether standard output was written, by any name (/dev/stdout).
  bool used_standard_output() const;

  struct Files;

 private:
  std::shared_ptr<Files> files_;
  bool within_another_ = false;
};

/// Size in bytes of a file that the calling thread has written, finished or waiting in a batch; 0 if unknown.
std::uint64_t written_size(const std::string& file);

/// For programs that end early: removes the waiting files of all threads, which cannot write any more, and returns the
/// names of the files that these batches have already finished. Killed programs leave hidden folders (.sansmesh-….tmp);
/// the next one that writes there removes them.
std::vector<std::string> abandon_outputs();

}  // namespace sansmesh::inline v1
