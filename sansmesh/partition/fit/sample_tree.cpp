#include "sansmesh/partition/fit/sample_tree.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// A key as two halves, for a size of twelve bytes: sorting needs two per sample.
struct Item {
  std::uint32_t low, high, index;
  std::uint64_t key() const { return std::uint64_t{high} << 32 | low; }
};

/// Number of samples that a thread sorts, counts or fills at a time; large enough to keep all histograms small.
constexpr std::size_t kChunk = std::size_t{1} << 18;
std::size_t chunks_of(std::size_t n) { return (n + kChunk - 1) / kChunk; }

/// Least significant digit first: stable, so samples of one cell keep the caller's order and the result is unique.
void radix_sort(std::vector<Item>& items, int bits) {
  constexpr int kDigit = 11;
  constexpr std::size_t kDigits = std::size_t{1} << kDigit;
  constexpr std::uint64_t kMask = kDigits - 1;
  const std::size_t n = items.size(), chunks = chunks_of(n);
  std::vector<Item> other(n);
  std::vector<std::uint32_t> offsets(chunks * kDigits);
  for (int shift = 0; shift < bits; shift += kDigit) {
    const auto each = [&](std::size_t chunk, auto&& treat) {
      std::uint32_t* const at = offsets.data() + chunk * kDigits;
      for (std::size_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i)
        treat(items[i], at[items[i].key() >> shift & kMask]);
    };
    std::fill(offsets.begin(), offsets.end(), 0u);
    parallel_for(0, chunks, 1, [&](std::size_t c) { each(c, [](const Item&, std::uint32_t& count) { ++count; }); });
    std::uint32_t sum = 0;
    for (std::size_t d = 0; d < kDigits; ++d)
      for (std::size_t c = 0; c < chunks; ++c) {
        const std::uint32_t count = offsets[c * kDigits + d];
        offsets[c * kDigits + d] = sum;
        sum += count;
      }
    parallel_for(0, chunks, 1,
                 [&](std::size_t c) { each(c, [&](const Item& item, std::uint32_t& next) { other[next++] = item; }); });
    items.swap(other);
  }
}

/// Cells of each level that begin in a chunk of the samples.
struct Runs {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max(), kLevels = SampleTree::kMaxDepth + 1;
  std::array<std::size_t, kLevels> first, last;  ///< samples at which the first and the last begin
  std::array<std::uint64_t, kLevels> squares{};  ///< Σ count² of those that also end here

  Runs() { first.fill(kNone), last.fill(kNone); }
  void begin(std::size_t level, std::size_t at) {
    if (first[level] == kNone)
      first[level] = at;
    else
      squares[level] += std::uint64_t{at - last[level]} * (at - last[level]);
    last[level] = at;
  }
};

}  // namespace

SampleTree::SampleTree(std::vector<Vec3f> positions, std::vector<Vec3f> normals, const Vec3f& lower, float edge,
                       int depth)
    : lower_(lower), edge_(edge), sort_depth_(depth), positions_(std::move(positions)), normals_(std::move(normals)) {
  if (positions_.size() > kMostSamples)
    throw DataError("partition of unity: " + std::to_string(positions_.size()) + " samples; at most " +
                    std::to_string(kMostSamples) + " are supported");
  sort();
}

std::uint64_t SampleTree::code_of(const Vec3f& at) const {
  const float scale = static_cast<float>(1u << sort_depth_) / edge_;
  const std::uint32_t top = (1u << sort_depth_) - 1;
  const Vec3f p = (at - lower_) * scale;
  const auto clamp = [&](float v) { return index_in<std::uint32_t>(v, 0, top); };
  return morton_code(clamp(p.x), clamp(p.y), clamp(p.z));
}

void SampleTree::sort() {
  const std::size_t n = positions_.size();
  std::vector<Item> items(n);
  parallel_for(0, n, 16384, [&](std::size_t i) {
    const std::uint64_t code = code_of(positions_[i]);
    items[i] = {static_cast<std::uint32_t>(code), static_cast<std::uint32_t>(code >> 32),
                static_cast<std::uint32_t>(i)};
  });
  radix_sort(items, 3 * sort_depth_);
  const auto rearrange = [&](std::vector<Vec3f>& values) {  // one array at a time, so that there is never a copy of all
    if (values.empty()) return;
    std::vector<Vec3f> sorted(n);
    parallel_for(0, n, 16384, [&](std::size_t i) { sorted[i] = values[items[i].index]; });
    values = std::move(sorted);
  };
  rearrange(positions_);
  rearrange(normals_);
  order_.resize(n);
  parallel_for(0, n, 16384, [&](std::size_t i) { order_[i] = items[i].index; });
}

