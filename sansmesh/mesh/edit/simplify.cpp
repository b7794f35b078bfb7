#include "sansmesh/mesh/edit/simplify.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/edit/collapse_cheapest.h"
#include "sansmesh/mesh/edit/collapse_patches.h"
#include "sansmesh/mesh/edit/edge_collapses.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint64_t kNoKey = std::numeric_limits<std::uint64_t>::max();
constexpr int kMostRounds = 200;
constexpr double kValueShare = 0.002;  // distance as bad as the range of a colour or attribute, over the diagonal
constexpr double kFirstStage = 16;     // the errors of the stages double from this fraction of the limit

struct Simplifier : detail::EdgeCollapses {
  // Least key of the collapses with a vertex as an end, and of those that change its ring.
  std::vector<std::uint64_t> end_claim, ring_claim;
  detail::VertexValues values;
  std::vector<double> weight;  // share of each vertex in the properties of the merged one

  using EdgeCollapses::EdgeCollapses;

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

  /// Winning collapses share no triangle, and no two of them change the ring of a vertex.
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

  /// Runs rounds of independent collapses until hardly any are left. Starts with those at `open` vertices; continues
  /// with those that these affect.
  void collapse_all(Progress& progress, const std::vector<std::uint32_t>& open) {
    std::vector<std::uint32_t> changed, candidates, chosen, hubs;
    std::vector<std::size_t> start;
    for (const std::uint32_t v : open)
      if (merged_into[v] == kNoVertex) changed.push_back(v);
    const std::size_t many = changed.size();
    std::vector<std::uint8_t> flag(x.size(), 0);
    note_crowded();
    end_claim.resize(x.size(), kNoKey), ring_claim.resize(x.size(), kNoKey);
    for (int round = 0; round < kMostRounds; ++round) {
      progress.check();
      parallel_for(0, changed.size(), 512, [&](std::size_t i) { find_cheapest(changed[i]); });
      // Candidates: those that did not win the last round, and those with changed surroundings.
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
      for (const std::uint32_t v : candidates) drop_claim(v);

      pack_rings();
      start.resize(chosen.size());
      std::size_t end = around.size();
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        start[i] = end;
        end += valence[chosen[i]] + valence[to[chosen[i]]];
      }
      around.resize(end);
      std::vector<std::uint32_t> kept(chosen.size());
      for (std::size_t i = 0; i < chosen.size(); ++i) kept[i] = to[chosen[i]];
      // A change of a neighbour since the cost was computed may have made it impossible. Tests all before performing
      // any: the test reads the valence of vertices that another collapse may change.
      parallel_for(0, chosen.size(), 256,
                   [&](std::size_t i) { won[i] = possible(chosen[i], measure(chosen[i], kept[i])); });
      std::vector<std::uint8_t> going(chosen.size());
      for (std::size_t i = 0; i < chosen.size(); ++i) going[i] = static_cast<std::uint8_t>(lost(chosen[i], kept[i]));
      parallel_for(0, chosen.size(), 256, [&](std::size_t i) {
        if (won[i]) collapse(chosen[i], measure(chosen[i], kept[i]).position, start[i]);
      });
      changed.clear();
      std::size_t count = 0, gone = 0;
      const auto change = [&](std::uint32_t v) {
        if (!flag[v]) flag[v] = 1, changed.push_back(v);
      };
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (!won[i]) {
          change(chosen[i]);
          continue;
        }
        ++count, gone += going[i];
        // The edges of the merged vertex became more expensive: other vertices need a new choice only if it was theirs.
        change(kept[i]);
        for (const std::uint32_t r : ring(kept[i]))
          for (const std::uint32_t w : triangles[r])
            if (to[w] == chosen[i] || to[w] == kept[i] || blocked[w]) change(w);
        note_hubs(kept[i], hubs);
      }
      settle_hubs(hubs, change);
      for (const std::uint32_t v : changed) flag[v] = 0;
      left -= count, left_triangles -= gone;
      if (count * 300 <= std::min(left, many)) break;
    }
  }

  /// Share of every 64th vertex with a collapse within the error.
  double share_to_go() {
    constexpr std::size_t kStride = 64;
    const std::size_t looked = (x.size() + kStride - 1) / kStride;
    parallel_for(0, looked, 256, [&](std::size_t i) { find_cheapest(static_cast<std::uint32_t>(i * kStride)); });
    std::size_t can = 0;
    for (std::size_t v = 0; v < x.size(); v += kStride) can += to[v] != kNoVertex;
    return looked > 0 ? static_cast<double>(can) / static_cast<double>(looked) : 0;
  }

  void run(Progress& progress) {
    const std::size_t target = options.triangles > 0 ? std::max<std::size_t>(options.triangles, 4) : 0;
    original.resize(triangles.size());
    std::iota(original.begin(), original.end(), 0u);
    if (target > 0) {
      weight = detail::collapse_cheapest(*this, target, std::move(values), progress);
      pack_triangles();
      return;
    }
    std::vector<std::uint32_t> open;
    if (options.in_patches && x.size() > detail::kPatch) {
      open = detail::collapse_patches(*this, progress);
    } else {
      open.resize(x.size());
      std::iota(open.begin(), open.end(), 0u);
      // In stages: with the full error at once nearly every edge would be a candidate, and most would wait for cheaper
      // neighbours for many rounds.
      for (error = options.error / kFirstStage; error < options.error; error *= 2) collapse_all(progress, open);
    }
    error = options.error;
    collapse_all(progress, open);
    pack_triangles();
  }
};

