// Places of the chunks in a LAZ file.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/io/laz/laz_layout.h"

namespace sansmesh::inline v1::io::laz {

struct Chunk {
  std::size_t begin = 0, bytes = 0;  ///< in the file
  std::size_t points = 0;
};

/// A compressed point has at least 1/1000 byte, by the least probability that the models give other symbols.
inline constexpr std::uint64_t kMostPointsPerByte = 1000;

/// The chunks of all `header.count` points, in order. Files without a table, whose writer was interrupted, have one
/// chunk here that contains all that follow each other: see `is_sequence`. Throws FileError if the table is malformed
/// or promises more points than the bytes can hold.
struct ChunkTable {
  std::vector<Chunk> chunks;
  bool is_sequence = false;  ///< one entry: chunks of layout.chunk_points points whose lengths are unknown
};
ChunkTable read_chunk_table(const Input& in, const LasHeader& header, const LazLayout& layout);

/// The table of chunks that follow each other. `variable`: with their numbers of points, otherwise only their sizes.
std::string chunk_table(const std::vector<Chunk>& chunks, bool variable);

}  // namespace sansmesh::inline v1::io::laz
