#include "sansmesh/points/cell_sort.h"

#include <algorithm>

namespace sansmesh::detail {

void sort_by_key(std::vector<KeyIndex>& items, int bits) {
  constexpr int kDigit = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kDigit;
  // Chunks large beside the histograms. A stable sort has one result, so they may be cut anyhow.
  constexpr std::size_t kChunk = 1 << 16;
  const std::size_t n = items.size(), chunks = (n + kChunk - 1) / kChunk;
  std::vector<KeyIndex> other(n);
  std::vector<std::uint32_t> starts(chunks * kBuckets);
  for (int shift = 0; shift < bits; shift += kDigit) {
    const auto digit = [shift](const KeyIndex& item) { return item.key >> shift & (kBuckets - 1); };
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      std::uint32_t* count = &starts[c * kBuckets];
      std::fill_n(count, kBuckets, 0u);
      for (std::size_t i = c * kChunk; i < std::min(n, (c + 1) * kChunk); ++i) ++count[digit(items[i])];
    });
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < kBuckets; ++b)
      for (std::size_t c = 0; c < chunks; ++c) {
        const std::uint32_t count = starts[c * kBuckets + b];
        starts[c * kBuckets + b] = sum;
        sum += count;
      }
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      std::uint32_t* place = &starts[c * kBuckets];
      for (std::size_t i = c * kChunk; i < std::min(n, (c + 1) * kChunk); ++i)
        other[place[digit(items[i])]++] = items[i];
    });
    items.swap(other);
  }
}

}  // namespace sansmesh::detail
