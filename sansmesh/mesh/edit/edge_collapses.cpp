#include "sansmesh/mesh/edit/edge_collapses.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <queue>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kTurn = 0.5;     // least cosine between a triangle's normals before and after
constexpr double kNoArea = 1e-6;  // twice the area / Σ l²; below it, rounding determines the normal

using Link = std::array<std::uint32_t, 2>;  // neighbours of a vertex in a triangle, the next one first

/// Classifies the fan of triangles with these links. only_with(w, end): the only triangle whose neighbour at that end
/// is w; the number of triangles if there is none, or several.
template <class OnlyWith>
EdgeCollapses::Fan fan_of_links(std::span<const Link> link, const OnlyWith& only_with) {
  using Fan = EdgeCollapses::Fan;
  const std::size_t n = link.size();
  std::size_t start = 0, starts = 0;
  for (std::size_t k = 0; k < n; ++k)
    if (only_with(link[k][0], 1) == n) start = k, ++starts;
  if (starts > 1) return Fan::none;
  std::size_t here = start;
  for (std::size_t steps = 1; steps <= n; ++steps) {
    const std::uint32_t last = link[here][1];
    if (starts == 0 && last == link[start][0]) return steps == n && steps >= 3 ? Fan::closed : Fan::none;
    if (starts == 1 && steps == n) return Fan::open;
    here = only_with(last, 0);
    if (here == n || here == start) break;
  }
  return Fan::none;
}

/// Same, for any number of links.
EdgeCollapses::Fan fan_of_many(std::span<const Link> link) {
  std::array<std::vector<std::pair<std::uint32_t, std::size_t>>, 2> by;  // sorted pairs of neighbour and triangle
  for (std::size_t end = 0; end < 2; ++end) {
    for (std::size_t k = 0; k < link.size(); ++k) by[end].emplace_back(link[k][end], k);
    std::sort(by[end].begin(), by[end].end());
  }
  return fan_of_links(link, [&](std::uint32_t w, std::size_t end) {
    const auto first = std::lower_bound(by[end].begin(), by[end].end(), std::pair(w, std::size_t{0}));
    const auto last = std::lower_bound(first, by[end].end(), std::pair(w + 1, std::size_t{0}));
    return last - first == 1 ? first->second : link.size();
  });
}

}  // namespace

EdgeCollapses::EdgeCollapses(const CollapseOptions& o, std::size_t vertices, std::vector<Triangle> all)
    : options(o),
      error(o.error),
      x(vertices),
      quadric(vertices),
      triangles(std::move(all)),
      chance(vertices, 0),
      fixed(vertices, 0),
      border(vertices, 0),
      merged_into(vertices, kNoVertex),
      to(vertices, kNoVertex),
      cost(vertices, 0),
      blocked(vertices, 0),
      left(vertices),
      left_triangles(triangles.size()) {
  build_rings();
}

void EdgeCollapses::build_rings() {
  valence.assign(x.size(), 0);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) ++valence[v];
  around.resize(assign_ring_starts(first));
  std::vector<std::size_t> next = first;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t v : triangles[i]) around[next[v]++] = static_cast<std::uint32_t>(i);
}

std::size_t EdgeCollapses::assign_ring_starts(std::vector<std::size_t>& start) const {
  start.resize(x.size());
  std::size_t sum = 0;
  for (std::size_t v = 0; v < x.size(); ++v) start[v] = sum, sum += valence[v];
  return sum;
}

void EdgeCollapses::pack_rings() {
  if (around.size() <= 6 * left_triangles) return;
  std::vector<std::size_t> start;
  std::vector<std::uint32_t> packed(assign_ring_starts(start));
  parallel_for(0, x.size(), 8192, [&](std::size_t v) {
    std::copy_n(around.begin() + static_cast<std::ptrdiff_t>(first[v]), valence[v],
                packed.begin() + static_cast<std::ptrdiff_t>(start[v]));
  });
  first = std::move(start);
  around = std::move(packed);
}

