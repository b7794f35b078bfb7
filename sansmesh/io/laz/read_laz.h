// Reads the point records of LAZ files.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sansmesh/io/laz/chunk_table.h"

namespace sansmesh::inline v1::io::laz {

/// Records of points; an array without initial values, which would cost a pass over memory.
struct RecordBuffer {
  std::unique_ptr<char[]> bytes;
  std::size_t size = 0;

  explicit RecordBuffer(std::size_t n = 0) : bytes(std::make_unique_for_overwrite<char[]>(n)), size(n) {}
  std::span<const char> span() const { return {bytes.get(), size}; }
};

/// The records of all points, or of those in the input's box, in the order of the file. Throws FileError if the file
/// is damaged.
RecordBuffer read_laz_records(const Input& in, const LasHeader& header);

/// The same for the given chunks. Of layered chunks without points in the box only the positions are decoded.
RecordBuffer read_chunks(const Input& in, const LasHeader& header, const LazLayout& layout,
                         const std::vector<Chunk>& chunks);

}  // namespace sansmesh::inline v1::io::laz
