#include "sansmesh/polygonize/polygonize.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/polygonize/lattice.h"
#include "sansmesh/polygonize/surface_chain.h"
#include "sansmesh/polygonize/vertex_placement.h"

namespace sansmesh::inline v1 {
namespace {

/// Layers of blocks around a region within which it shows that the mesh ends there.
constexpr int kLayers = 4;

/// A block whose simplices may cross the surface.
struct ActiveBlock {
  std::uint32_t block;
  const BlockPattern* pattern;
  std::size_t first;  ///< its lattice vertices: numbers[first ...], in the order of pattern->slots
};

struct Extraction {
  const ScalarField& field;
  BlockTree tree;
  Vec3 origin;
  std::vector<Box3> regions = {};                ///< only blocks that meet one, and kLayers around them; none: all
  std::vector<std::uint8_t> beyond_domain = {};  ///< of each block; empty: none is
  LatticeNumbering numbering = {};               ///< while the surface is followed
  PatternTable patterns = {};
  std::vector<ActiveBlock> active = {};
  std::vector<std::uint32_t> numbers = {};
  std::vector<LatticePoint> points = {};  ///< of each lattice vertex, once the surface has been followed
  /// Field at each lattice vertex; positive on the cube's faces, which closes the mesh.
  std::vector<float> values = {};
  std::vector<Vec3f> moved = {};        ///< of each lattice vertex, relative to origin, where there is a displacement
  std::vector<std::uint8_t> caps = {};  ///< lattice vertices on the cube's faces where the field is negative

  Vec3 world(const LatticePoint& p) const {
    const double unit = tree.edge() / static_cast<double>(2u << tree.depth());
    return tree.lower() + Vec3{p[0] * unit, p[1] * unit, p[2] * unit};
  }

  /// Of a lattice vertex, relative to origin.
  Vec3f position(std::uint32_t number) const {
    return moved.empty() ? Vec3f(world(points[number]) - origin) : moved[number];
  }

