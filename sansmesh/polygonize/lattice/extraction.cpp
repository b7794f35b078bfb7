#include "sansmesh/polygonize/lattice/extraction.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/field/field_hints.h"

namespace sansmesh::inline v1 {
namespace {

/// Layers of blocks around a region in which the border of the mesh is noticeable.
constexpr int kLayers = 4;

/// Atomic minimum.
void lower_to(std::uint32_t& value, std::uint32_t bound) {
  const std::atomic_ref<std::uint32_t> least(value);
  std::uint32_t old = least.load(std::memory_order_relaxed);
  while (bound < old && !least.compare_exchange_weak(old, bound, std::memory_order_relaxed)) {
  }
}

}  // namespace

void Extraction::add_blocks(const std::vector<std::uint32_t>& blocks) {
  // Chunks of blocks first number their own vertices in parallel. The sequential part then processes each vertex once
  // per chunk instead of once per adjacent block.
  constexpr std::size_t kChunk = 2048;
  const std::size_t old = active_.size(), chunks = (blocks.size() + kChunk - 1) / kChunk;
  std::vector<BlockRefinement> refinement(blocks.size());
  parallel_for(0, blocks.size(), 1024, [&](std::size_t i) { refinement[i] = refinement_of(tree_, blocks[i]); });
  std::size_t end = numbers_.size();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const BlockPattern& pattern = patterns_.pattern(refinement[i]);
    active_.push_back({blocks[i], &pattern, end});
    end += pattern.slots.size();
  }
  numbers_.resize(end);
  std::vector<std::vector<LatticePoint>> met(chunks);
  const auto chunk_of = [&](std::size_t c) {
    return std::span(active_).subspan(old + c * kChunk, std::min(kChunk, blocks.size() - c * kChunk));
  };
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    LatticeNumbering own;
    for (const ActiveBlock& a : chunk_of(c))
      for (std::size_t s = 0; s < a.pattern->slots.size(); ++s)
        numbers_[a.first + s] = own.number(slot_point(tree_, a.block, a.pattern->slots[s]));
    met[c] = own.points();
  });
  std::vector<std::vector<std::uint32_t>> number(chunks);
  for (std::size_t c = 0; c < chunks; ++c) {
    number[c].reserve(met[c].size());
    for (const LatticePoint& p : met[c]) number[c].push_back(numbering_.number(p));
    met[c] = {};
  }
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    for (const ActiveBlock& a : chunk_of(c))
      for (std::size_t s = 0; s < a.pattern->slots.size(); ++s)
        numbers_[a.first + s] = number[c][numbers_[a.first + s]];
  });
}

void Extraction::put_in_order() {
  constexpr std::size_t kChunk = 1024;
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> at(tree_.size(), kNone);
  parallel_for(0, active_.size(), 4096, [&](std::size_t i) {
    if (crosses(active_[i])) at[active_[i].block] = static_cast<std::uint32_t>(i);
  });
  std::vector<ActiveBlock> ordered;
  std::vector<std::size_t> from;  // previous offset of its vertices
  std::size_t end = 0;
  for (const std::uint32_t b : tree_.leaves()) {
    if (at[b] == kNone) continue;
    const ActiveBlock& a = active_[at[b]];
    from.push_back(a.first);
    ordered.push_back({a.block, a.pattern, end});
    end += a.pattern->slots.size();
  }
  at = {};
  active_ = std::move(ordered);

  // Each vertex belongs to the first chunk that has it; chunks number their vertices in order of occurrence.
  const std::size_t n = values_.size(), chunks = (active_.size() + kChunk - 1) / kChunk;
  const auto each_number = [&](std::size_t c, auto&& visit) {
    for (std::size_t i = c * kChunk; i < std::min(active_.size(), (c + 1) * kChunk); ++i)
      for (std::size_t s = 0; s < active_[i].pattern->slots.size(); ++s)
        visit(numbers_[from[i] + s], active_[i].first + s);
  };
  std::vector<std::uint32_t> owner(n, kNone), renumbered(n, kNone), first(chunks + 1, 0);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    each_number(c, [&](std::uint32_t v, std::size_t) { lower_to(owner[v], static_cast<std::uint32_t>(c)); });
  });
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    std::uint32_t own = 0;
    each_number(c, [&](std::uint32_t v, std::size_t) {
      if (owner[v] == c && renumbered[v] == kNone) renumbered[v] = own++;
    });
    first[c + 1] = own;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<LatticePoint> new_points(first.back());
  std::vector<float> new_values(first.back());
  std::vector<std::uint8_t> new_caps(first.back()), new_sized(sized_.empty() ? 0 : first.back());
  parallel_for(0, n, 8192, [&](std::size_t v) {
    if (owner[v] == kNone) return;
    const std::uint32_t to = renumbered[v] += first[owner[v]];
    new_points[to] = numbering_.points()[v];
    new_values[to] = values_[v];
    new_caps[to] = caps_[v];
    if (!sized_.empty()) new_sized[to] = sized_[v];
  });
  points_ = std::move(new_points), values_ = std::move(new_values), caps_ = std::move(new_caps);
  sized_ = std::move(new_sized);
  numbering_ = {};
  std::vector<std::uint32_t> new_numbers(end);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    each_number(c, [&](std::uint32_t v, std::size_t to) { new_numbers[to] = renumbered[v]; });
  });
  numbers_ = std::move(new_numbers);
}

