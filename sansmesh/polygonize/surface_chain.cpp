#include "sansmesh/polygonize/surface_chain.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNoEntry = ~std::uint32_t{0};

std::uint64_t name_of(const ChainVertex& v) { return static_cast<std::uint64_t>(v.a) << 32 | v.b; }
ChainVertex vertex_of(std::uint64_t name) {
  return {static_cast<std::uint32_t>(name >> 32), static_cast<std::uint32_t>(name & 0xffffffffUL)};
}

/// The names among the corners that `take` accepts, ascending.
template <class Take>
std::vector<std::uint64_t> sorted_names(const std::vector<ChainTriangle>& named, const Take& take) {
  constexpr std::size_t kChunk = 16384;
  std::vector<std::vector<std::uint64_t>> parts((named.size() + kChunk - 1) / kChunk);
  parallel_for(0, parts.size(), 1, [&](std::size_t c) {
    for (std::size_t i = c * kChunk; i < std::min(named.size(), (c + 1) * kChunk); ++i)
      for (const ChainVertex& v : named[i])
        if (take(v)) parts[c].push_back(name_of(v));
  });
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  std::vector<std::uint64_t> names;
  names.reserve(count);
  for (auto& part : parts) {
    names.insert(names.end(), part.begin(), part.end());
    part = {};
  }
  parallel_sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::uint32_t vertex_index(const std::vector<std::uint64_t>& names, const ChainVertex& v) {
  return static_cast<std::uint32_t>(std::lower_bound(names.begin(), names.end(), name_of(v)) - names.begin());
}

/// Numbers all used names: merged lattice vertices first (ascending), then crossing points (ascending).
SurfaceChain number_vertices(const std::vector<ChainTriangle>& named, std::size_t lattice_vertices) {
  if (named.size() > kMostTriangles) throw DataError("the mesh would have too many triangles for 32-bit indices");
  SurfaceChain chain;
  std::vector<std::uint32_t> of_lattice(lattice_vertices, kNoEntry);
  const std::vector<std::uint64_t> edges = sorted_names(named, [](const ChainVertex& v) { return v.a != v.b; });
  parallel_for(0, named.size(), 8192, [&](std::size_t i) {
    for (const ChainVertex& v : named[i])
      if (v.a == v.b) std::atomic_ref(of_lattice[v.a]).store(0, std::memory_order_relaxed);
  });
  for (std::size_t i = 0; i < of_lattice.size(); ++i) {
    if (of_lattice[i] == kNoEntry) continue;
    of_lattice[i] = static_cast<std::uint32_t>(chain.vertices.size());
    chain.vertices.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i)});
  }
  const auto first_edge = static_cast<std::uint32_t>(chain.vertices.size());
  for (const std::uint64_t e : edges) chain.vertices.push_back(vertex_of(e));
  chain.triangles.resize(named.size());
  parallel_for(0, named.size(), 8192, [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const ChainVertex v = named[i][k];
      chain.triangles[i][k] = v.a == v.b ? of_lattice[v.a] : first_edge + vertex_index(edges, v);
    }
  });
  return chain;
}

/// As above for a few triangles, without iterating over the lattice; vertices in the order of their names.
SurfaceChain number_few_vertices(const std::vector<ChainTriangle>& named) {
  SurfaceChain chain;
  const std::vector<std::uint64_t> names = sorted_names(named, [](const ChainVertex&) { return true; });
  for (const std::uint64_t name : names) chain.vertices.push_back(vertex_of(name));
  chain.triangles.resize(named.size());
  parallel_for(0, named.size(), 8192, [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) chain.triangles[i][k] = vertex_index(names, named[i][k]);
  });
  return chain;
}