  /// Their lattice vertices get numbers in the order of the blocks, and of the slots of each.
  void add_blocks(const std::vector<std::uint32_t>& blocks) {
    // Chunks of blocks number their own vertices first, at the same time: what is left to be done in order is each
    // chunk's vertices once instead of once for every block around them.
    constexpr std::size_t kChunk = 2048;
    const std::size_t old = active.size(), chunks = (blocks.size() + kChunk - 1) / kChunk;
    std::vector<BlockRefinement> refinement(blocks.size());
    parallel_for(0, blocks.size(), 1024, [&](std::size_t i) { refinement[i] = refinement_of(tree, blocks[i]); });
    std::size_t end = numbers.size();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const BlockPattern& pattern = patterns.pattern(refinement[i]);
      active.push_back({blocks[i], &pattern, end});
      end += pattern.slots.size();
    }
    numbers.resize(end);
    std::vector<std::vector<LatticePoint>> met(chunks);
    const auto chunk_of = [&](std::size_t c) {
      return std::span(active).subspan(old + c * kChunk, std::min(kChunk, blocks.size() - c * kChunk));
    };
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      LatticeNumbering own;
      for (const ActiveBlock& a : chunk_of(c)) {
        const BlockTree::Block& b = tree[a.block];
        const std::uint32_t edge = 2u << (tree.depth() - b.level);
        for (std::size_t s = 0; s < a.pattern->slots.size(); ++s) {
          // Quarter edges exist only where the block is not on the deepest level, so the division is exact.
          const std::uint32_t slot = a.pattern->slots[s], q[3] = {slot % 5u, slot / 5u % 5u, slot / 25u};
          numbers[a.first + s] = own.number({b.cell[0] * edge + q[0] * edge / 4, b.cell[1] * edge + q[1] * edge / 4,
                                             b.cell[2] * edge + q[2] * edge / 4});
        }
      }
      met[c] = own.points();
    });
    std::vector<std::vector<std::uint32_t>> number(chunks);
    for (std::size_t c = 0; c < chunks; ++c) {
      number[c].reserve(met[c].size());
      for (const LatticePoint& p : met[c]) number[c].push_back(numbering.number(p));
      met[c] = {};
    }
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      for (const ActiveBlock& a : chunk_of(c))
        for (std::size_t s = 0; s < a.pattern->slots.size(); ++s)
          numbers[a.first + s] = number[c][numbers[a.first + s]];
    });
  }

  /// The surface is followed from many places at a time, so that numbers and blocks lie scattered. Puts the blocks that
  /// it crosses into the tree's order, along a curve that fills space, and numbers their lattice vertices anew in the
  /// order of these: what is near is then near in memory, in all that is made of them, too.
  void put_in_order() {
    constexpr std::size_t kChunk = 1024;
    constexpr std::uint32_t kNone = ~std::uint32_t{0};
    std::vector<std::uint32_t> at(tree.size(), kNone);
    parallel_for(0, active.size(), 4096, [&](std::size_t i) {
      if (crosses(active[i])) at[active[i].block] = static_cast<std::uint32_t>(i);
    });
    std::vector<ActiveBlock> ordered;
    std::vector<std::size_t> from;  // where its numbers were
    std::size_t end = 0;
    for (const std::uint32_t b : tree.leaves()) {
      if (at[b] == kNone) continue;
      const ActiveBlock& a = active[at[b]];
      from.push_back(a.first);
      ordered.push_back({a.block, a.pattern, end});
      end += a.pattern->slots.size();
    }
    at = {};
    active = std::move(ordered);

    // Each vertex belongs to the first chunk that has it, which numbers its own in the order in which it meets them.
    const std::size_t n = values.size(), chunks = (active.size() + kChunk - 1) / kChunk;
    const auto each_number = [&](std::size_t c, auto&& visit) {
      for (std::size_t i = c * kChunk; i < std::min(active.size(), (c + 1) * kChunk); ++i)
        for (std::size_t s = 0; s < active[i].pattern->slots.size(); ++s)
          visit(numbers[from[i] + s], active[i].first + s);
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
    std::vector<std::uint8_t> new_caps(first.back());
    parallel_for(0, n, 8192, [&](std::size_t v) {
      if (owner[v] == kNone) return;
      const std::uint32_t to = renumbered[v] += first[owner[v]];
      new_points[to] = numbering.points()[v];
      new_values[to] = values[v];
      new_caps[to] = caps[v];
    });
    points = std::move(new_points), values = std::move(new_values), caps = std::move(new_caps);
    numbering = {};
    std::vector<std::uint32_t> new_numbers(end);
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      each_number(c, [&](std::uint32_t v, std::size_t to) { new_numbers[to] = renumbered[v]; });
    });
    numbers = std::move(new_numbers);
  }

  static void lower_to(std::uint32_t& value, std::uint32_t bound) {
    const std::atomic_ref<std::uint32_t> least(value);
    std::uint32_t old = least.load(std::memory_order_relaxed);
    while (bound < old && !least.compare_exchange_weak(old, bound, std::memory_order_relaxed)) {
    }
  }

  bool crosses(const ActiveBlock& a) const {
    const bool in = inside(numbers[a.first]);
    for (std::size_t s = 1; s < a.pattern->slots.size(); ++s)
      if (inside(numbers[a.first + s]) != in) return true;
    return false;
  }

  /// Evaluates the field at the lattice vertices numbered since the last call.
  void evaluate_new() {
    constexpr std::size_t kBatch = std::size_t{1} << 20;  // not all places at a time: they are large
    const std::size_t n = numbering.points().size();
    std::size_t done = values.size();
    values.resize(n);
    caps.resize(n);
    std::vector<Vec3> x;
    std::vector<double> f;
    for (std::size_t count; done < n; done += count) {
      count = std::min(kBatch, n - done);
      x.resize(count), f.resize(count);
      parallel_for(0, count, 8192, [&](std::size_t i) { x[i] = world(numbering.points()[done + i]); });
      field.evaluate(x, f);
      parallel_for(0, count, 8192, [&](std::size_t i) {
        const bool cap = f[i] < 0 && on_border(numbering.points()[done + i]);
        caps[done + i] = cap;
        values[done + i] = static_cast<float>(cap ? -f[i] : f[i]);
      });
    }
  }

  bool inside(std::uint32_t number) const { return values[number] < 0; }

  bool on_border(const LatticePoint& p) const {
    const std::uint32_t last = 2u << tree.depth();
    return p[0] == 0 || p[1] == 0 || p[2] == 0 || p[0] == last || p[1] == last || p[2] == last;
  }

  /// Activates the blocks at the seeds (without seeds, those with a small value at their centre), and from there across
  /// every face on which the sign changes, so that no simplex of the surface is missed once its neighbour is found.
  void activate(const std::vector<Vec3>& seeds) {
    std::vector<std::uint8_t> is_active(tree.size(), 0);
    add_new(seeds.empty() ? blocks_with_small_values() : blocks_at(seeds), is_active);
    std::vector<std::uint32_t> beyond;
    follow(is_active, 0, beyond);
    for (int layer = 0; !regions.empty() && layer < kLayers; ++layer) {
      const std::size_t first = active.size();
      add_new(std::exchange(beyond, {}), is_active);
      follow(is_active, first, beyond);
    }
    is_active = {};
    put_in_order();
  }

  /// Adds those that are not active yet.
  void add_new(std::vector<std::uint32_t> blocks, std::vector<std::uint8_t>& is_active) {
    std::size_t kept = 0;
    for (const std::uint32_t b : blocks)
      if (!std::exchange(is_active[b], std::uint8_t{1})) blocks[kept++] = b;
    blocks.resize(kept);
    add_blocks(blocks);
  }

  /// The block of each seed that lies in one, within the region.
  std::vector<std::uint32_t> blocks_at(const std::vector<Vec3>& seeds) const {
    const double scale = static_cast<double>(1u << tree.depth()) / tree.edge();
    std::vector<std::int64_t> at(seeds.size());
    parallel_for(0, seeds.size(), 4096, [&](std::size_t i) {
      const Vec3 p = (seeds[i] - tree.lower()) * scale;
      at[i] = tree.find(tree.depth(), whole_part<std::int64_t>(std::floor(p.x)),
                        whole_part<std::int64_t>(std::floor(p.y)), whole_part<std::int64_t>(std::floor(p.z)));
      if (at[i] >= 0 && (!in_region(static_cast<std::size_t>(at[i])) || out_of_domain(static_cast<std::size_t>(at[i]))))
        at[i] = -1;
    });
    std::vector<std::uint32_t> blocks;
    for (const std::int64_t b : at)
      if (b >= 0) blocks.push_back(static_cast<std::uint32_t>(b));
    return blocks;
  }

  bool out_of_domain(std::size_t block) const { return !beyond_domain.empty() && beyond_domain[block]; }

  /// Leaves without any place where `domain` is not positive.
  void leave_out(const ScalarField& domain) {
    beyond_domain.assign(tree.size(), 0);
    std::vector<std::vector<std::uint32_t>> of_level(static_cast<std::size_t>(tree.depth()) + 1);
    for (const std::uint32_t b : tree.leaves()) of_level[tree[b].level].push_back(b);
    for (const std::vector<std::uint32_t>& blocks : of_level) {
      if (blocks.empty()) continue;
      std::vector<Vec3> x(blocks.size());
      std::vector<ValueRange> ranges(blocks.size());
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = tree.block_center(blocks[i]);
      domain.ranges(x, 0.5 * std::sqrt(3.0) * tree.block_edge(blocks[0]), ranges);
      for (std::size_t i = 0; i < x.size(); ++i) beyond_domain[blocks[i]] = ranges[i].least > 0;
    }
  }

  bool in_region(std::size_t block) const {
    if (regions.empty()) return true;
    const Vec3 center = tree.block_center(block);
    return any_touches(regions, widened(Box3{center, center}, 0.5 * tree.block_edge(block)));
  }

  std::vector<std::uint32_t> blocks_with_small_values() const {
    const std::vector<std::uint32_t> leaves = tree.leaves();
    std::vector<Vec3> centres(leaves.size());
    std::vector<double> at_centre(leaves.size());
    parallel_for(0, leaves.size(), 8192, [&](std::size_t i) { centres[i] = tree.block_center(leaves[i]); });
    field.evaluate(centres, at_centre);
    std::vector<std::uint32_t> blocks;
    for (std::size_t i = 0; i < leaves.size(); ++i)
      if (in_region(leaves[i]) && !out_of_domain(leaves[i]) && std::abs(at_centre[i]) <= tree.block_edge(leaves[i]))
        blocks.push_back(leaves[i]);
    return blocks;
  }

  /// From the active blocks from `done` on; those outside of the region that come next are only noted.
  void follow(std::vector<std::uint8_t>& is_active, std::size_t done, std::vector<std::uint32_t>& beyond) {
    constexpr std::size_t kChunk = 512;
    while (done < active.size()) {
      evaluate_new();
      const std::size_t first = std::exchange(done, active.size()), chunks = (done - first + kChunk - 1) / kChunk;
      std::vector<std::vector<std::uint32_t>> found(chunks);
      parallel_for(0, chunks, 1, [&](std::size_t c) {
        for (std::size_t i = first + c * kChunk; i < std::min(done, first + (c + 1) * kChunk); ++i)
          cross_faces(active[i], is_active, found[c]);
      });
      std::vector<std::uint32_t> next;
      for (const auto& blocks : found)
        for (const std::uint32_t b : blocks)
          if (!out_of_domain(b)) (in_region(b) ? next : beyond).push_back(b);
      add_new(std::move(next), is_active);
    }
  }

  /// Appends the blocks that are not active yet across the faces of a block on which the sign changes.
  void cross_faces(const ActiveBlock& a, const std::vector<std::uint8_t>& is_active,
                   std::vector<std::uint32_t>& found) const {
    if (!crosses(a)) return;
    for (std::size_t face = 0; face < 6; ++face)
      if (changes_on(a, face, [](std::uint32_t) { return true; })) cross_face(a, face, is_active, found);
  }

  /// Whether the sign changes among the vertices on a face whose slots are accepted.
  template <class Accept>
  bool changes_on(const ActiveBlock& a, std::size_t face, const Accept& accept) const {
    bool any_in = false, any_out = false;
    for (const std::uint8_t s : a.pattern->face[face])
      if (accept(a.pattern->slots[s])) (inside(numbers[a.first + s]) ? any_in : any_out) = true;
    return any_in && any_out;
  }

  void cross_face(const ActiveBlock& a, std::size_t face, const std::vector<std::uint8_t>& is_active,
                  std::vector<std::uint32_t>& found) const {
    const BlockTree::Block& b = tree[a.block];
    std::array<std::int64_t, 3> cell{b.cell[0], b.cell[1], b.cell[2]};
    const std::size_t axis = face / 2;
    cell[axis] += face % 2 ? 1 : -1;
    const std::int64_t at = tree.find(b.level, cell[0], cell[1], cell[2]);
    if (at < 0) return;
    const BlockTree::Block& n = tree[static_cast<std::size_t>(at)];
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

  /// METHODS §3.3: lattice vertices near the surface step back from it along the gradient, by a quarter of the local
  /// lattice's block edge at most, so that fewer simplices are cut close to a corner.
  void displace(double alpha) {
    const std::size_t n = values.size();
    // Edge of the smallest block around each vertex: a vertex's neighbours may be finer, and the bound is theirs.
    std::vector<float> edge(n, std::numeric_limits<float>::max());
    for (const ActiveBlock& a : active)
      for (std::size_t s = 0; s < a.pattern->slots.size(); ++s) {
        float& e = edge[numbers[a.first + s]];
        e = std::min(e, static_cast<float>(tree.block_edge(a.block)));
      }
    std::vector<Vec3f> positions(n);
    std::vector<Vec3> x(n), g(n);
    std::vector<double> f(n);
    parallel_for(0, n, 8192, [&](std::size_t i) {
      positions[i] = position(static_cast<std::uint32_t>(i));
      x[i] = origin + Vec3(positions[i]);
    });
    field.evaluate(x, f, g);
    parallel_for(0, n, 4096, [&](std::size_t i) {
      const double slope = norm(g[i]);
      const double most = 0.5 * edge[i];  // no |F| within a simplex of the surface is much larger
      const double size = std::abs(f[i]);
      if (!(slope > 0) || size >= most) return;
      const double step = (most - size) / most * alpha * edge[i] / 4;
      positions[i] += Vec3f(g[i] * ((f[i] < 0 ? -step : step) / slope));
      x[i] = origin + Vec3(positions[i]);
    });
    field.evaluate(x, f);
    // A vertex whose sign the move changed (a second sheet close by) stays where it was.
    parallel_for(0, n, 4096, [&](std::size_t i) {
      const auto v = static_cast<std::uint32_t>(i);
      if ((f[i] < 0) == inside(v) && !on_border(points[v])) {
        values[i] = static_cast<float>(f[i]);
      } else {
        positions[i] = position(v);
      }
    });
    moved = std::move(positions);
  }

  /// The triangles of all crossing simplices between vertices named by lattice edges, or by lattice vertices where
  /// `merged` allows; triangles that the merging makes degenerate are left out. Only those of blocks with a vertex
  /// `near`, if that is not empty.
  std::vector<ChainTriangle> march(const ChainSource::Flags& merged, const ChainSource::Flags& near) const {
    constexpr std::size_t kChunk = 512;
    const std::size_t chunks = (active.size() + kChunk - 1) / kChunk;
    std::vector<std::vector<ChainTriangle>> parts(chunks);
    parallel_for(0, chunks, 1, [&](std::size_t c) {
      for (std::size_t b = c * kChunk; b < std::min(active.size(), (c + 1) * kChunk); ++b)
        if (near.empty() || has_any(active[b], near)) march_block(active[b], merged, parts[c]);
    });
    std::vector<std::size_t> first(chunks + 1, 0);
    for (std::size_t c = 0; c < chunks; ++c) first[c + 1] = first[c] + parts[c].size();
    std::vector<ChainTriangle> all(first.back());
    parallel_for(0, chunks, 16, [&](std::size_t c) {
      std::copy(parts[c].begin(), parts[c].end(), all.begin() + static_cast<std::ptrdiff_t>(first[c]));
      parts[c] = {};
    });
    return all;
  }

  bool has_any(const ActiveBlock& a, const ChainSource::Flags& flags) const {
    for (std::size_t s = 0; s < a.pattern->slots.size(); ++s)
      if (flags[numbers[a.first + s]]) return true;
    return false;
  }

  /// Marks the vertices of all blocks that have a marked one.
  void widen(ChainSource::Flags& marked) const {
    constexpr std::size_t kChunk = 4096;
    std::vector<std::vector<std::size_t>> found((active.size() + kChunk - 1) / kChunk);
    parallel_for(0, found.size(), 1, [&](std::size_t c) {
      for (std::size_t b = c * kChunk; b < std::min(active.size(), (c + 1) * kChunk); ++b)
        if (has_any(active[b], marked)) found[c].push_back(b);
    });
    for (const auto& blocks : found)
      for (const std::size_t b : blocks)
        for (std::size_t s = 0; s < active[b].pattern->slots.size(); ++s) marked[numbers[active[b].first + s]] = 1;
  }

  /// The name of the surface vertex on the lattice edge from `in` to `out`.
  ChainVertex crossing(std::uint32_t in, std::uint32_t out, const std::vector<std::uint8_t>& merged) const {
    const std::uint32_t near = values[out] < -values[in] ? out : in;
    if (!merged.empty() && merged[near]) return {near, near};
    return {in, out};
  }

  void march_block(const ActiveBlock& a, const std::vector<std::uint8_t>& merged,
                   std::vector<ChainTriangle>& out) const {
    const std::uint32_t* number = numbers.data() + a.first;
    std::array<bool, 125> in;
    for (std::size_t s = 0; s < a.pattern->slots.size(); ++s) in[s] = inside(number[s]);
    const auto emit = [&](const ChainVertex& p, const ChainVertex& q, const ChainVertex& r) {
      if (!(p == q) && !(q == r) && !(p == r)) out.push_back({p, q, r});
    };
    for (const auto& tet : a.pattern->tets) {
      const int mask = (in[tet[0]] ? 1 : 0) | (in[tet[1]] ? 2 : 0) | (in[tet[2]] ? 4 : 0) | (in[tet[3]] ? 8 : 0);
      if (mask == 0 || mask == 15) continue;
      // Even permutations bring the inside vertices first: one of v; or two v, w; or three with the odd one out last.
      static constexpr std::array<std::array<std::uint8_t, 4>, 16> kOrder{{{0, 1, 2, 3},
                                                                           {0, 1, 2, 3},
                                                                           {1, 0, 3, 2},
                                                                           {0, 1, 2, 3},
                                                                           {2, 0, 1, 3},
                                                                           {0, 2, 3, 1},
                                                                           {1, 2, 0, 3},
                                                                           {0, 1, 2, 3},
                                                                           {3, 0, 2, 1},
                                                                           {0, 3, 1, 2},
                                                                           {1, 3, 2, 0},
                                                                           {0, 3, 1, 2},
                                                                           {2, 3, 0, 1},
                                                                           {0, 2, 3, 1},
                                                                           {1, 3, 2, 0},
                                                                           {0, 1, 2, 3}}};
      const auto& o = kOrder[static_cast<std::size_t>(mask)];
      const std::uint32_t v0 = number[tet[o[0]]], v1 = number[tet[o[1]]], v2 = number[tet[o[2]]],
                          v3 = number[tet[o[3]]];
      switch (std::popcount(static_cast<unsigned>(mask))) {
        case 1:
          emit(crossing(v0, v1, merged), crossing(v0, v2, merged), crossing(v0, v3, merged));
          break;
        case 3:
          emit(crossing(v0, v3, merged), crossing(v1, v3, merged), crossing(v2, v3, merged));
          break;
        default: {
          const ChainVertex p = crossing(v0, v2, merged), q = crossing(v0, v3, merged), r = crossing(v1, v3, merged),
                            s = crossing(v1, v2, merged);
          emit(p, q, r);
          emit(p, r, s);
        }
      }
    }
  }
};

