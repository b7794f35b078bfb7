#include "sansmesh/io/laz/write_laz.h"

#include <cstring>

#include "sansmesh/core/parallel.h"
#include "sansmesh/io/laz/chunk_table.h"
#include "sansmesh/io/laz/layered_chunk.h"
#include "sansmesh/io/laz/pointwise_chunk.h"

namespace sansmesh::inline v1::io::laz {

std::vector<std::string> laz_chunks(const LazLayout& layout, const std::vector<std::size_t>& first,
                                    std::size_t position,
                                    const std::function<void(std::size_t, std::size_t, char*)>& put) {
  const std::size_t chunks = first.size() - 1;
  std::vector<std::string> parts(chunks + 2);
  parallel_for(0, chunks, 1, [&](std::size_t k) {
    const std::size_t points = first[k + 1] - first[k];
    std::string records(points * layout.record, '\0');
    put(first[k], first[k + 1], records.data());
    const auto encode = layout.layered ? encode_layered : encode_pointwise;
    encode(layout, records.data(), points, parts[k + 1]);
  });
  std::vector<Chunk> table;
  auto end = static_cast<std::int64_t>(position) + 8;
  for (std::size_t k = 0; k < chunks; ++k) {
    table.push_back({0, parts[k + 1].size(), first[k + 1] - first[k]});
    end += static_cast<std::int64_t>(parts[k + 1].size());
  }
  parts.front().assign(reinterpret_cast<const char*>(&end), sizeof end);
  parts.back() = chunk_table(table, layout.chunk_points == kVariableChunks);
  return parts;
}

std::vector<std::string> laz_points(const LazLayout& layout, std::size_t count, std::size_t position,
                                    const std::function<void(std::size_t, std::size_t, char*)>& put) {
  std::vector<std::size_t> first;
  for (std::size_t at = 0; at < count; at += layout.chunk_points) first.push_back(at);
  first.push_back(count);
  return laz_chunks(layout, first, position, put);
}

}  // namespace sansmesh::inline v1::io::laz
