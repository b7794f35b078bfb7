#include "sansmesh/io/laz/chunk_table.h"

#include <fmt/core.h>

#include <cstring>
#include <memory>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/laz/integer_model.h"

namespace sansmesh::inline v1::io::laz {
namespace {

using TableModel = IntegerModel<32, 2>;

/// Position of the table; 0 if its writer was interrupted before.
std::size_t find_table(const Input& in, std::size_t begin) {
  auto at = load<std::int64_t>(in.bytes.data() + begin);
  // Writers to a pipe store the position at the end of the file.
  if (at == -1) at = load<std::int64_t>(in.bytes.data() + in.bytes.size() - 8);
  const auto size = static_cast<std::int64_t>(in.bytes.size());
  if (at == static_cast<std::int64_t>(begin)) return 0;
  if (at < static_cast<std::int64_t>(begin) + 8) in.fail("malformed LAZ file: its chunk table is before the points");
  if (at > size - 8) in.fail_short(static_cast<std::uint64_t>(at) + 8, in.bytes.size(), true);
  return static_cast<std::size_t>(at);
}

std::vector<Chunk> decode_table(const Input& in, const LasHeader& header, const LazLayout& layout, std::size_t table) {
  const char* const p = in.bytes.data() + table;
  const std::size_t count = load<std::uint32_t>(p + 4);
  const std::size_t begin = header.begin + 8;
  if (load<std::uint32_t>(p) != 0 || count > (table - begin) / layout.record)
    in.fail("malformed LAZ file: its chunk table is damaged");
  ArithmeticDecoder decoder(in.bytes.substr(table + 8));
  const auto model = std::make_unique<TableModel>();
  std::vector<Chunk> chunks;
  chunks.reserve(count);
  std::size_t at = begin;
  std::int32_t points = 0, bytes = 0;
  std::uint64_t left = header.count;
  for (std::size_t k = 0; k < count && left > 0; ++k) {
    if (layout.chunk_points == kVariableChunks) points = model->code(decoder, points, 0, 0);
    bytes = model->code(decoder, bytes, 0, 1);
    const std::size_t length = static_cast<std::uint32_t>(bytes);
    const std::size_t of_chunk =
        layout.chunk_points == kVariableChunks ? static_cast<std::uint32_t>(points) : layout.chunk_points;
    const std::size_t least = of_chunk > 0 ? layout.record : 0;
    if (decoder.damaged() || length < least || length > table - at)
      in.fail("malformed LAZ file: its chunk table is damaged");
    const std::uint64_t used = std::min<std::uint64_t>(left, of_chunk);
    if (used > 0) chunks.push_back({at, length, static_cast<std::size_t>(used)});
    at += length, left -= used;
  }
  if (left > 0)
    in.fail(fmt::format("announces {} points, but its chunks hold {}", grouped(header.count),
                        grouped(header.count - left)));
  return chunks;
}

}  // namespace

ChunkTable read_chunk_table(const Input& in, const LasHeader& header, const LazLayout& layout) {
  const std::size_t size = in.bytes.size();
  ChunkTable table;
  if (size - header.begin < layout.record + 8) in.fail_short(header.begin + layout.record + 8, size, true);
  if (!layout.chunked) {
    table.chunks = {{header.begin, size - header.begin, static_cast<std::size_t>(header.count)}};
  } else if (const std::size_t at = find_table(in, header.begin); at > 0) {
    table.chunks = decode_table(in, header, layout, at);
  } else {
    if (layout.chunk_points == kVariableChunks)
      in.fail("its writer was interrupted before it wrote the chunk table, without which the file is unreadable");
    in.warn("its writer was interrupted before it wrote the chunk table");
    table.is_sequence = true;
    table.chunks = {{header.begin + 8, size - header.begin - 8, static_cast<std::size_t>(header.count)}};
  }
  for (const Chunk& chunk : table.chunks)
    if (chunk.points / kMostPointsPerByte > chunk.bytes)
      in.fail(fmt::format("malformed LAZ file: {} points cannot be in {} bytes", grouped(chunk.points),
                          grouped(chunk.bytes)));
  return table;
}

std::string chunk_table(const std::vector<Chunk>& chunks, bool variable) {
  std::string s(8, '\0');
  const auto count = static_cast<std::uint32_t>(chunks.size());
  std::memcpy(s.data() + 4, &count, sizeof count);
  ArithmeticEncoder encoder;
  const auto model = std::make_unique<TableModel>();
  std::int32_t points = 0, bytes = 0;
  for (const Chunk& chunk : chunks) {
    if (variable) points = model->code(encoder, points, static_cast<std::int32_t>(chunk.points), 0);
    bytes = model->code(encoder, bytes, static_cast<std::int32_t>(chunk.bytes), 1);
  }
  return s + encoder.finish();
}

}  // namespace sansmesh::inline v1::io::laz
