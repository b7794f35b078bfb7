#include "sansmesh/mesh/simplify.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh {
namespace {

constexpr std::uint64_t kNoKey = std::numeric_limits<std::uint64_t>::max();
constexpr double kTurn = 0.5;          // least cosine between a triangle's normals before and after
constexpr double kTether = 1e-3;       // share of the quadric's trace that ties the optimum to the edge's centroid
constexpr double kNoArea = 1e-6;       // twice the area / Σ l²: below, rounding decides where the normal points
constexpr std::size_t kMostRing = 24;  // triangles around a vertex
constexpr int kMostRounds = 200;
constexpr double kFirstStage = 16;  // the errors of the stages double from this part of what is accepted

/// Σ w (n·x − d)² over planes, as xᵀ A x − 2 b·x + c, and Σ w.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0, weight = 0;

  void add_plane(const Vec3& n, double d, double w) {
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
    b += n * (w * d);
    c += w * d * d;
    weight += w;
  }
  Quadric& operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b;
    c += o.c, weight += o.weight;
    return *this;
  }
  double at(const Vec3& x) const {
    return x.x * (xx * x.x + 2 * (xy * x.y + xz * x.z)) + x.y * (yy * x.y + 2 * yz * x.z) + zz * x.z * x.z -
           2 * dot(b, x) + c;
  }
  /// Where it is least, held near `tether` in the directions that the planes leave open.
  Vec3 minimum(const Vec3& tether) const {
    const double t = kTether * (xx + yy + zz);
    const double a00 = xx + t, a11 = yy + t, a22 = zz + t;
    const Vec3 r = b + tether * t;
    const Matrix3 a{{a00, xy, xz}, {xy, a11, yz}, {xz, yz, a22}};
    return std::abs(a.determinant()) > 1e-300 ? a.solve(r) : tether;
  }
};

struct Simplifier {
  const SimplifyOptions& options;
  double error;  ///< accepted now
  std::vector<Vec3> x;
  std::vector<Quadric> quadric;
  std::vector<double> own_weight;  ///< before anything merged
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> original;  ///< in the end: the number that each triangle had
  std::vector<std::uint8_t> fixed;
  std::vector<std::uint32_t> merged_into;  ///< kNoVertex: alive
  // Triangles around each vertex: around[first .. first + valence]. A merged ring gets a new place at the end; places
  // that were given up go when they are as many as those in use.
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> valence, around;
  // The cheapest collapse of an edge from a vertex to one of higher index.
  std::vector<std::uint32_t> to;
  std::vector<float> cost;
  std::vector<std::uint8_t> blocked;  ///< a cheaper one would have spoilt the shape: worth another try after changes
  // The least key of the collapses that have a vertex as an end, and of those that change its ring.
  std::vector<std::uint64_t> end_claim, ring_claim;
  std::size_t left;  ///< vertices

  Simplifier(const SimplifyOptions& o, const std::vector<Vec3f>& vertices, std::vector<Triangle> all,
             const Vec3& middle)
      : options(o),
        error(o.error),
        x(vertices.size()),
        quadric(x.size()),
        own_weight(x.size()),
        triangles(std::move(all)),
        fixed(x.size(), 0),
        merged_into(x.size(), kNoVertex),
        to(x.size(), kNoVertex),
        cost(x.size(), 0),
        blocked(x.size(), 0),
        end_claim(x.size(), kNoKey),
        ring_claim(x.size(), kNoKey),
        left(x.size()) {
    parallel_for(0, x.size(), 8192, [&](std::size_t v) { x[v] = Vec3(vertices[v]) - middle; });
    build_rings();
  }

  std::span<const std::uint32_t> ring(std::uint32_t v) const { return {around.data() + first[v], valence[v]}; }