/// First level on which two positions along the curve are in different cells; beyond the depth of the sort if none.
int SampleTree::first_level_apart(std::uint64_t a, std::uint64_t b) const {
  return a == b ? sort_depth_ + 1 : sort_depth_ - (63 - std::countl_zero(a ^ b)) / 3;
}

/// Calls seen(sample, code, level) for every sample of a chunk that begins a cell, on that level and all below.
template <class Seen>
void SampleTree::for_each_start(std::size_t chunk, int deepest, Seen&& seen) const {
  const std::size_t first = chunk * kChunk, last = std::min(positions_.size(), first + kChunk);
  std::uint64_t before = first > 0 ? code_of(positions_[first - 1]) : 0;
  for (std::size_t i = first; i < last; ++i) {
    const std::uint64_t code = code_of(positions_[i]);
    const int level = i > 0 ? first_level_apart(before, code) : 0;
    before = code;
    if (level <= deepest) seen(i, code, level);
  }
}

std::vector<double> SampleTree::company() const {
  const std::size_t n = positions_.size(), levels = static_cast<std::size_t>(sort_depth_) + 1;
  std::vector<Runs> parts(chunks_of(n));
  parallel_for(0, parts.size(), 1, [&](std::size_t c) {
    for_each_start(c, sort_depth_, [&](std::size_t i, std::uint64_t, int level) {
      for (auto l = static_cast<std::size_t>(level); l < levels; ++l) parts[c].begin(l, i);
    });
  });
  std::vector<double> result(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    Runs whole;
    for (const Runs& part : parts) {
      if (part.first[l] == Runs::kNone) continue;
      whole.begin(l, part.first[l]);
      whole.squares[l] += part.squares[l];
      whole.last[l] = part.last[l];
    }
    if (n > 0) whole.begin(l, n);
    result[l] = n > 0 ? static_cast<double>(whole.squares[l]) / static_cast<double>(n) : 0;
  }
  return result;
}

void SampleTree::build_levels(int deepest) {
  const std::size_t n = positions_.size(), levels = static_cast<std::size_t>(deepest) + 1, chunks = chunks_of(n);
  levels_.assign(levels, {});
  // Start of the cells of each chunk in the tables of each level.
  std::vector<std::array<std::uint32_t, kMaxDepth + 2>> offsets(chunks + 1);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    for_each_start(c, deepest, [&](std::size_t, std::uint64_t, int level) {
      for (auto l = static_cast<std::size_t>(level); l < levels; ++l) ++offsets[c + 1][l];
    });
  });
  for (std::size_t c = 0; c < chunks; ++c)
    for (std::size_t l = 0; l < levels; ++l) offsets[c + 1][l] += offsets[c][l];
  for (std::size_t l = 0; l < levels; ++l) {
    const std::size_t cells = offsets[chunks][l];
    levels_[l].code.resize(cells);
    levels_[l].begin.resize(cells + 1);
    levels_[l].begin[cells] = static_cast<std::uint32_t>(n);
    if (l + 1 == levels) continue;
    levels_[l].child.resize(cells + 1);
    levels_[l].child[cells] = offsets[chunks][l + 1];
  }
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    auto next = offsets[c];
    for_each_start(c, deepest, [&](std::size_t i, std::uint64_t code, int level) {
      for (auto l = static_cast<std::size_t>(level); l < levels; ++l) {
        const std::uint32_t cell = next[l]++;
        levels_[l].code[cell] = code >> (3 * (static_cast<std::size_t>(sort_depth_) - l));
        levels_[l].begin[cell] = static_cast<std::uint32_t>(i);
        if (l + 1 < levels) levels_[l].child[cell] = next[l + 1];
      }
    });
  });
}

std::int64_t SampleTree::find(int l, std::uint64_t code) const {
  if (l > depth()) return -1;
  const auto& codes = level(l).code;
  const auto it = std::lower_bound(codes.begin(), codes.end(), code);
  return it != codes.end() && *it == code ? it - codes.begin() : -1;
}

}  // namespace sansmesh::inline v1