bool Extraction::crosses(const ActiveBlock& a) const {
  const std::span<const std::uint32_t> vertices = vertices_of(a);
  return std::any_of(vertices.begin() + 1, vertices.end(),
                     [&](std::uint32_t v) { return inside(v) != inside(vertices[0]); });
}

void Extraction::evaluate_new() {
  constexpr std::size_t kBatch = std::size_t{1} << 20;  // limits memory
  const std::size_t n = numbering_.points().size();
  std::size_t done = values_.size();
  values_.resize(n);
  caps_.resize(n);
  const auto* const signs = dynamic_cast<const SignField*>(&field_);
  if (signs) sized_.resize(n);
  std::vector<Vec3> x;
  std::vector<double> f;
  for (std::size_t count; done < n; done += count) {
    count = std::min(kBatch, n - done);
    x.resize(count), f.resize(count);
    parallel_for(0, count, 8192, [&](std::size_t i) { x[i] = lattice_position(tree_, numbering_.points()[done + i]); });
    if (signs) {
      signs->evaluate_signs(x, f, std::span(sized_).subspan(done, count));
    } else {
      field_.evaluate(x, f);
    }
    parallel_for(0, count, 8192, [&](std::size_t i) { put_value(done + i, numbering_.points()[done + i], f[i]); });
  }
}

void Extraction::complete_values() {
  if (sized_.empty()) return;
  std::vector<std::uint8_t> wanted(values_.size(), 0);
  parallel_for(0, active_.size(), 1024, [&](std::size_t b) {
    const std::span<const std::uint32_t> vertices = vertices_of(active_[b]);
    if (std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return sized_[v] != 0; })) return;
    for (const auto& tet : active_[b].pattern->tets) {
      const auto in = [&](std::size_t k) { return inside(vertices[tet[k]]); };
      if (in(0) == in(1) && in(1) == in(2) && in(2) == in(3)) continue;
      for (const std::uint8_t s : tet)
        if (!sized_[vertices[s]]) std::atomic_ref(wanted[vertices[s]]).store(1, std::memory_order_relaxed);
    }
  });
  std::vector<std::size_t> list;
  for (std::size_t v = 0; v < wanted.size(); ++v)
    if (wanted[v]) list.push_back(v);
  std::vector<Vec3> x(list.size());
  std::vector<double> f(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) x[i] = lattice_position(tree_, points_[list[i]]);
  field_.evaluate(x, f);
  for (std::size_t i = 0; i < list.size(); ++i) put_value(list[i], points_[list[i]], f[i]);
  sized_ = {};
}

void Extraction::activate(const std::vector<Vec3>& seeds) {
  std::vector<std::uint8_t> is_active(tree_.size(), 0);
  add_new(seeds.empty() ? blocks_with_small_values() : blocks_at(seeds), is_active);
  std::vector<std::uint32_t> beyond;
  follow(is_active, 0, beyond);
  for (int layer = 0; !regions_.empty() && layer < kLayers; ++layer) {
    const std::size_t first = active_.size();
    add_new(std::exchange(beyond, {}), is_active);
    follow(is_active, first, beyond);
  }
  is_active = {};
  put_in_order();
  complete_values();
}

void Extraction::add_new(std::vector<std::uint32_t> blocks, std::vector<std::uint8_t>& is_active) {
  std::size_t kept = 0;
  for (const std::uint32_t b : blocks)
    if (!std::exchange(is_active[b], std::uint8_t{1})) blocks[kept++] = b;
  blocks.resize(kept);
  add_blocks(blocks);
}

std::vector<std::uint32_t> Extraction::blocks_at(const std::vector<Vec3>& seeds) const {
  const double scale = static_cast<double>(1u << tree_.depth()) / tree_.edge();
  std::vector<std::int64_t> at(seeds.size());
  parallel_for(0, seeds.size(), 4096, [&](std::size_t i) {
    const Vec3 p = (seeds[i] - tree_.lower()) * scale;
    at[i] = tree_.find(tree_.depth(), whole_part<std::int64_t>(std::floor(p.x)),
                       whole_part<std::int64_t>(std::floor(p.y)), whole_part<std::int64_t>(std::floor(p.z)));
    if (at[i] >= 0 && (!in_region(static_cast<std::size_t>(at[i])) || out_of_domain(static_cast<std::size_t>(at[i]))))
      at[i] = -1;
  });
  std::vector<std::uint32_t> blocks;
  for (const std::int64_t b : at)
    if (b >= 0) blocks.push_back(static_cast<std::uint32_t>(b));
  return blocks;
}

