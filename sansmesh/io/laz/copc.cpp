#include "sansmesh/io/laz/copc.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io::laz {
namespace {

constexpr std::size_t kInfoBytes = 160, kEntryBytes = 32;
constexpr std::int32_t kDeepest = 31;

/// An entry of the hierarchy: a node, or a page with the nodes below it.
struct Entry {
  std::int32_t level;
  std::array<std::int32_t, 3> cube;
  std::uint64_t begin;
  std::int32_t bytes, points;

  bool is_page() const { return points == -1; }
};

Entry load_entry(const char* p) {
  Entry e{
      load<std::int32_t>(p), {}, load<std::uint64_t>(p + 16), load<std::int32_t>(p + 24), load<std::int32_t>(p + 28)};
  for (std::size_t k = 0; k < 3; ++k) e.cube[k] = load<std::int32_t>(p + 4 + 4 * k);
  return e;
}

class CopcSearch {
 public:
  CopcSearch(const Input& in, const LasHeader& header, const CopcInfo& info)
      : in_(in), header_(header), info_(info), entries_left_(in.bytes.size() / kEntryBytes) {
    if (in.options.resolution) {
      last_level_ = 0;
      for (double spacing = info.spacing; spacing > *in.options.resolution && last_level_ < kDeepest; spacing /= 2)
        ++last_level_;
    }
    read_page(info.root, info.root_bytes);
    while (!pages_.empty()) {
      const Entry page = pages_.back();
      pages_.pop_back();
      read_page(page.begin, static_cast<std::uint64_t>(page.bytes));
    }
  }

  std::vector<Chunk> chunks() {
    std::sort(chunks_.begin(), chunks_.end(), [](const Chunk& a, const Chunk& b) { return a.begin < b.begin; });
    for (std::size_t k = 1; k < chunks_.size(); ++k)
      if (chunks_[k - 1].begin + chunks_[k - 1].bytes > chunks_[k].begin) fail("two nodes have the same bytes");
    return std::move(chunks_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { in_.fail("malformed COPC hierarchy: " + what); }

  void read_page(std::uint64_t begin, std::uint64_t bytes) {
    check_range(begin, bytes);
    if (!seen_.insert(begin).second) fail("a page refers to itself");
    for (std::uint64_t at = begin; at + kEntryBytes <= begin + bytes; at += kEntryBytes) {
      if (entries_left_ == 0) fail("its pages overlap");
      --entries_left_;
      add(load_entry(in_.bytes.data() + at));
    }
  }

  void check_range(std::uint64_t begin, std::uint64_t bytes) const {
    const std::uint64_t size = in_.bytes.size();
    if (begin > size || bytes > size - begin)
      fail(
          fmt::format("it refers to bytes from {} to {} of {}", grouped(begin), grouped(begin + bytes), grouped(size)));
  }

  void add(const Entry& e) {
    const bool valid = e.level >= 0 && e.level <= kDeepest && e.points >= -1 && e.bytes >= 0 &&
                       std::all_of(e.cube.begin(), e.cube.end(),
                                   [&](std::int32_t k) { return k >= 0 && (std::int64_t{k} >> e.level) == 0; });
    if (!valid) fail("a node is outside of the octree");
    if (e.points == 0 || e.level > last_level_ || !is_needed(e)) return;
    if (e.is_page()) return pages_.push_back(e);
    check_range(e.begin, static_cast<std::uint64_t>(e.bytes));
    if (static_cast<std::uint64_t>(e.points) / kMostPointsPerByte > static_cast<std::uint64_t>(e.bytes))
      fail(fmt::format("{} points cannot be in {} bytes", grouped(static_cast<std::uint64_t>(e.points)),
                       grouped(static_cast<std::uint64_t>(e.bytes))));
    chunks_.push_back(
        {static_cast<std::size_t>(e.begin), static_cast<std::size_t>(e.bytes), static_cast<std::size_t>(e.points)});
  }

  /// Whether the node's cube meets the box; rounded coordinates may be a step outside of their cube.
  bool is_needed(const Entry& e) const {
    if (!in_.options.box) return true;
    const double size = std::ldexp(2 * info_.half_size, -e.level);
    for (std::size_t k = 0; k < 3; ++k) {
      const double step = std::abs(header_.scale[k]), lower = info_.center[k] - info_.half_size + size * e.cube[k];
      if (lower - step > in_.options.box->upper[k] || lower + size + step < in_.options.box->lower[k]) return false;
    }
    return true;
  }

  const Input& in_;
  const LasHeader& header_;
  const CopcInfo& info_;
  std::size_t entries_left_;
  std::int32_t last_level_ = kDeepest;
  std::vector<Entry> pages_;
  std::set<std::uint64_t> seen_;
  std::vector<Chunk> chunks_;
};

}  // namespace

std::optional<CopcInfo> find_copc_info(const LasHeader& header) {
  const LasVlr* const vlr = header.find("copc", 1);
  if (!vlr || vlr->payload.size() < kInfoBytes || !header.wide()) return std::nullopt;
  const char* const p = vlr->payload.data();
  CopcInfo info;
  for (std::size_t k = 0; k < 3; ++k) info.center[k] = load<double>(p + 8 * k);
  info.half_size = load<double>(p + 24), info.spacing = load<double>(p + 32);
  info.root = load<std::uint64_t>(p + 40), info.root_bytes = load<std::uint64_t>(p + 48);
  const bool sound = is_finite(info.center) && std::isfinite(info.half_size) && info.half_size > 0 &&
                     std::isfinite(info.spacing) && info.spacing > 0;
  return sound ? std::optional(info) : std::nullopt;
}

std::vector<Chunk> find_copc_chunks(const Input& in, const LasHeader& header, const CopcInfo& info) {
  return CopcSearch(in, header, info).chunks();
}

}  // namespace sansmesh::inline v1::io::laz