/// A surface as it comes out of the lattice.
struct RawSurface {
  std::vector<Triangle> triangles;
  std::vector<Vec3f> vertices;       ///< relative to the origin
  std::vector<std::uint8_t> on_cap;  ///< closes the mesh at a face of the cube: there is no surface to move it to
};

/// The lattice, which takes more room than the surface in it, is gone afterwards.
RawSurface extract(const ScalarField& field, BlockTree blocks, const Vec3& origin, const PolygonizeOptions& options,
                   Progress& progress) {
  Extraction e{.field = field, .tree = std::move(blocks), .origin = origin, .regions = options.regions};
  progress.begin("evaluate lattice");
  if (options.domain) e.leave_out(*options.domain);
  e.activate(options.seeds);
  if (options.displacement > 0) e.displace(options.displacement);

  progress.begin("march");
  std::vector<std::uint8_t> merged;
  if (options.cluster) merged.assign(e.values.size(), 1);
  SurfaceChain chain =
      make_surface_chain({[&](const ChainSource::Flags& m, const ChainSource::Flags& near) { return e.march(m, near); },
                          [&](ChainSource::Flags& marked) { e.widen(marked); }},
                         merged);
  const std::size_t n = chain.vertices.size();
  RawSurface raw{std::move(chain.triangles), std::vector<Vec3f>(n), std::vector<std::uint8_t>(n)};
  parallel_for(0, n, 4096, [&](std::size_t i) {
    const ChainVertex v = chain.vertices[i];
    raw.on_cap[i] = e.caps[v.a] || e.caps[v.b];
    if (v.a == v.b) {
      raw.vertices[i] = e.position(v.a);
    } else {
      const float t = e.values[v.a] / (e.values[v.a] - e.values[v.b]);
      const Vec3f a = e.position(v.a), b = e.position(v.b);
      raw.vertices[i] = a + (b - a) * t;
    }
  });
  return raw;
}

