#include "sansmesh/polygonize/surface_chain.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh {
namespace {

constexpr std::uint32_t kNoEntry = ~std::uint32_t{0};

/// Gives every name used a number: merged lattice vertices first (ascending), then crossing points (ascending).
SurfaceChain number_vertices(const std::vector<ChainTriangle>& named, std::size_t lattice_vertices) {
  if (named.size() > kMostTriangles) throw DataError("the mesh would have more triangles than can be counted");
  SurfaceChain chain;
  std::vector<std::uint32_t> of_lattice(lattice_vertices, kNoEntry);
  std::vector<std::uint64_t> edges;
  for (const ChainTriangle& t : named)
    for (const ChainVertex& v : t) {
      if (v.a == v.b) {
        of_lattice[v.a] = 0;
      } else {
        edges.push_back(static_cast<std::uint64_t>(v.a) << 32 | v.b);
      }
    }
  for (std::size_t i = 0; i < of_lattice.size(); ++i) {
    if (of_lattice[i] == kNoEntry) continue;
    of_lattice[i] = static_cast<std::uint32_t>(chain.vertices.size());
    chain.vertices.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i)});
  }
  parallel_sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const auto first_edge = static_cast<std::uint32_t>(chain.vertices.size());
  for (const std::uint64_t e : edges)
    chain.vertices.push_back({static_cast<std::uint32_t>(e >> 32), static_cast<std::uint32_t>(e & 0xffffffffUL)});
  chain.triangles.resize(named.size());
  parallel_for(0, named.size(), 8192, [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const ChainVertex v = named[i][k];
      if (v.a == v.b) {
        chain.triangles[i][k] = of_lattice[v.a];
      } else {
        const std::uint64_t e = static_cast<std::uint64_t>(v.a) << 32 | v.b;
        chain.triangles[i][k] =
            first_edge + static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), e) - edges.begin());
      }
    }
  });
  return chain;
}

/// Removes pairs of triangles on the same three vertices with opposite orientation.
void cancel_opposite(SurfaceChain& chain) {
  const VertexCorners c(chain.triangles, chain.vertices.size());
  std::vector<std::uint8_t> gone(chain.triangles.size(), 0);
  parallel_for(0, chain.vertices.size(), 4096, [&](std::size_t v) {
    for (std::uint32_t i = c.first[v]; i < c.first[v + 1]; ++i) {
      const std::uint32_t ti = c.corner[i] / 3, ki = c.corner[i] % 3;
      const Triangle& a = chain.triangles[ti];
      const std::uint32_t p = a[(ki + 1) % 3], q = a[(ki + 2) % 3];
      if (v > p || v > q || gone[ti]) continue;  // each triangle belongs to its smallest vertex
      for (std::uint32_t j = i + 1; j < c.first[v + 1]; ++j) {
        const std::uint32_t tj = c.corner[j] / 3, kj = c.corner[j] % 3;
        const Triangle& b = chain.triangles[tj];
        if (b[(kj + 1) % 3] != q || b[(kj + 2) % 3] != p || gone[tj]) continue;  // gone only of this vertex's own
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

/// What fans_of finds, and its working space: a vertex has few triangles, so that plain arrays and all pairs are the
/// quickest.
struct Fans {
  std::vector<std::uint32_t> link;  ///< fan of each corner of the vertex
  std::vector<std::uint32_t> out, back;
};

/// The fans around a vertex. Returns their number, or 0 if an edge of the vertex has more than two triangles.
int fans_of(const SurfaceChain& chain, const VertexCorners& c, std::size_t v, Fans& fans) {
  const std::uint32_t first = c.first[v], n = c.first[v + 1] - first;
  auto& [link, out, back] = fans;
  link.assign(n, kNoEntry);
  out.resize(n), back.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t corner = c.corner[first + i];
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
  // A border starts in the middle of its chain: join chains that continue each other.
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

}  // namespace

SurfaceChain make_surface_chain(
    const std::function<std::vector<ChainTriangle>(const std::vector<std::uint8_t>&)>& march,
    std::vector<std::uint8_t>& merged) {
  for (int round = 1;; ++round) {
    SurfaceChain chain = number_vertices(march(merged), merged.size());
    chain.rounds = round;
    if (merged.empty()) return chain;
    cancel_opposite(chain);
    const std::size_t n = chain.vertices.size();
    const VertexCorners c(chain.triangles, n);
    std::vector<std::uint8_t> bad(n, 0);
    std::vector<std::uint8_t> fans(n, 1);
    parallel_ranges(0, n, 4096, [&](std::size_t first, std::size_t last) {
      Fans found;
      for (std::size_t v = first; v < last; ++v) {
        const int count = fans_of(chain, c, v, found);
        if (count == 0 && c.first[v + 1] > c.first[v]) bad[v] = 1;
        fans[v] = static_cast<std::uint8_t>(std::clamp(count, 1, 255));
      }
    });
    bool repeat = false;
    for (std::size_t v = 0; v < n; ++v) {
      const ChainVertex name = chain.vertices[v];
      if (!bad[v]) continue;
      if (name.a == name.b) {
        merged[name.a] = 0;
        repeat = true;
      } else {
        // A crossing point that is glued to a merged neighbour: undo the merges around it.
        for (std::uint32_t i = c.first[v]; i < c.first[v + 1]; ++i)
          for (const std::uint32_t o : chain.triangles[c.corner[i] / 3]) {
            const ChainVertex other = chain.vertices[o];
            if (other.a == other.b && merged[other.a]) merged[other.a] = 0, repeat = true;
          }
      }
    }
    if (repeat) continue;

    // Sheets that touch in a vertex get one each; unused names go.
    Fans found;
    const std::vector<std::uint32_t>& link = found.link;
    for (std::size_t v = 0; v < n; ++v) {
      if (fans[v] < 2) continue;
      const int count = fans_of(chain, c, v, found);
      for (int f = 1; f < count; ++f) {
        const auto copy = static_cast<std::uint32_t>(chain.vertices.size());
        chain.vertices.push_back(chain.vertices[v]);
        for (std::uint32_t i = 0; i < link.size(); ++i) {
          const std::uint32_t corner = c.corner[c.first[v] + i];
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
    for (Triangle& t : chain.triangles)
      for (std::uint32_t& v : t) v = renumber[v];
    return chain;
  }
}

}  // namespace sansmesh