void Extraction::leave_out(const ScalarField& domain) {
  beyond_domain_.assign(tree_.size(), 0);
  std::vector<std::vector<std::uint32_t>> of_level(static_cast<std::size_t>(tree_.depth()) + 1);
  for (const std::uint32_t b : tree_.leaves()) of_level[tree_[b].level].push_back(b);
  for (const std::vector<std::uint32_t>& blocks : of_level) {
    if (blocks.empty()) continue;
    std::vector<Vec3> x(blocks.size());
    std::vector<ValueRange> ranges(blocks.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = tree_.block_center(blocks[i]);
    domain.ranges(x, 0.5 * std::sqrt(3.0) * tree_.block_edge(blocks[0]), ranges);
    for (std::size_t i = 0; i < x.size(); ++i) beyond_domain_[blocks[i]] = ranges[i].least > 0;
  }
}

bool Extraction::in_region(std::size_t block) const {
  if (regions_.empty()) return true;
  const Vec3 center = tree_.block_center(block);
  return any_touches(regions_, widened(Box3{center, center}, 0.5 * tree_.block_edge(block)));
}

std::vector<std::uint32_t> Extraction::blocks_with_small_values() const {
  const std::vector<std::uint32_t> leaves = tree_.leaves();
  std::vector<Vec3> centres(leaves.size());
  std::vector<double> at_centre(leaves.size());
  parallel_for(0, leaves.size(), 8192, [&](std::size_t i) { centres[i] = tree_.block_center(leaves[i]); });
  field_.evaluate(centres, at_centre);
  std::vector<std::uint32_t> blocks;
  for (std::size_t i = 0; i < leaves.size(); ++i)
    if (in_region(leaves[i]) && !out_of_domain(leaves[i]) && std::abs(at_centre[i]) <= tree_.block_edge(leaves[i]))
      blocks.push_back(leaves[i]);
  return blocks;
}

void Extraction::follow(std::vector<std::uint8_t>& is_active, std::size_t done, std::vector<std::uint32_t>& beyond) {
  constexpr std::size_t kChunk = 512;
  while (done < active_.size()) {
    evaluate_new();
    const std::size_t first = std::exchange(done, active_.size()), chunks = (done - first + kChunk - 1) / kChunk;
    std::vector<std::vector<std::uint32_t>> found(chunks);
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      for (std::size_t i = first + c * kChunk; i < std::min(done, first + (c + 1) * kChunk); ++i)
        cross_faces(active_[i], is_active, found[c]);
    });
    std::vector<std::uint32_t> next;
    for (const auto& blocks : found)
      for (const std::uint32_t b : blocks)
        if (!out_of_domain(b)) (in_region(b) ? next : beyond).push_back(b);
    add_new(std::move(next), is_active);
  }
}

void Extraction::cross_faces(const ActiveBlock& a, const std::vector<std::uint8_t>& is_active,
                             std::vector<std::uint32_t>& found) const {
  if (!crosses(a)) return;
  for (std::size_t face = 0; face < 6; ++face)
    if (changes_on(a, face, [](std::uint32_t) { return true; })) cross_face(a, face, is_active, found);
}

void Extraction::cross_face(const ActiveBlock& a, std::size_t face, const std::vector<std::uint8_t>& is_active,
                            std::vector<std::uint32_t>& found) const {
  const BlockTree::Block& b = tree_[a.block];
  std::array<std::int64_t, 3> cell{b.cell[0], b.cell[1], b.cell[2]};
  const std::size_t axis = face / 2;
  cell[axis] += face % 2 ? 1 : -1;
  const std::int64_t at = tree_.find(b.level, cell[0], cell[1], cell[2]);
  if (at < 0) return;
  const BlockTree::Block& n = tree_[static_cast<std::size_t>(at)];
  if (n.first_child < 0) {
    if (!is_active[static_cast<std::size_t>(at)]) found.push_back(static_cast<std::uint32_t>(at));
    return;
  }
  for (unsigned c = 0; c < 8; ++c) {  // the four children that touch the face, each in its part of it
    const std::uint32_t child = static_cast<std::uint32_t>(n.first_child) + c;
    if ((c >> axis & 1u) == static_cast<unsigned>(face % 2) || is_active[child]) continue;
    const auto in_part = [&](std::uint32_t slot) {
      const std::array<std::uint32_t, 3> q{slot % 5u, slot / 5u % 5u, slot / 25u};
      for (std::size_t k = 0; k < 3; ++k)
        if (k != axis && (c >> k & 1u ? q[k] < 2 : q[k] > 2)) return false;
      return true;
    };
    if (changes_on(a, face, in_part)) found.push_back(child);
  }
}

}  // namespace sansmesh::inline v1