void EdgeCollapses::pack_triangles() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (triangles[i][0] == triangles[i][1]) continue;
    triangles[kept] = triangles[i];
    original[kept++] = original[i];
  }
  triangles.resize(kept);
  original.resize(kept);
  left_triangles = kept;
  build_rings();
}

void EdgeCollapses::prepare(std::uint32_t v) {
  const Fan fan = fan_of(v);
  fixed[v] = fan == Fan::none;
  border[v] = fan == Fan::open;
  quadric[v] = {};
  for (const std::uint32_t i : ring(v)) {
    const Triangle& t = triangles[i];
    const Vec3 area = cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
    const double size = norm(area);
    const double edges =
        squared_norm(x[t[1]] - x[t[0]]) + squared_norm(x[t[2]] - x[t[0]]) + squared_norm(x[t[2]] - x[t[1]]);
    if (!(size > kNoArea * edges)) {
      fixed[v] = 1;
      continue;
    }
    const Vec3 n = area / size;
    quadric[v].add_plane(n, dot(n, x[t[0]]), size);
  }
  add_borders(v, quadric[v]);
}

void EdgeCollapses::add_borders(std::uint32_t v, Quadric& sum) const {
  if (!border[v]) return;
  std::vector<std::uint32_t> met;  // neighbours, once per triangle: counting in rings is slow
  if (crowded(v)) {
    for (const std::uint32_t i : ring(v)) met.insert(met.end(), {after(triangles[i], v), before(triangles[i], v)});
    std::sort(met.begin(), met.end());
  }
  const auto at_border = [&](std::uint32_t w) {
    if (met.empty()) return triangles_at(v, w) == 1;
    const auto [begin, end] = std::equal_range(met.begin(), met.end(), w);
    return end - begin == 1;
  };
  for (const std::uint32_t i : ring(v)) {
    const Triangle& t = triangles[i];
    const Vec3 area = cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
    const double size = norm(area);
    if (!(size > 0)) continue;
    for (const std::uint32_t w : {after(t, v), before(t, v)}) {
      if (!at_border(w)) continue;
      const Vec3 along = x[w] - x[v], m = normalized(cross(along, area / size));
      // The border adds to the error with its full weight, but not to the weight that normalises the mean.
      const double weight = sum.weight;
      sum.add_plane(m, dot(m, x[v]), squared_norm(along));
      sum.weight = weight;
    }
  }
}

EdgeCollapses::Fan EdgeCollapses::fan_of(std::uint32_t v) const {
  const auto r = ring(v);
  if (r.empty()) return Fan::none;
  const auto link_of = [&](std::uint32_t i) { return Link{after(triangles[i], v), before(triangles[i], v)}; };
  if (crowded(v)) {
    std::vector<Link> link;
    link.reserve(r.size());
    for (const std::uint32_t i : r) link.push_back(link_of(i));
    return fan_of_many(link);
  }
  std::array<Link, kMostRing> link;
  for (std::size_t k = 0; k < r.size(); ++k) link[k] = link_of(r[k]);
  return fan_of_links(std::span<const Link>(link).first(r.size()), [&](std::uint32_t w, std::size_t end) {
    std::size_t found = r.size(), count = 0;
    for (std::size_t k = 0; k < r.size(); ++k)
      if (link[k][end] == w) found = k, ++count;
    return count == 1 ? found : r.size();
  });
}

void EdgeCollapses::note_crowded() {
  waits.clear();
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    if (!crowded(v)) continue;
    waits.resize(x.size(), 0);
    waits[v] = 1;
  }
}

std::size_t EdgeCollapses::neighbours_of(std::uint32_t v, Neighbours& found) const {
  std::size_t n = 0;
  for (const std::uint32_t i : ring(v)) found[n++] = after(triangles[i], v);
  if (!border[v]) return n;
  for (const std::uint32_t i : ring(v)) {
    const std::uint32_t w = before(triangles[i], v);
    if (std::find(found.begin(), found.begin() + n, w) != found.begin() + n) continue;
    found[n++] = w;
    break;
  }
  return n;
}

