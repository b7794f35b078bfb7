#include "sansmesh/mesh/edit/collapse_cheapest.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <queue>
#include <span>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kLeastCosine = 0.1;  // between a triangle's normals before and after a collapse
/// Share of the quadric's trace that draws the optimum towards the middle of the edge, for directions in which the
/// triangles are flat.
constexpr double kWeakTether = 1e-5;
/// The volume determines a vertex if the sum of the area normals is at least this share of the area.
constexpr double kLeastFacing = 0.2;
constexpr double kStale = 1.001;  // factor by which a cost may have grown since it was queued
constexpr std::size_t kBetweenChecks = 4096;

/// Plane of a triangle: n·x = d with |n| twice its area.
struct AreaPlane {
  Vec3 n;
  double d = 0;
  double inverse = 0;  ///< 1/|n|; 0 for triangles without area
};

/// Sums over triangles.
struct PlaneSums {
  Quadric quadric;  ///< weights: twice the areas
  Vec3 n;
  double d = 0;

  void add(const AreaPlane& p, double factor = 1) {
    if (!(p.inverse > 0)) return;
    const Vec3 m = p.n * (factor * p.inverse);
    quadric.xx += m.x * p.n.x, quadric.xy += m.x * p.n.y, quadric.xz += m.x * p.n.z;
    quadric.yy += m.y * p.n.y, quadric.yz += m.y * p.n.z, quadric.zz += m.z * p.n.z;
    quadric.b += m * p.d;
    quadric.c += factor * p.inverse * p.d * p.d;
    quadric.weight += factor / p.inverse;
    n += p.n * factor;
    d += factor * p.d;
  }
};

/// Weighted sums over triangles of the gradients g and offsets o of a value g·x + o.
struct ValueSums {
  Vec3 g;
  double o = 0;
};

/// Collapse of an edge.
struct Merge {
  std::uint32_t from, into;
  double share;  ///< share of `from` in the properties of the merged vertex
};

struct CheapestEdges {
  using Collapse = EdgeCollapses::Collapse;
  using Entry = std::pair<std::uint64_t, std::uint32_t>;

  EdgeCollapses& mesh;
  VertexValues values;
  std::vector<AreaPlane> plane;    // per triangle
  std::vector<PlaneSums> sums;     // per vertex, of its triangles
  std::vector<Quadric> borders;    // planes along the original borders, per vertex; empty if there are none
  std::vector<Quadric> originals;  // planes of the original triangles, per vertex; only with limits
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<Merge> merges;
  double cost_unit = 1;
  std::vector<std::uint32_t> gone;  // collapsed triangles in the rings of waiting vertices, per vertex

  CheapestEdges(EdgeCollapses& m, VertexValues v) : mesh(m), values(std::move(v)) {}

  AreaPlane plane_of(const Triangle& t) const {
    const Vec3& p = mesh.x[t[0]];
    const Vec3 n = cross(mesh.x[t[1]] - p, mesh.x[t[2]] - p);
    const double size = norm(n);
    return {n, dot(n, p), size > 0 ? 1 / size : 0};
  }

  void sum_up(std::uint32_t v) {
    sums[v] = {};
    for (const std::uint32_t i : mesh.ring(v)) sums[v].add(plane[i]);
  }

  /// Triangles of an edge; at most two.
  std::span<const std::uint32_t> shared(std::uint32_t a, std::uint32_t b, std::array<std::uint32_t, 2>& at) const {
    std::size_t count = 0;
    for (const std::uint32_t i : mesh.ring(a)) {
      const Triangle& t = mesh.triangles[i];
      if ((t[0] == b || t[1] == b || t[2] == b) && count < 2) at[count++] = i;
    }
    return std::span(at).first(count);
  }

  /// Adds the error of the values: the variance at x of the values that the triangles around the edge extend to x.
  void add_values(std::uint32_t a, std::uint32_t b, Quadric& q) const {
    const std::size_t columns = values.columns;
    std::array<ValueSums, VertexValues::kMost> sum;
    double weight = 0;
    const auto add = [&](std::uint32_t i) {
      const AreaPlane& p = plane[i];
      if (!(p.inverse > 0)) return;
      const Triangle& t = mesh.triangles[i];
      const double w = 1 / p.inverse;
      weight += w;
      const double* const at[] = {&values.of[t[0] * columns], &values.of[t[1] * columns], &values.of[t[2] * columns]};
      // Gradients of the barycentric coordinates of the last two corners.
      const Vec3 n = p.n * (p.inverse * p.inverse), &x = mesh.x[t[0]];
      const Vec3 g1 = cross(n, x - mesh.x[t[2]]), g2 = cross(n, mesh.x[t[1]] - x);
      for (std::size_t column = 0; column < columns; ++column) {
        const Vec3 g = g1 * (at[1][column] - at[0][column]) + g2 * (at[2][column] - at[0][column]);
        const double o = at[0][column] - dot(g, x);
        q.add_plane(g, -o, w);
        sum[column].g += g * w, sum[column].o += o * w;
      }
    };
    const double area = q.weight;
    for (const std::uint32_t i : mesh.ring(a)) add(i);
    for (const std::uint32_t i : mesh.ring(b)) {
      const Triangle& t = mesh.triangles[i];
      if (t[0] != a && t[1] != a && t[2] != a) add(i);
    }
    for (std::size_t column = 0; column < columns && weight > 0; ++column)
      q.add_plane(sum[column].g / weight, -sum[column].o / weight, -weight);
    q.weight = area;
  }

