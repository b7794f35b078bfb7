// Displacement and marching of extracted simplices.
#include "sansmesh/polygonize/lattice/extraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sansmesh/core/parallel.h"
#include "sansmesh/polygonize/lattice/marched_simplex.h"

namespace sansmesh::inline v1 {

void Extraction::displace(double alpha) {
  const std::size_t n = values_.size();
  // Edge of the smallest block around each vertex: neighbours may be finer, and their bound applies.
  std::vector<float> edge(n, std::numeric_limits<float>::max());
  for (const ActiveBlock& a : active_)
    for (const std::uint32_t v : vertices_of(a))
      edge[v] = std::min(edge[v], static_cast<float>(tree_.block_edge(a.block)));
  std::vector<Vec3f> positions(n);
  std::vector<Vec3> x(n), g(n);
  std::vector<double> f(n);
  parallel_for(0, n, 8192, [&](std::size_t i) {
    positions[i] = position(static_cast<std::uint32_t>(i));
    x[i] = origin_ + Vec3(positions[i]);
  });
  field_.evaluate(x, f, g);
  parallel_for(0, n, 4096, [&](std::size_t i) {
    const double slope = norm(g[i]);
    const double most = 0.5 * edge[i];  // |F| is rarely much larger in a simplex of the surface
    const double size = std::abs(f[i]);
    if (!(slope > 0) || size >= most) return;
    const double step = (most - size) / most * alpha * edge[i] / 4;
    positions[i] += Vec3f(g[i] * ((f[i] < 0 ? -step : step) / slope));
    x[i] = origin_ + Vec3(positions[i]);
  });
  field_.evaluate(x, f);
  // A vertex whose sign changes by the move (a second sheet close by) stays in place.
  parallel_for(0, n, 4096, [&](std::size_t i) {
    const auto v = static_cast<std::uint32_t>(i);
    if ((f[i] < 0) == inside(v) && !on_border(points_[v])) {
      values_[i] = static_cast<float>(f[i]);
    } else {
      positions[i] = position(v);
    }
  });
  moved_ = std::move(positions);
}

std::vector<ChainTriangle> Extraction::march(const ChainSource::Flags& merged, const ChainSource::Flags& near) const {
  constexpr std::size_t kChunk = 512;
  const std::size_t chunks = (active_.size() + kChunk - 1) / kChunk;
  std::vector<std::vector<ChainTriangle>> parts(chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    for (std::size_t b = c * kChunk; b < std::min(active_.size(), (c + 1) * kChunk); ++b)
      if (near.empty() || has_any(active_[b], near)) march_block(active_[b], merged, parts[c]);
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

bool Extraction::has_any(const ActiveBlock& a, const ChainSource::Flags& flags) const {
  const std::span<const std::uint32_t> vertices = vertices_of(a);
  return std::any_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return flags[v] != 0; });
}

void Extraction::widen(ChainSource::Flags& marked) const {
  constexpr std::size_t kChunk = 4096;
  std::vector<std::vector<std::size_t>> found((active_.size() + kChunk - 1) / kChunk);
  parallel_for(0, found.size(), 1, [&](std::size_t c) {
    for (std::size_t b = c * kChunk; b < std::min(active_.size(), (c + 1) * kChunk); ++b)
      if (has_any(active_[b], marked)) found[c].push_back(b);
  });
  for (const auto& blocks : found)
    for (const std::size_t b : blocks)
      for (const std::uint32_t v : vertices_of(active_[b])) marked[v] = 1;
}

ChainVertex Extraction::crossing(std::uint32_t in, std::uint32_t out, const ChainSource::Flags& merged) const {
  const std::uint32_t near = values_[out] < -values_[in] ? out : in;
  if (!merged.empty() && merged[near]) return {near, near};
  return {in, out};
}

void Extraction::march_block(const ActiveBlock& a, const ChainSource::Flags& merged,
                             std::vector<ChainTriangle>& out) const {
  const std::span<const std::uint32_t> number = vertices_of(a);
  std::array<bool, 125> in;
  for (std::size_t s = 0; s < number.size(); ++s) in[s] = inside(number[s]);
  const auto emit = [&](const ChainVertex& p, const ChainVertex& q, const ChainVertex& r) {
    if (!(p == q) && !(q == r) && !(p == r)) out.push_back({p, q, r});
  };
  for (const auto& tet : a.pattern->tets) {
    const unsigned mask =
        (in[tet[0]] ? 1u : 0u) | (in[tet[1]] ? 2u : 0u) | (in[tet[2]] ? 4u : 0u) | (in[tet[3]] ? 8u : 0u);
    march_simplex(
        mask, [&](std::size_t i, std::size_t j) { return crossing(number[tet[i]], number[tet[j]], merged); }, emit);
  }
}

}  // namespace sansmesh::inline v1
