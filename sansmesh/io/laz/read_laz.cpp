#include "sansmesh/io/laz/read_laz.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/laz/copc.h"
#include "sansmesh/io/laz/layered_chunk.h"
#include "sansmesh/io/laz/pointwise_chunk.h"
#include "sansmesh/io/points/las_points.h"

namespace sansmesh::inline v1::io::laz {
namespace {

/// Decodes a chunk of `count` points at the beginning of `bytes`. Returns its length, or 0 if it is damaged.
std::size_t decode_chunk(const LazLayout& layout, std::string_view bytes, std::size_t count, char* records) {
  if (!layout.layered) return decode_pointwise(layout, bytes, count, records);
  LayeredChunk chunk(layout, bytes, count, records);
  return chunk.decode_positions() && chunk.decode_rest() ? chunk.length() : 0;
}

/// Appends the records of a chunk that are in the box to `kept`. False if the chunk is damaged.
bool decode_box(const LasHeader& header, const LazLayout& layout, const Box3& box, std::string_view bytes,
                std::size_t count, std::vector<char>& kept) {
  const RecordBuffer all(count * layout.record);
  if (layout.layered) {
    LayeredChunk chunk(layout, bytes, count, all.bytes.get());
    if (!chunk.decode_positions()) return false;
    if (!any_record_in(header, box, all.span())) return true;
    if (!chunk.decode_rest()) return false;
  } else if (decode_pointwise(layout, bytes, count, all.bytes.get()) == 0) {
    return false;
  }
  keep_records_in(header, box, all.span(), kept);
  return true;
}

[[noreturn]] void fail_chunk(const Input& in, std::size_t chunk, std::size_t chunks) {
  in.fail(fmt::format("chunk {} of {} is damaged", grouped(chunk + 1), grouped(chunks)));
}

/// Fails for the first damaged chunk, so that the message does not depend on the number of threads.
void check_chunks(const Input& in, const std::vector<std::uint8_t>& damaged) {
  const auto first = std::find(damaged.begin(), damaged.end(), std::uint8_t{1});
  if (first != damaged.end()) fail_chunk(in, static_cast<std::size_t>(first - damaged.begin()), damaged.size());
}

/// Fails if a damaged header promises far more records than files of this size hold.
void check_size(const Input& in, std::uint64_t points, std::size_t record) {
  constexpr std::uint64_t usual = std::uint64_t{1} << 30, most_per_byte = kMostPointsPerByte;
  if (points > std::max(usual, most_per_byte * in.bytes.size()) / record)
    in.fail(
        fmt::format("malformed LAZ file: {} points cannot be in {} bytes", grouped(points), grouped(in.bytes.size())));
}

/// Memory for records that a file may have.
RecordBuffer buffer_of(const Input& in, std::uint64_t points, std::size_t record) {
  check_size(in, points, record);
  return RecordBuffer(static_cast<std::size_t>(points) * record);
}

/// The records in the box, joined in order.
RecordBuffer joined(const std::vector<std::vector<char>>& parts) {
  std::size_t size = 0;
  for (const std::vector<char>& part : parts) size += part.size();
  RecordBuffer all(size);
  char* p = all.bytes.get();
  for (const std::vector<char>& part : parts) p = std::copy(part.begin(), part.end(), p);
  return all;
}

/// Chunks without a table, each of which begins where the previous one ends.
RecordBuffer read_sequence(const Input& in, const LasHeader& header, const LazLayout& layout, const Chunk& all) {
  RecordBuffer records = buffer_of(in, all.points, layout.record);
  const std::size_t chunks = (all.points + layout.chunk_points - 1) / layout.chunk_points;
  std::string_view bytes = in.bytes.substr(all.begin, all.bytes);
  for (std::size_t k = 0; k < chunks; ++k) {
    const std::size_t first = k * layout.chunk_points;
    const std::size_t count = std::min<std::size_t>(layout.chunk_points, all.points - first);
    const std::size_t length = decode_chunk(layout, bytes, count, records.bytes.get() + first * layout.record);
    if (length == 0) fail_chunk(in, k, chunks);
    bytes.remove_prefix(std::min(length, bytes.size()));
  }
  if (!in.options.box) return records;
  std::vector<std::vector<char>> kept(1);
  keep_records_in(header, *in.options.box, records.span(), kept[0]);
  return joined(kept);
}

}  // namespace

RecordBuffer read_chunks(const Input& in, const LasHeader& header, const LazLayout& layout,
                         const std::vector<Chunk>& chunks) {
  std::vector<std::size_t> first(chunks.size() + 1);
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    first[k + 1] = first[k] + chunks[k].points;
    check_size(in, first[k + 1], layout.record);
  }
  std::vector<std::uint8_t> damaged(chunks.size());
  const auto bytes_of = [&](const Chunk& chunk) { return in.bytes.substr(chunk.begin, chunk.bytes); };
  if (in.options.box) {
    std::vector<std::vector<char>> kept(chunks.size());
    parallel_for(0, chunks.size(), 1, [&](std::size_t k) {
      damaged[k] = !decode_box(header, layout, *in.options.box, bytes_of(chunks[k]), chunks[k].points, kept[k]);
    });
    check_chunks(in, damaged);
    return joined(kept);
  }
  RecordBuffer records(first.back() * layout.record);
  parallel_for(0, chunks.size(), 1, [&](std::size_t k) {
    char* const out = records.bytes.get() + first[k] * layout.record;
    damaged[k] = decode_chunk(layout, bytes_of(chunks[k]), chunks[k].points, out) == 0;
  });
  check_chunks(in, damaged);
  return records;
}

RecordBuffer read_laz_records(const Input& in, const LasHeader& header) {
  const LazLayout layout = read_laz_layout(in, header);
  check_size(in, header.count, header.record);
  if (const auto copc = find_copc_info(header)) {
    in.report.format = "COPC, " + in.report.format;
    if (in.options.box || in.options.resolution)
      return read_chunks(in, header, layout, find_copc_chunks(in, header, *copc));
  } else {
    in.warn_without_levels();
  }
  const ChunkTable table = read_chunk_table(in, header, layout);
  if (table.is_sequence) return read_sequence(in, header, layout, table.chunks[0]);
  return read_chunks(in, header, layout, table.chunks);
}

}  // namespace sansmesh::inline v1::io::laz