  void build_rings() {
    valence.assign(x.size(), 0);
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) ++valence[v];
    around.resize(place_rings(first));
    std::vector<std::size_t> next = first;
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (const std::uint32_t v : triangles[i]) around[next[v]++] = static_cast<std::uint32_t>(i);
  }

  /// Places for all rings, one after the other; returns where they end.
  std::size_t place_rings(std::vector<std::size_t>& place) const {
    place.resize(x.size());
    std::size_t sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v) place[v] = sum, sum += valence[v];
    return sum;
  }

  /// Gives up the places of rings that were merged, if they are as many as those of the rings that are left: each
  /// collapse needs a place for two rings, and without this they would add up to three times the mesh.
  void pack_rings() {
    const std::size_t used = 3 * triangles.size() - 6 * (x.size() - left);  // a collapse takes two triangles away
    if (around.size() <= 2 * used) return;
    std::vector<std::size_t> place;
    std::vector<std::uint32_t> packed(place_rings(place));
    parallel_for(0, x.size(), 8192, [&](std::size_t v) {
      std::copy_n(around.begin() + static_cast<std::ptrdiff_t>(first[v]), valence[v],
                  packed.begin() + static_cast<std::ptrdiff_t>(place[v]));
    });
    first = std::move(place);
    around = std::move(packed);
  }

  /// The quadric of a vertex; and vertices whose triangles are not one closed fan stay: boundaries, and what is not
  /// manifold. So do those of a triangle without area: it has no plane to hold them, and no normal by which to see that
  /// it turns over, so a strip of such triangles along a crease would open like a fan.
  void prepare(std::uint32_t v) {
    fixed[v] = !closed_fan(v);
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
  }

  bool closed_fan(std::uint32_t v) const {
    std::array<std::array<std::uint32_t, 2>, kMostRing> link;
    const auto r = ring(v);
    if (r.size() < 3 || r.size() > kMostRing) return false;
    for (std::size_t k = 0; k < r.size(); ++k) {
      const Triangle& t = triangles[r[k]];
      const std::size_t at = t[0] == v ? 0 : t[1] == v ? 1 : 2;
      link[k] = {t[(at + 1) % 3], t[(at + 2) % 3]};
    }
    std::uint32_t here = link[0][1];
    for (std::size_t steps = 1;; ++steps) {
      if (here == link[0][0]) return steps == r.size();
      std::size_t found = r.size(), count = 0;
      for (std::size_t k = 0; k < r.size(); ++k)
        if (link[k][0] == here) found = k, ++count;
      if (count != 1 || steps >= r.size()) return false;
      here = link[found][1];
    }
  }

  struct Collapse {
    std::uint32_t with = kNoVertex;
    double cost = 0;  ///< mean squared distance
    Vec3 position;
  };

  /// The vertex after v in a triangle: over a closed fan, each neighbour once.
  static std::uint32_t after(const Triangle& t, std::uint32_t v) { return t[0] == v ? t[1] : t[1] == v ? t[2] : t[0]; }

  /// The ends of the edge have two neighbours in common, those opposite to it, and these keep three triangles.
  bool link_condition(std::uint32_t a, std::uint32_t b) const {
    std::array<std::uint32_t, kMostRing> neighbours;
    std::size_t n = 0, common = 0;
    for (const std::uint32_t i : ring(a)) neighbours[n++] = after(triangles[i], a);
    for (const std::uint32_t i : ring(b)) {
      const std::uint32_t v = after(triangles[i], b);
      if (std::find(neighbours.begin(), neighbours.begin() + n, v) == neighbours.begin() + n) continue;
      if (++common > 2 || valence[v] < 4) return false;
    }
    return common == 2;
  }

  bool keeps_shape(std::uint32_t moved, std::uint32_t other, const Vec3& p) const {
    for (const std::uint32_t i : ring(moved)) {
      const Triangle& t = triangles[i];
      if (t[0] == other || t[1] == other || t[2] == other) continue;
      const std::size_t at = t[0] == moved ? 0 : t[1] == moved ? 1 : 2;
      const Vec3 &q = x[t[(at + 1) % 3]], &r = x[t[(at + 2) % 3]];
      const Vec3 before = cross(q - x[moved], r - x[moved]), after = cross(q - p, r - p);
      const double area_before = norm(before), area_after = norm(after);
      if (dot(before, after) < kTurn * area_before * area_after || !(area_after > 0)) return false;
      const double sum_after = squared_norm(q - p) + squared_norm(r - p) + squared_norm(q - r);
      const double shape = 2 * std::sqrt(3.0) * area_after / sum_after;
      if (shape >= options.least_shape) continue;
      const double sum_before = squared_norm(q - x[moved]) + squared_norm(r - x[moved]) + squared_norm(q - r);
      if (shape < 2 * std::sqrt(3.0) * area_before / sum_before) return false;
    }
    return true;
  }

  Collapse measure(std::uint32_t a, std::uint32_t b) const {
    Quadric q = quadric[a];
    q += quadric[b];
    const Vec3 p = q.minimum((x[a] * quadric[a].weight + x[b] * quadric[b].weight) / q.weight);
    return {b, std::max(0.0, q.at(p)) / q.weight, p};
  }

  bool possible(std::uint32_t a, const Collapse& c) const {
    return valence[a] + valence[c.with] <= kMostRing + 4 && link_condition(a, c.with) &&
           keeps_shape(a, c.with, c.position) && keeps_shape(c.with, a, c.position);
  }

  void find_cheapest(std::uint32_t v) {
    to[v] = kNoVertex;
    blocked[v] = 0;
    if (fixed[v]) return;
    std::array<Collapse, kMostRing> all;
    std::size_t n = 0;
    for (const std::uint32_t i : ring(v)) {
      const Triangle& t = triangles[i];
      const std::uint32_t w = after(t, v);
      if (w < v || fixed[w] || !(quadric[v].weight + quadric[w].weight > 0)) continue;
      all[n] = measure(v, w);
      n += all[n].cost <= error * error;
    }
    while (n > 0) {  // the costly tests only for the cheapest one, and for the next one if it fails
      const auto best = std::min_element(all.begin(), all.begin() + n, [](const Collapse& a, const Collapse& b) {
        return a.cost != b.cost ? a.cost < b.cost : a.with < b.with;
      });
      if (possible(v, *best)) {
        to[v] = best->with;
        cost[v] = static_cast<float>(best->cost);
        return;
      }
      *best = all[--n];
      blocked[v] = 1;
    }
  }

  /// Cheapest first, but costs within a factor of two count as equal and chance decides: where costs rise steadily
  /// over the mesh there would be few that are cheapest among their surroundings.
  std::uint64_t key(std::uint32_t v) const {
    const std::uint32_t chance = v * 2654435761u;  // odd, hence different for each vertex
    return std::uint64_t{std::bit_cast<std::uint32_t>(cost[v]) >> 23} << 32 | chance;
  }

  /// The vertices whose ring a collapse changes: its ends, and those opposite to the edge.
  std::array<std::uint32_t, 4> touched(std::uint32_t v) const {
    const std::uint32_t w = to[v];
    std::array<std::uint32_t, 4> result{v, w, v, v};
    std::size_t n = 2;
    for (const std::uint32_t i : ring(v)) {
      const Triangle& t = triangles[i];
      if ((t[0] != w && t[1] != w && t[2] != w) || n == 4) continue;
      result[n++] = t[0] ^ t[1] ^ t[2] ^ v ^ w;
    }
    return result;
  }

  static void lower(std::uint64_t& claim, std::uint64_t key) {
    const std::atomic_ref<std::uint64_t> least(claim);
    std::uint64_t old = least.load(std::memory_order_relaxed);
    while (key < old && !least.compare_exchange_weak(old, key, std::memory_order_relaxed)) {
    }
  }

  void lay_claim(std::uint32_t v) {
    const std::uint64_t own = key(v);
    for (const std::uint32_t end : {v, to[v]}) lower(end_claim[end], own);
    for (const std::uint32_t w : touched(v)) lower(ring_claim[w], own);
  }

  void drop_claim(std::uint32_t v) {
    for (const std::uint32_t w : touched(v)) end_claim[w] = ring_claim[w] = kNoKey;
  }

  /// Those that win share no triangle, and no two of them change the ring of a vertex.
  bool wins(std::uint32_t v) const {
    const std::uint64_t own = key(v);
    for (const std::uint32_t w : touched(v))
      if (ring_claim[w] < own) return false;
    for (const std::uint32_t end : {v, to[v]})
      for (const std::uint32_t r : ring(end))
        for (const std::uint32_t w : triangles[r])
          if (end_claim[w] < own) return false;
    return true;
  }

  /// Merges v into its partner. Changes only triangles around the two and the rings of `touched`, so that those that
  /// win run at a time. `place`: room for the merged ring.
  void collapse(std::uint32_t v, std::size_t place) {
    const std::uint32_t w = to[v];
    x[w] = measure(v, w).position;
    quadric[w] += quadric[v];
    merged_into[v] = w;
    std::uint32_t count = 0;
    const auto has = [&](const Triangle& t, std::uint32_t c) { return t[0] == c || t[1] == c || t[2] == c; };
    for (const std::uint32_t i : ring(w))
      if (!has(triangles[i], v)) around[place + count++] = i;
    for (const std::uint32_t i : ring(v)) {
      Triangle& t = triangles[i];
      if (!has(t, w)) {
        around[place + count++] = i;
        for (std::uint32_t& corner : t)
          if (corner == v) corner = w;
        continue;
      }
      for (const std::uint32_t o : t) {
        if (o == v || o == w) continue;
        std::uint32_t* const begin = around.data() + first[o];
        *std::find(begin, begin + valence[o], i) = begin[valence[o] - 1];
        --valence[o];
      }
      t = {w, w, w};  // goes in the end
    }
    first[w] = place;
    valence[w] = count;
    valence[v] = 0;
    to[v] = kNoVertex;
  }

  Box3 bounds_of() const {
    Box3 box;
    for (const Vec3& p : x) box.extend(p);
    return box;
  }

  /// Rounds of collapses that share no triangle, until there are hardly any left or only `target` vertices.
  void collapse_all(Progress& progress, std::size_t target) {
    if (left <= target) return;
    std::vector<std::uint32_t> changed, candidates, chosen;
    std::vector<std::size_t> place;
    for (std::uint32_t v = 0; v < x.size(); ++v)
      if (merged_into[v] == kNoVertex) changed.push_back(v);
    std::vector<std::uint8_t> flag(x.size(), 0);
    for (int round = 0; round < kMostRounds; ++round) {
      progress.check();
      parallel_for(0, changed.size(), 512, [&](std::size_t i) { find_cheapest(changed[i]); });
      // Those that did not win the last round, and those whose surroundings changed.
      for (const std::uint32_t v : changed) flag[v] = 1;
      std::erase_if(candidates, [&](std::uint32_t v) { return flag[v] || to[v] == kNoVertex; });
      for (const std::uint32_t v : changed) {
        flag[v] = 0;
        if (to[v] != kNoVertex) candidates.push_back(v);
      }
      parallel_for(0, candidates.size(), 4096, [&](std::size_t i) { lay_claim(candidates[i]); });
      chosen.clear();
      std::vector<std::uint8_t> won(candidates.size());
      parallel_for(0, candidates.size(), 2048, [&](std::size_t i) { won[i] = wins(candidates[i]); });
      for (std::size_t i = 0; i < candidates.size(); ++i)
        if (won[i]) chosen.push_back(candidates[i]);
      if (left <= target + chosen.size()) {  // only the cheapest of the last round
        std::sort(chosen.begin(), chosen.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
        chosen.resize(left - target);
      }
      for (const std::uint32_t v : candidates) drop_claim(v);

      pack_rings();
      place.resize(chosen.size());
      std::size_t end = around.size();
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        place[i] = end;
        end += valence[chosen[i]] + valence[to[chosen[i]]];
      }
      around.resize(end);
      std::vector<std::uint32_t> kept(chosen.size());
      for (std::size_t i = 0; i < chosen.size(); ++i) kept[i] = to[chosen[i]];
      // A neighbour's change since the cost was found may have made it impossible. All are asked before any is made:
      // the answer reads the valence of vertices that another collapse may change.
      parallel_for(0, chosen.size(), 256,
                   [&](std::size_t i) { won[i] = possible(chosen[i], measure(chosen[i], kept[i])); });
      parallel_for(0, chosen.size(), 256, [&](std::size_t i) {
        if (won[i]) collapse(chosen[i], place[i]);
      });
      changed.clear();
      std::size_t count = 0;
      const auto change = [&](std::uint32_t v) {
        if (!flag[v]) flag[v] = 1, changed.push_back(v);
      };
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (!won[i]) {
          change(chosen[i]);
          continue;
        }
        ++count;
        // The edges of the merged vertex changed, for the worse: other vertices need a new choice only if it was
        // theirs.
        change(kept[i]);
        for (const std::uint32_t r : ring(kept[i]))
          for (const std::uint32_t w : triangles[r])
            if (to[w] == chosen[i] || to[w] == kept[i] || blocked[w]) change(w);
      }
      for (const std::uint32_t v : changed) flag[v] = 0;
      left -= count;
      if (count * 300 <= left || left <= target) break;
    }
  }

  /// Share of every 64th vertex that has a collapse within the error. Prepares only the vertices it looks at.
  double share_to_go() {
    constexpr std::uint32_t kStride = 64;
    std::size_t looked = 0, can = 0;
    for (std::uint32_t v = 0; v < x.size(); v += kStride, ++looked) {
      for (const std::uint32_t i : ring(v))
        for (const std::uint32_t u : triangles[i]) prepare(u);
      find_cheapest(v);
      can += to[v] != kNoVertex;
    }
    return looked > 0 ? static_cast<double>(can) / static_cast<double>(looked) : 0;
  }

  void run(Progress& progress) {
    parallel_ranges(0, x.size(), 2048, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        prepare(static_cast<std::uint32_t>(v));
        own_weight[v] = std::max(quadric[v].weight, 1e-300);
      }
    });
    // A closed mesh has two triangles per vertex, apart from its handles.
    const std::size_t most = (options.triangles + triangles.size() % 2) / 2 + x.size() - triangles.size() / 2;
    const std::size_t target = options.triangles > 0 ? std::max<std::size_t>(most, 4) : 0;
    // In stages: with all of the error at once nearly every edge would be a candidate, and most would wait for cheaper
    // ones beside them, round after round.
    for (error = options.error / kFirstStage; error < options.error; error *= 2) collapse_all(progress, target);
    error = options.error;
    collapse_all(progress, target);
    const double limit = norm(Vec3(bounds_of().size()));
    while (left > target && target > 0 && error < limit) {
      error *= 1.5;
      collapse_all(progress, target);
    }
    std::size_t kept = 0;
    original.clear();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (triangles[i][0] == triangles[i][1]) continue;
      triangles[kept++] = triangles[i];
      original.push_back(static_cast<std::uint32_t>(i));
    }
    triangles.resize(kept);
  }
};

}  // namespace