  Collapse measure(std::uint32_t a, std::uint32_t b) const {
    PlaneSums s = sums[a];
    s.quadric += sums[b].quadric;
    s.n += sums[b].n;
    s.d += sums[b].d;
    std::array<std::uint32_t, 2> at;
    for (const std::uint32_t i : shared(a, b, at)) s.add(plane[i], -1);
    Quadric& q = s.quadric;
    const double area = q.weight;
    if (!borders.empty()) q += borders[a], q += borders[b];
    if (values.columns > 0) add_values(a, b, q);
    const Vec3 middle = (mesh.x[a] + mesh.x[b]) * 0.5;
    const double t = kWeakTether * (q.xx + q.yy + q.zz);
    const Matrix3 m{{q.xx + t, q.xy, q.xz}, {q.xy, q.yy + t, q.yz}, {q.xz, q.yz, q.zz + t}};
    if (!(std::abs(m.determinant()) > 0)) return {b, std::max(0.0, q.at(middle)), middle};
    Vec3 p = m.solve(q.b + middle * t);
    if (squared_norm(s.n) > kLeastFacing * kLeastFacing * area * area) {
      const Vec3 along = m.solve(s.n);
      const double gain = dot(s.n, along);
      const Vec3 shift = gain > 0 ? along * ((s.d - dot(s.n, p)) / gain) : Vec3{};
      if (squared_norm(shift) < squared_norm(mesh.x[a] - mesh.x[b])) p += shift;
    }
    if (!is_finite(p)) p = middle;  // the determinant may be denormal
    return {b, std::max(0.0, q.at(p)), p};
  }

  /// A cost as it is stored: in units in which the mesh has the size 1, because floats have not the range of volumes.
  float stored(double cost) const { return static_cast<float>(std::min(cost * cost_unit, 1e30)); }

  bool within_limits(std::uint32_t a, const Collapse& c) const {
    if (mesh.limit.empty()) return true;
    Quadric q = originals[a];
    q += originals[c.with];
    const double most = std::min(mesh.limit[a], mesh.limit[c.with]);
    return q.at(c.position) <= most * most * q.weight;
  }

  bool possible(std::uint32_t a, const Collapse& c) const {
    double worst = mesh.options.least_shape;
    for (const std::uint32_t v : {a, c.with})
      for (const std::uint32_t i : mesh.ring(v)) worst = std::min(worst, mesh.shape_of(mesh.triangles[i]));
    return within_limits(a, c) && mesh.possible(a, c, {.shape = worst, .cosine = kLeastCosine});
  }

  /// Computes `to`, `cost` and `blocked` of a vertex.
  void find_cheapest(std::uint32_t v) {
    const auto later = [&](std::uint32_t w, Collapse& c) {
      if (w > v) c = measure(v, w);
      return w > v;
    };
    if (const auto best = mesh.cheapest(v, later, [&](const Collapse& c) { return possible(v, c); }))
      mesh.cost[v] = stored(best->cost);
  }

  Entry entry(std::uint32_t v) const {
    return {std::uint64_t{std::bit_cast<std::uint32_t>(mesh.cost[v])} << 32 | mesh.chance[v], v};
  }

  void look(std::uint32_t v) {
    find_cheapest(v);
    if (mesh.to[v] != kNoVertex) queue.push(entry(v));
  }

  void prepare() {
    Box3 box;
    for (const Vec3& x : mesh.x) box.extend(x);
    const double size = box.diagonal();
    cost_unit = size > 0 ? 1 / (size * size) / (size * size) : 1;
    plane.resize(mesh.triangles.size());
    sums.resize(mesh.x.size());
    gone.resize(mesh.x.size(), 0);
    parallel_for(0, plane.size(), 8192, [&](std::size_t i) { plane[i] = plane_of(mesh.triangles[i]); });
    parallel_for(0, sums.size(), 4096, [&](std::size_t v) { sum_up(static_cast<std::uint32_t>(v)); });
    if (std::any_of(mesh.border.begin(), mesh.border.end(), [](std::uint8_t b) { return b != 0; })) {
      borders.resize(mesh.x.size());
      for (std::uint32_t v = 0; v < borders.size(); ++v) mesh.add_borders(v, borders[v]);
    }
    if (!mesh.limit.empty()) originals = mesh.quadric;
    mesh.note_crowded();
    parallel_for(0, sums.size(), 512, [&](std::size_t v) { find_cheapest(static_cast<std::uint32_t>(v)); });
    std::vector<Entry> entries;
    for (std::uint32_t v = 0; v < sums.size(); ++v)
      if (mesh.to[v] != kNoVertex) entries.push_back(entry(v));
    queue = decltype(queue)(std::greater<>(), std::move(entries));
  }