/// Square of the longest edge at each vertex.
std::vector<float> longest_edges(const RawSurface& raw) {
  std::vector<float> longest(raw.vertices.size(), 0);
  for (const Triangle& t : raw.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const float d = squared_norm(raw.vertices[t[k]] - raw.vertices[t[(k + 1) % 3]]);
      longest[t[k]] = std::max(longest[t[k]], d);
    }
  return longest;
}

/// Simplifies the mesh with its vertices at x; false: it is as it was.
bool simplified(const PolygonizeOptions& options, TriangleMesh& mesh, const std::vector<Vec3>& x, Progress& progress) {
  if (!(options.simplify > 0)) return false;
  progress.begin("simplify");
  parallel_for(0, x.size(), 4096, [&](std::size_t i) { mesh.vertices[i] = Vec3f(x[i] - mesh.origin); });
  std::vector<Vec3f> normals = std::move(mesh.normals);  // made anew for what is left
  mesh.normals.clear();
  CollapseOptions simplify;
  simplify.error = options.simplify;
  simplify.triangles = options.triangles;
  simplify.least_gain = options.least_gain;
  // A mesh without borders may be made anew in part, and has to match there.
  simplify.in_patches = options.domain != nullptr;
  const bool changed = simplify_mesh(mesh, simplify, progress);
  if (!changed) mesh.normals = std::move(normals);
  progress.begin("place vertices again");
  return changed;
}