/// Colours and real attributes of the vertices. The range of each is a share of the diagonal.
detail::VertexValues values_of(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  std::vector<std::vector<double>> columns;
  const auto add = [&](const auto& get) {
    std::vector<double> column(n);
    for (std::size_t v = 0; v < n; ++v) column[v] = get(v);
    if (std::any_of(column.begin(), column.end(), [](double x) { return !std::isfinite(x); })) return;
    const auto [least, most] = std::minmax_element(column.begin(), column.end());
    const double low = *least, range = *most - low;
    if (!(range > 0 && std::isfinite(range))) return;
    for (double& x : column) x = (x - low) / range;
    columns.push_back(std::move(column));
  };
  for (std::size_t k = 0; k < 3 && !mesh.colors.empty(); ++k)
    add([&](std::size_t v) { return double(mesh.colors[v][k]); });
  for (const Attribute& a : mesh.attributes)
    for (std::size_t k = 0; k < a.components && is_real(a.type()); ++k)
      if (columns.size() < detail::VertexValues::kMost)
        add([&](std::size_t v) { return a.number(v * a.components + k); });
  detail::VertexValues values;
  values.columns = columns.size();
  values.of.resize(values.columns * n);
  const double length = kValueShare * bounds(mesh).diagonal();
  for (std::size_t k = 0; k < values.columns; ++k)
    for (std::size_t v = 0; v < n; ++v) values.of[v * values.columns + k] = length * columns[k][v];
  return values;
}

std::uint32_t scattered(const Vec3f& p) {
  std::uint64_t h = 0;
  for (std::size_t k = 0; k < 3; ++k) h = (h ^ h >> 29 ^ std::bit_cast<std::uint32_t>(p[k])) * 0x9e3779b97f4a7c15u;
  return static_cast<std::uint32_t>(h >> 32);
}