/// Removes pairs of triangles with the same three vertices and opposite orientation.
void cancel_opposite(SurfaceChain& chain) {
  const VertexCorners c(chain.triangles, chain.vertices.size());
  std::vector<std::uint8_t> gone(chain.triangles.size(), 0);
  parallel_for(0, chain.vertices.size(), 4096, [&](std::size_t v) {
    for (std::uint32_t i = c.first[v]; i < c.first[v + 1]; ++i) {
      const std::uint32_t ti = c.entries[i] / 3, ki = c.entries[i] % 3;
      const Triangle& a = chain.triangles[ti];
      const std::uint32_t p = a[(ki + 1) % 3], q = a[(ki + 2) % 3];
      if (v > p || v > q || gone[ti]) continue;  // each triangle belongs to its smallest vertex
      for (std::uint32_t j = i + 1; j < c.first[v + 1]; ++j) {
        const std::uint32_t tj = c.entries[j] / 3, kj = c.entries[j] % 3;
        const Triangle& b = chain.triangles[tj];
        if (b[(kj + 1) % 3] != q || b[(kj + 2) % 3] != p || gone[tj])
          continue;  // `gone` can only be set by this vertex
        gone[ti] = gone[tj] = 1;
        break;
      }
    }
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chain.triangles.size(); ++i)
    if (!gone[i]) chain.triangles[kept++] = chain.triangles[i];
  chain.triangles.resize(kept);
}

/// Result and workspace of fans_of. A vertex has few triangles, so plain arrays and all pairs are fastest.
struct Fans {
  std::vector<std::uint32_t> link;  ///< fan of each corner of the vertex
  std::vector<std::uint32_t> out, back;
};

/// Finds the fans around a vertex. Returns their number, or 0 if an edge of the vertex has more than two triangles.
int fans_of(const SurfaceChain& chain, const VertexCorners& c, std::size_t v, Fans& fans) {
  const std::uint32_t first = c.first[v], n = c.first[v + 1] - first;
  auto& [link, out, back] = fans;
  link.assign(n, kNoEntry);
  out.resize(n), back.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t corner = c.entries[first + i];
    const Triangle& t = chain.triangles[corner / 3];
    out[i] = t[(corner % 3 + 1) % 3];
    back[i] = t[(corner % 3 + 2) % 3];
  }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j)
      if (out[i] == out[j] || back[i] == back[j]) return 0;
  int count = 0;
  bool border = false;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (link[i] != kNoEntry) continue;
    for (std::uint32_t at = i; at != kNoEntry && link[at] == kNoEntry;) {
      link[at] = static_cast<std::uint32_t>(count);
      const std::uint32_t want = back[at];
      at = static_cast<std::uint32_t>(std::find(out.begin(), out.end(), want) - out.begin());
      if (at == n) at = kNoEntry, border = true;
    }
    ++count;
  }
  // A border may start in the middle of a chain: join chains that continue each other.
  while (border) {
    border = false;
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j)
        if (back[i] == out[j] && link[i] != link[j]) {
          const std::uint32_t from = std::max(link[i], link[j]), to = std::min(link[i], link[j]);
          for (std::uint32_t& l : link)
            if (l == from)
              l = to;
            else if (l > from)
              --l;
          --count;
          border = true;
        }
  }
  return count;
}

/// Number of fans per vertex, at least 1; 0: an edge of the vertex has more than two triangles.
std::vector<std::uint8_t> count_fans(const SurfaceChain& chain, const VertexCorners& c) {
  std::vector<std::uint8_t> count(chain.vertices.size(), 1);
  parallel_ranges(0, count.size(), 4096, [&](std::size_t first, std::size_t last) {
    Fans found;
    for (std::size_t v = first; v < last; ++v)
      if (c.first[v + 1] > c.first[v]) count[v] = static_cast<std::uint8_t>(std::min(fans_of(chain, c, v, found), 255));
  });
  return count;
}

