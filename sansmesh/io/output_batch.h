// Files that appear together or not at all.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// While it lives, whatever the calling thread writes by the writers of this room waits in a hidden folder beside its
/// place. commit() brings it onto the disk (fsync) and gives it its names; without it nothing of it is left. Files that
/// cannot wait (pipes, devices) are written at once. Within another batch it is a part of that, which alone commits.
/// A thread that writes without a batch has one for each call.
///
/// A second file of the same name takes the place of the first within the batch, in the same space on the disk if it is
/// no longer: what was kept can be said even on a full one.
class OutputBatch {
 public:
  OutputBatch();
  ~OutputBatch();
  OutputBatch(const OutputBatch&) = delete;
  OutputBatch& operator=(const OutputBatch&) = delete;

  /// Throws FileError where a file does not get onto the disk: then none has its name yet, and the others still wait,
  /// or the message says which have. Throws Cancelled (CancelScope) as long as none has its name.
  void commit();
  /// Files that wait.
  std::size_t waiting() const;
  /// Whether something was written to standard output, by whatever name (/dev/stdout).
  bool used_standard_output() const;

  struct Files;

 private:
  std::shared_ptr<Files> files_;
  bool within_another_ = false;
};

/// Bytes of a file that the calling thread has written, be it in place or waiting in a batch; 0 where that is not
/// known.
std::uint64_t written_size(const std::string& file);

/// For programs that end in the middle of their work: removes what waits in the batches of all threads, which cannot
/// write any more, and returns the names of the files that these batches had put in place already. Programs that are
/// killed leave hidden folders (.sansmesh-….tmp); the next one that writes there removes them.
std::vector<std::string> abandon_outputs();

}  // namespace sansmesh::inline v1