/// Replaces the vertices and triangles of a mesh by the simplified ones. Vertices get the means, weighted by `weight`,
/// of the properties of those merged into them; `becomes` as in simplify_mesh.
void take_simplified(TriangleMesh& mesh, Simplifier& s, const Vec3& middle, std::vector<std::uint32_t>* becomes) {
  const std::vector<double>& weight = s.weight;
  const std::size_t n = mesh.vertices.size();
  std::vector<std::uint32_t> into(n), left;
  for (std::uint32_t v = 0; v < n; ++v)
    if (s.merged_into[v] == kNoVertex) into[v] = static_cast<std::uint32_t>(left.size()), left.push_back(v);
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t t = v;
    while (s.merged_into[t] != kNoVertex) t = s.merged_into[t];
    into[v] = into[t];
  }
  if (becomes) *becomes = into;
  const auto merge = [&](auto get, auto set) {
    std::vector<Vec3> sum(left.size());
    std::vector<double> total(left.size());
    for (std::size_t v = 0; v < n; ++v) {
      for (std::size_t k = 0; k < 3; ++k) sum[into[v]][k] += weight[v] * get(v, k);
      total[into[v]] += weight[v];
    }
    for (std::size_t i = 0; i < left.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) set(left[i], k, sum[i][k] / total[i]);
  };
  if (!mesh.normals.empty()) {
    merge([&](std::size_t v, std::size_t k) { return mesh.normals[v][k]; },
          [&](std::size_t v, std::size_t k, double value) { mesh.normals[v][k] = static_cast<float>(value); });
    for (Vec3f& normal : mesh.normals) normal = normalized(normal);
  }
  if (!mesh.colors.empty())
    merge([&](std::size_t v, std::size_t k) { return static_cast<double>(mesh.colors[v][k]); },
          [&](std::size_t v, std::size_t k, double value) {
            mesh.colors[v][k] = index_in<std::uint8_t>(std::round(value), 0, 255);
          });
  AttributeTable attributes;
  if (!mesh.attributes.empty()) attributes = mesh.attributes.means(into, weight, left.size());
  mesh.attributes.clear();
  for (const std::uint32_t v : left) mesh.vertices[v] = Vec3f(s.x[v] + middle);
  take_vertices(mesh, left);
  mesh.attributes = std::move(attributes);
  mesh.triangles = std::move(s.triangles);
  if (!mesh.triangle_attributes.empty()) mesh.triangle_attributes = mesh.triangle_attributes.taken(s.original);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = into[v];
}

}  // namespace

bool simplify_mesh(TriangleMesh& mesh, const CollapseOptions& options, Progress& progress,
                   std::vector<std::uint32_t>* from, std::vector<std::uint32_t>* becomes) {
  options.validate();
  const std::size_t n = mesh.vertices.size();
  const Vec3 middle(bounds(mesh).center());  // quadrics are more accurate near the origin
  Simplifier s(options, n, std::move(mesh.triangles));
  s.limit.assign(options.limits.begin(), options.limits.end());
  if (becomes) {  // initial value, valid if nothing changes
    becomes->resize(n);
    std::iota(becomes->begin(), becomes->end(), 0u);
  }
  s.weight.resize(n);  // areas, unless `run` replaces them
  parallel_for(0, n, 8192, [&](std::size_t v) {
    s.x[v] = Vec3(mesh.vertices[v]) - middle;
    s.chance[v] = scattered(mesh.vertices[v]);
  });
  parallel_for(0, n, 2048, [&](std::size_t v) {
    s.prepare(static_cast<std::uint32_t>(v));
    s.weight[v] = std::max(s.quadric[v].weight, 1e-300);
  });
  if (options.least_gain > 0 && s.share_to_go() < options.least_gain) {
    mesh.triangles = std::move(s.triangles);
    if (from) {
      from->resize(mesh.triangles.size());
      std::iota(from->begin(), from->end(), 0u);
    }
    return false;
  }
  if (options.triangles > 0) s.values = values_of(mesh);
  s.run(progress);
  if (from) *from = s.original;
  if (s.left == n) {
    if (!mesh.triangle_attributes.empty()) mesh.triangle_attributes = mesh.triangle_attributes.taken(s.original);
    mesh.triangles = std::move(s.triangles);
    return false;
  }
  take_simplified(mesh, s, middle, becomes);
  return true;
}

}  // namespace sansmesh::inline v1