/// Undoes the merges that glue sheets along edges, at vertices for which `complete` is true: all of their triangles are
/// present. Returns the lattice vertices that are no longer merged.
template <class Complete>
std::vector<std::uint32_t> undo_merges(const SurfaceChain& chain, const VertexCorners& c,
                                       const std::vector<std::uint8_t>& fans, const Complete& complete,
                                       ChainSource::Flags& merged) {
  std::vector<std::uint32_t> undone;
  const auto undo = [&](std::uint32_t v) {
    if (merged[v]) merged[v] = 0, undone.push_back(v);
  };
  for (std::size_t v = 0; v < fans.size(); ++v) {
    const ChainVertex name = chain.vertices[v];
    if (fans[v] > 0 || !complete(name)) continue;
    if (name.a == name.b) {
      undo(name.a);
    } else {
      // A crossing point glued to a merged neighbour: undo the merges around it.
      for (std::uint32_t i = c.first[v]; i < c.first[v + 1]; ++i)
        for (const std::uint32_t o : chain.triangles[c.entries[i] / 3])
          if (const ChainVertex other = chain.vertices[o]; other.a == other.b) undo(other.a);
    }
  }
  return undone;
}

/// Repeats undoing merges around those already undone, until none is left. Returns the number of rounds.
int settle_around(const ChainSource& source, std::vector<std::uint32_t> undone, ChainSource::Flags& merged) {
  int rounds = 0;
  for (; !undone.empty(); ++rounds) {
    // Only vertices in a block with an undone one can have changed triangles.
    ChainSource::Flags near(merged.size(), 0);
    for (const std::uint32_t v : undone) near[v] = 1;
    source.widen(near);
    SurfaceChain chain = number_few_vertices(source.march(merged, near));
    cancel_opposite(chain);
    const VertexCorners c(chain.triangles, chain.vertices.size());
    undone = undo_merges(
        chain, c, count_fans(chain, c), [&](const ChainVertex& v) { return near[v.a] || near[v.b]; }, merged);
  }
  return rounds;
}

/// Doubles vertices at which sheets touch; drops unused names.
void separate_sheets(SurfaceChain& chain, const VertexCorners& c, const std::vector<std::uint8_t>& fans) {
  Fans found;
  const std::vector<std::uint32_t>& link = found.link;
  for (std::size_t v = 0; v < fans.size(); ++v) {
    if (fans[v] < 2) continue;
    const int count = fans_of(chain, c, v, found);
    for (int f = 1; f < count; ++f) {
      const auto copy = static_cast<std::uint32_t>(chain.vertices.size());
      chain.vertices.push_back(chain.vertices[v]);
      for (std::uint32_t i = 0; i < link.size(); ++i) {
        const std::uint32_t corner = c.entries[c.first[v] + i];
        if (link[i] == static_cast<std::uint32_t>(f)) chain.triangles[corner / 3][corner % 3] = copy;
      }
    }
  }
  std::vector<std::uint32_t> renumber(chain.vertices.size(), kNoEntry);
  for (const Triangle& t : chain.triangles)
    for (const std::uint32_t v : t) renumber[v] = 0;
  std::uint32_t used = 0;
  for (std::size_t v = 0; v < renumber.size(); ++v) {
    if (renumber[v] == kNoEntry) continue;
    renumber[v] = used;
    chain.vertices[used++] = chain.vertices[v];
  }
  chain.vertices.resize(used);
  parallel_for(0, chain.triangles.size(), 8192, [&](std::size_t i) {
    for (std::uint32_t& v : chain.triangles[i]) v = renumber[v];
  });
}

}  // namespace

SurfaceChain make_surface_chain(const ChainSource& source, ChainSource::Flags& merged) {
  for (int round = 1;; ++round) {
    SurfaceChain chain = number_vertices(source.march(merged, {}), merged.size());
    chain.rounds = round;
    if (merged.empty()) return chain;
    cancel_opposite(chain);
    const VertexCorners c(chain.triangles, chain.vertices.size());
    const std::vector<std::uint8_t> fans = count_fans(chain, c);
    std::vector<std::uint32_t> undone = undo_merges(
        chain, c, fans, [](const ChainVertex&) { return true; }, merged);
    if (undone.empty()) {
      separate_sheets(chain, c, fans);
      return chain;
    }
    chain = {};
    if (source.widen) round += settle_around(source, std::move(undone), merged) - 1;
  }
}

}  // namespace sansmesh::inline v1
