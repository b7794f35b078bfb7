#include "sansmesh/io/laz/write_laz.h"

#include <algorithm>
#include <cstring>

#include "sansmesh/core/parallel.h"
#include "sansmesh/io/laz/chunk_table.h"
#include "sansmesh/io/laz/layered_chunk.h"
#include "sansmesh/io/laz/pointwise_chunk.h"

namespace sansmesh::inline v1::io::laz {

std::vector<std::string> laz_points(const LazLayout& layout, std::size_t count, std::size_t position,
                                    const std::function<void(std::size_t, std::size_t, char*)>& put) {
  const std::size_t chunks = (count + layout.chunk_points - 1) / layout.chunk_points;
  std::vector<std::string> parts(chunks + 2);
  parallel_for(0, chunks, 1, [&](std::size_t k) {
    const std::size_t first = k * layout.chunk_points, last = std::min(first + layout.chunk_points, count);
    std::string records((last - first) * layout.record, '\0');
    put(first, last, records.data());
    const auto encode = layout.layered ? encode_layered : encode_pointwise;
    encode(layout, records.data(), last - first, parts[k + 1]);
  });
  std::vector<std::size_t> bytes(chunks);
  for (std::size_t k = 0; k < chunks; ++k) bytes[k] = parts[k + 1].size();
  std::int64_t table = static_cast<std::int64_t>(position) + 8;
  for (const std::size_t b : bytes) table += static_cast<std::int64_t>(b);
  parts.front().assign(reinterpret_cast<const char*>(&table), sizeof table);
  parts.back() = chunk_table(bytes);
  return parts;
}

}  // namespace sansmesh::inline v1::io::laz