/// Vertices this close to the contour, as a share of an edge that crosses it, are moved onto it.
constexpr float kSnapToContour = 0.3f;

/// Leaves out what is not in the domain of the mesh with its vertices at x, and what closes it at the cube's faces.
void cut_off(const ScalarField& domain, const std::vector<std::uint8_t>& on_cap, TriangleMesh& mesh,
             std::vector<Vec3>& x) {
  std::vector<double> value(x.size());
  domain.evaluate(x, value);
  std::vector<float> height(x.size());
  parallel_for(0, x.size(), 8192, [&](std::size_t i) {
    mesh.vertices[i] = Vec3f(x[i] - mesh.origin);
    height[i] = on_cap[i] ? std::min(-1.0f, -static_cast<float>(value[i])) : -static_cast<float>(value[i]);
  });
  clip_mesh(mesh, std::move(height), kSnapToContour);
  x.resize(mesh.vertices.size());
  parallel_for(0, x.size(), 8192, [&](std::size_t i) { x[i] = mesh.origin + Vec3(mesh.vertices[i]); });
}

}  // namespace

TriangleMesh polygonize(const ScalarField& field, BlockTree blocks, const Vec3& origin,
                        const PolygonizeOptions& options, Progress& progress) {
  if (!(options.displacement >= 0 && options.displacement < 1))
    throw ArgumentError("polygonize: `displacement` must lie in [0, 1)");
  if (!(options.simplify >= 0)) throw ArgumentError("polygonize: `simplify` must be a length of at least 0");
  progress.begin("balance blocks");
  blocks.balance();
  const ScalarField& place = options.placement ? *options.placement : field;
  const Box3 cube = blocks.bounds();
  RawSurface raw = extract(field, std::move(blocks), origin, options, progress);

  progress.begin("place vertices");
  // A root lies within half the lattice's local spacing of where its vertex starts; a longer step means a gradient
  // that cannot be trusted.
  const std::vector<float> longest = longest_edges(raw);
  const std::vector<std::uint8_t> on_cap = std::move(raw.on_cap);
  TriangleMesh mesh;
  mesh.origin = origin;
  mesh.triangles = std::move(raw.triangles);
  mesh.vertices = std::move(raw.vertices);
  const std::size_t n = mesh.vertices.size();
  mesh.normals.resize(n);
  std::vector<Vec3> x(n), g(n);
  std::vector<double> f(n);
  parallel_for(0, n, 8192, [&](std::size_t i) { x[i] = origin + Vec3(mesh.vertices[i]); });
  const auto to_surface = [&] {
    place.evaluate(x, f, g);
    parallel_for(0, n, 4096, [&](std::size_t i) {
      const double slope2 = squared_norm(g[i]);
      if (options.root_steps > 0 && slope2 > 1e-4 && !on_cap[i]) {
        Vec3 move = g[i] * (-f[i] / slope2);
        const double most = 0.6 * std::sqrt(static_cast<double>(longest[i])), size = norm(move);
        if (size > most) move *= most / size;
        x[i] += move;
      }
      mesh.normals[i] = Vec3f(normalized(g[i]));
    });
  };
  for (int step = 1; step < options.root_steps; ++step) to_surface();
  Rings rings(mesh.triangles, n);
  if (options.smoothing_rounds > 0)
    smooth_tangentially(mesh.triangles, rings, mesh.normals, options.smoothing_rounds, x);
  to_surface();
  if (options.creases) snap_to_creases(place, mesh.triangles, rings, mesh.normals, x);
  if (options.domain) {
    cut_off(*options.domain, on_cap, mesh, x);
    rings = Rings(mesh.triangles, mesh.vertices.size());
  }
  if (simplified(options, mesh, x, progress)) {
    place_again(place, options, mesh, x);
  } else if (options.balance) {
    balance_gaps(place, mesh.triangles, rings, mesh.normals, x);
  }
  parallel_for(0, x.size(), 4096, [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) x[i][k] = std::clamp(x[i][k], cube.lower[k], cube.upper[k]);
    mesh.vertices[i] = Vec3f(x[i] - origin);
  });
  progress.finish();
  return mesh;
}

}  // namespace sansmesh::inline v1