void SimplifyOptions::validate() const {
  if (!(std::isfinite(error) && error > 0)) throw ArgumentError("simplify: `error` must be a positive length");
  if (!(least_gain >= 0 && least_gain <= 1)) throw ArgumentError("simplify: `least_gain` must lie in 0..1");
  if (!(least_shape >= 0 && least_shape <= 0.9)) throw ArgumentError("simplify: `least_shape` must lie in 0..0.9");
}

bool simplify_mesh(TriangleMesh& mesh, const SimplifyOptions& options, Progress& progress) {
  options.validate();
  const std::size_t n = mesh.vertices.size();
  const Vec3 middle(bounds(mesh).center());  // near the origin quadrics lose fewer digits
  Simplifier s(options, mesh.vertices, std::move(mesh.triangles), middle);
  if (options.least_gain > 0 && s.share_to_go() < options.least_gain) {
    mesh.triangles = std::move(s.triangles);
    return false;
  }
  s.run(progress);
  if (s.left == n) {
    mesh.triangles = std::move(s.triangles);
    return false;
  }

  // What belongs to the vertices that were merged, then those that are left.
  std::vector<std::uint32_t> target(n), number(n, kNoVertex), left;
  for (std::size_t v = 0; v < n; ++v) {
    std::uint32_t t = static_cast<std::uint32_t>(v);
    while (s.merged_into[t] != kNoVertex) t = s.merged_into[t];
    target[v] = t;
    if (t != v) continue;
    number[v] = static_cast<std::uint32_t>(left.size());
    left.push_back(t);
  }
  const auto merge = [&](std::size_t components, auto get, auto set) {
    std::vector<double> sum(n * components, 0), weight(n, 0);
    for (std::size_t v = 0; v < n; ++v) {
      const double w = s.own_weight[v];
      for (std::size_t k = 0; k < components; ++k) sum[target[v] * components + k] += w * get(v, k);
      weight[target[v]] += w;
    }
    for (std::size_t v = 0; v < n; ++v)
      if (target[v] == v)
        for (std::size_t k = 0; k < components; ++k) set(v, k, sum[v * components + k] / weight[v]);
  };
  if (!mesh.normals.empty()) {
    merge(
        3, [&](std::size_t v, std::size_t k) { return mesh.normals[v][k]; },
        [&](std::size_t v, std::size_t k, double value) { mesh.normals[v][k] = static_cast<float>(value); });
    for (Vec3f& normal : mesh.normals) normal = normalized(normal);
  }
  if (!mesh.colors.empty())
    merge(
        3, [&](std::size_t v, std::size_t k) { return static_cast<double>(mesh.colors[v][k]); },
        [&](std::size_t v, std::size_t k, double value) {
          mesh.colors[v][k] = static_cast<std::uint8_t>(std::lround(value));
        });
  AttributeTable attributes;
  if (!mesh.attributes.empty()) {
    std::vector<std::uint32_t> group(n);
    for (std::size_t v = 0; v < n; ++v) group[v] = number[target[v]];
    attributes = mesh.attributes.means(group, s.own_weight, left.size());
  }
  mesh.attributes.clear();
  for (const std::uint32_t v : left) mesh.vertices[v] = Vec3f(s.x[v] + middle);
  take_vertices(mesh, left);
  mesh.attributes = std::move(attributes);
  mesh.triangles = std::move(s.triangles);
  if (!mesh.triangle_attributes.empty()) mesh.triangle_attributes = mesh.triangle_attributes.taken(s.original);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return true;
}

}  // namespace sansmesh
