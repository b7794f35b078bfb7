// The bytes of a file.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1::io {

/// Content of a file: mapped into memory, or decompressed if it is gzipped. Throws FileError if the file is missing, a
/// directory, empty, unreadable, damaged (gzip) or expands too far. Another process must not shorten the file while it
/// is mapped.
class FileContent {
 public:
  explicit FileContent(const std::string& file);
  ~FileContent();
  FileContent(const FileContent&) = delete;
  FileContent& operator=(const FileContent&) = delete;

  std::string_view bytes() const { return bytes_; }
  bool gzipped() const { return gzipped_; }

 private:
  void* map_ = nullptr;
  std::size_t map_size_ = 0;
  std::vector<char> owned_;
  std::string_view bytes_;
  bool gzipped_ = false;
};

}  // namespace sansmesh::inline v1::io