std::size_t EdgeCollapses::triangles_at(std::uint32_t v, std::uint32_t w) const {
  std::size_t count = 0;
  for (const std::uint32_t i : ring(v)) {
    const Triangle& t = triangles[i];
    count += t[0] == w || t[1] == w || t[2] == w;
  }
  return count;
}

bool EdgeCollapses::link_condition(std::uint32_t a, std::uint32_t b) const {
  Neighbours around_a, around_b;
  const std::size_t n = neighbours_of(a, around_a), m = neighbours_of(b, around_b), opposite = lost(a, b);
  std::size_t common = 0;
  for (std::size_t k = 0; k < m; ++k) {
    const std::uint32_t v = around_b[k];
    if (std::find(around_a.begin(), around_a.begin() + n, v) == around_a.begin() + n) continue;
    if (++common > opposite || valence[v] < (border[v] ? 2 : 4)) return false;
  }
  return common == opposite && triangles_at(a, b) == opposite;
}

double EdgeCollapses::shape_of(const Triangle& t) const {
  const Vec3 &p = x[t[0]], &q = x[t[1]], &r = x[t[2]];
  const double sum = squared_norm(q - p) + squared_norm(r - p) + squared_norm(q - r);
  return sum > 0 ? 2 * std::sqrt(3.0) * norm(cross(q - p, r - p)) / sum : 0;
}

bool EdgeCollapses::keeps_shape(std::uint32_t moved, std::uint32_t other, const Vec3& p, const Guard& guard) const {
  for (const std::uint32_t i : ring(moved)) {
    const Triangle& t = triangles[i];
    if (t[0] == other || t[1] == other || t[2] == other) continue;
    const std::size_t at = t[0] == moved ? 0 : t[1] == moved ? 1 : 2;
    const Vec3 &q = x[t[(at + 1) % 3]], &r = x[t[(at + 2) % 3]];
    const Vec3 before = cross(q - x[moved], r - x[moved]), after = cross(q - p, r - p);
    const double area_before = norm(before), area_after = norm(after);
    if (dot(before, after) < guard.cosine * area_before * area_after || !(area_after > 0)) return false;
    const double sum_after = squared_norm(q - p) + squared_norm(r - p) + squared_norm(q - r);
    const double shape = 2 * std::sqrt(3.0) * area_after / sum_after;
    if (shape >= guard.shape) continue;
    const double sum_before = squared_norm(q - x[moved]) + squared_norm(r - x[moved]) + squared_norm(q - r);
    if (shape < 2 * std::sqrt(3.0) * area_before / sum_before) return false;
  }
  return true;
}

EdgeCollapses::Collapse EdgeCollapses::measure(std::uint32_t a, std::uint32_t b) const {
  Quadric q = quadric[a];
  q += quadric[b];
  const Vec3 p = q.minimum((x[a] * quadric[a].weight + x[b] * quadric[b].weight) / q.weight);
  return {b, std::max(0.0, q.at(p)) / q.weight, p};
}

bool EdgeCollapses::possible(std::uint32_t a, const Collapse& c) const {
  return possible(a, c, {.shape = options.least_shape, .cosine = kTurn});
}

bool EdgeCollapses::possible(std::uint32_t a, const Collapse& c, const Guard& guard) const {
  return valence[a] + valence[c.with] <= kMostRing + 2 * lost(a, c.with) && link_condition(a, c.with) &&
         keeps_shape(a, c.with, c.position, guard) && keeps_shape(c.with, a, c.position, guard);
}

void EdgeCollapses::find_cheapest(std::uint32_t v) {
  const auto accept = [&](std::uint32_t w, Collapse& c) {
    if (w < v || !(quadric[v].weight + quadric[w].weight > 0)) return false;
    c = measure(v, w);
    const double most = limit.empty() ? error : std::min<double>(error, std::min(limit[v], limit[w]));
    return c.cost <= most * most;
  };
  if (const auto best = cheapest(v, accept, [&](const Collapse& c) { return possible(v, c); }))
    cost[v] = static_cast<float>(best->cost);
}