  /// Removes collapsed triangles from the ring of a waiting vertex at w once they are many, or few others are left.
  void settle(std::uint32_t w) {
    for (const std::uint32_t i : mesh.ring(w))
      for (const std::uint32_t u : mesh.triangles[i]) {
        if (!mesh.is_waiting(u) || (4 * gone[u] < mesh.valence[u] && mesh.valence[u] - gone[u] > kMostRing)) continue;
        std::vector<std::uint32_t> hub{u};
        mesh.settle_hubs(hub, [](std::uint32_t) {});
        gone[u] = 0;
        if (mesh.is_waiting(u)) continue;
        sum_up(u);
        for (const std::uint32_t r : mesh.ring(u))
          for (const std::uint32_t o : mesh.triangles[r]) look(o);
        return;  // one at a time: this may have changed the ring of w
      }
  }

  void merge(std::uint32_t v, const Collapse& c) {
    const std::uint32_t w = c.with;
    std::array<std::uint32_t, 2> at;
    for (const std::uint32_t i : shared(v, w, at))
      for (const std::uint32_t u : mesh.triangles[i]) gone[u] += mesh.is_waiting(u);
    take_properties(v, c);
    if (!borders.empty()) borders[w] += borders[v];
    if (!originals.empty()) originals[w] += originals[v];
    mesh.left_triangles -= mesh.lost(v, w);
    --mesh.left;
    const std::size_t start = mesh.around.size();
    mesh.around.resize(start + mesh.valence[v] + mesh.valence[w]);
    mesh.collapse(v, c.position, start);
    for (const std::uint32_t i : mesh.ring(w)) plane[i] = plane_of(mesh.triangles[i]);
    sum_up(w);
    for_neighbours(w, [&](std::uint32_t u) {
      if (!mesh.is_waiting(u)) sum_up(u);
    });
  }

  template <class Do>
  void for_neighbours(std::uint32_t w, const Do& run) const {
    for (const std::uint32_t i : mesh.ring(w)) {
      const Triangle& t = mesh.triangles[i];
      run(EdgeCollapses::after(t, w));
      if (mesh.border[w]) run(EdgeCollapses::before(t, w));
    }
  }

  /// Properties of the merged vertex are between those of the edge, at the projection of its position.
  void take_properties(std::uint32_t v, const Collapse& c) {
    const Vec3 edge = mesh.x[c.with] - mesh.x[v];
    const double length = squared_norm(edge);
    const double t = length > 0 ? std::clamp(dot(c.position - mesh.x[v], edge) / length, 0.0, 1.0) : 0.5;
    merges.push_back({v, c.with, 1 - t});
    for (std::size_t column = 0; column < values.columns; ++column) {
      double& value = values.of[c.with * values.columns + column];
      value += (1 - t) * (values.of[v * values.columns + column] - value);
    }
  }

  std::vector<double> weights() const {
    std::vector<double> weight(mesh.x.size(), 1);
    for (std::size_t i = merges.size(); i-- > 0;) {
      const Merge& m = merges[i];
      weight[m.from] = weight[m.into] * m.share;
      weight[m.into] *= 1 - m.share;
    }
    return weight;
  }

  void run(std::size_t target, Progress& progress) {
    prepare();
    std::size_t steps = 0, merged_before = mesh.left;
    while (mesh.left_triangles > target) {
      if (++steps % kBetweenChecks == 0) {
        progress.check();
        mesh.pack_rings();
      }
      if (queue.empty()) {  // collapses that were not possible may be now
        if (mesh.left == merged_before) break;
        merged_before = mesh.left;
        for (std::uint32_t v = 0; v < mesh.x.size(); ++v)
          if (mesh.blocked[v] && mesh.merged_into[v] == kNoVertex) look(v);
        continue;
      }
      const Entry top = queue.top();
      queue.pop();
      const std::uint32_t v = top.second, w = mesh.to[v];
      if (w == kNoVertex || entry(v) != top) continue;  // outdated
      const Collapse c = measure(v, w);
      if (static_cast<double>(stored(c.cost)) > kStale * static_cast<double>(mesh.cost[v]) || !possible(v, c)) {
        look(v);
        continue;
      }
      merge(v, c);
      look(w);
      for_neighbours(w, [&](std::uint32_t u) { look(u); });
      if (!mesh.waits.empty()) settle(w);
    }
  }
};

}  // namespace

std::vector<double> collapse_cheapest(EdgeCollapses& mesh, std::size_t target, VertexValues values,
                                      Progress& progress) {
  CheapestEdges edges(mesh, std::move(values));
  if (mesh.left_triangles > target) edges.run(target, progress);
  return edges.weights();
}

}  // namespace sansmesh::inline v1::detail