std::uint64_t EdgeCollapses::key(std::uint32_t v) const {
  const std::uint64_t exponent = std::bit_cast<std::uint32_t>(cost[v]) >> 23;
  return exponent << 56 | std::uint64_t{chance[v] >> 8} << 32 | v;
}

std::array<std::uint32_t, 4> EdgeCollapses::touched(std::uint32_t v) const {
  const std::uint32_t w = to[v];
  std::array<std::uint32_t, 4> result{v, w, v, v};
  std::size_t n = 2;
  for (const std::uint32_t i : ring(v)) {
    const Triangle& t = triangles[i];
    if ((t[0] != w && t[1] != w && t[2] != w) || n == 4) continue;
    const std::uint32_t opposite = t[0] ^ t[1] ^ t[2] ^ v ^ w;
    result[n++] = is_waiting(opposite) ? v : opposite;
  }
  return result;
}

void EdgeCollapses::collapse(std::uint32_t v, const Vec3& p, std::size_t start) {
  const std::uint32_t w = to[v];
  x[w] = p;
  quadric[w] += quadric[v];
  border[w] |= border[v];
  if (!limit.empty()) limit[w] = std::min(limit[w], limit[v]);
  merged_into[v] = w;
  std::uint32_t count = 0;
  const auto has = [&](const Triangle& t, std::uint32_t c) { return t[0] == c || t[1] == c || t[2] == c; };
  for (const std::uint32_t i : ring(w))
    if (!has(triangles[i], v)) around[start + count++] = i;
  for (const std::uint32_t i : ring(v)) {
    Triangle& t = triangles[i];
    if (!has(t, w)) {
      around[start + count++] = i;
      for (std::uint32_t& corner : t)
        if (corner == v) corner = w;
      continue;
    }
    for (const std::uint32_t o : t) {
      if (o == v || o == w || is_waiting(o)) continue;
      std::uint32_t* const begin = around.data() + first[o];
      *std::find(begin, begin + valence[o], i) = begin[valence[o] - 1];
      --valence[o];
    }
    t = {w, w, w};  // removed at the end
  }
  first[w] = start;
  valence[w] = count;
  valence[v] = 0;
  to[v] = kNoVertex;
}

void EdgeCollapses::collapse_in_turn() {
  using Entry = std::pair<std::uint64_t, std::uint32_t>;
  std::vector<Entry> entries;
  note_crowded();
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    find_cheapest(v);
    if (to[v] != kNoVertex) entries.emplace_back(key(v), v);
  }
  std::priority_queue queue(std::greater<>(), std::move(entries));
  const auto look = [&](std::uint32_t v) {
    find_cheapest(v);
    if (to[v] != kNoVertex) queue.emplace(key(v), v);
  };
  // If a cheaper collapse is blocked, a change nearby may enable it. Retrying at every change would dominate the time.
  std::vector<std::uint32_t> later;
  std::vector<std::uint8_t> is_later(x.size(), 0);
  std::vector<std::uint32_t> hubs;
  while (true) {
    if (queue.empty()) {
      if (later.empty()) break;
      for (const std::uint32_t v : std::exchange(later, {})) {
        is_later[v] = 0;
        if (blocked[v] && merged_into[v] == kNoVertex) look(v);
      }
      continue;
    }
    const auto [k, v] = queue.top();
    queue.pop();
    if (to[v] == kNoVertex || key(v) != k) continue;  // outdated
    const std::uint32_t w = to[v];
    const Collapse merged = measure(v, w);
    if (!possible(v, merged)) {
      look(v);
      continue;
    }
    const std::size_t start = around.size();
    around.resize(start + valence[v] + valence[w]);
    --left, left_triangles -= lost(v, w);
    collapse(v, merged.position, start);
    look(w);
    for (const std::uint32_t r : ring(w))
      for (const std::uint32_t u : triangles[r])
        if (to[u] == v || to[u] == w) {
          look(u);
        } else if (blocked[u] && !std::exchange(is_later[u], std::uint8_t{1})) {
          later.push_back(u);
        }
    note_hubs(w, hubs);
    settle_hubs(hubs, look);
  }
}

}  // namespace sansmesh::inline v1::detail
