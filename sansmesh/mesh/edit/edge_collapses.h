// Edge collapses of a triangle mesh: the intermediate mesh, costs, and the operation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/mesh/edit/collapse_options.h"
#include "sansmesh/mesh/edit/quadric.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

constexpr std::size_t kMostRing = 24;  ///< largest number of triangles around a vertex to be merged

/// Intermediate mesh of a simplification.
struct EdgeCollapses {
  const CollapseOptions& options;
  double error;  ///< current largest error
  std::vector<Vec3> x;
  std::vector<Quadric> quadric;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> original;  ///< original number of each triangle; filled before `pack_triangles`
  /// Tie-breaker for equal costs; derived from the position, so that it is the same for a part of the mesh.
  std::vector<std::uint32_t> chance;
  std::vector<float> limit;  ///< limit of the error per vertex, or empty
  std::vector<std::uint8_t> fixed;
  std::vector<std::uint8_t> border;        ///< 1 for vertices on a border that are not fixed
  std::vector<std::uint32_t> merged_into;  ///< kNoVertex: not merged
  // Triangles around each vertex: around[first .. first + valence]. Merged rings are appended; pack_rings removes
  // abandoned ones once they are as large as those in use.
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> valence, around;
  // Cheapest collapse of an edge from a vertex to one of higher index.
  std::vector<std::uint32_t> to;
  std::vector<float> cost;
  std::vector<std::uint8_t> blocked;  ///< a cheaper collapse failed the shape test: retry after changes
  std::vector<std::uint8_t> waits;    ///< crowded: 1, or 2 while in the list of `note_hubs`; empty if none is
  std::size_t left, left_triangles;

  EdgeCollapses(const CollapseOptions& o, std::size_t vertices, std::vector<Triangle> all);

  std::span<const std::uint32_t> ring(std::uint32_t v) const { return {around.data() + first[v], valence[v]}; }

  /// Builds the rings from the triangles.
  void build_rings();

  /// Computes consecutive positions for all rings; returns their end.
  std::size_t assign_ring_starts(std::vector<std::size_t>& start) const;

  /// Removes abandoned rings if they are as large as the current ones. Each collapse appends a ring as large as two, so
  /// that without packing they would add up to three times the mesh.
  void pack_rings();

  /// Removes collapsed triangles and rebuilds the rings.
  void pack_triangles();

  /// Whether a vertex has too many triangles to be merged: it waits until collapses around it reduce them.
  bool crowded(std::uint32_t v) const { return valence[v] > kMostRing; }

  bool is_waiting(std::uint32_t v) const { return !waits.empty() && waits[v] != 0; }

  /// Fills `waits`.
  void note_crowded();

  /// Appends each waiting vertex around w, the target of a collapse, once to `hubs`. Their rings keep the collapsed
  /// triangles for now, so that many edges around one can collapse concurrently.
  void note_hubs(std::uint32_t w, std::vector<std::uint32_t>& hubs) {
    if (waits.empty()) return;
    for (const std::uint32_t i : ring(w))
      for (const std::uint32_t u : triangles[i])
        if (waits[u] == 1) waits[u] = 2, hubs.push_back(u);
  }

  /// Removes collapsed triangles from the rings of `hubs`. Calls look(u) for vertices that no longer wait, and for
  /// their neighbours.
  template <class Look>
  void settle_hubs(std::vector<std::uint32_t>& hubs, const Look& look) {
    for (const std::uint32_t u : hubs) {
      const auto begin = around.begin() + static_cast<std::ptrdiff_t>(first[u]);
      const auto end = std::remove_if(begin, begin + valence[u],
                                      [&](std::uint32_t i) { return triangles[i][0] == triangles[i][1]; });
      valence[u] = static_cast<std::uint32_t>(end - begin);
      waits[u] = crowded(u);
      if (waits[u]) continue;
      for (const std::uint32_t i : ring(u))
        for (const std::uint32_t n : triangles[i]) look(n);
    }
    hubs.clear();
  }

  /// Adds planes along the borders at a border vertex, perpendicular to the surface, to a quadric.
  void add_borders(std::uint32_t v, Quadric& sum) const;

  /// Computes the quadric of a vertex, with `add_borders`. Fixes non-manifold vertices, whose triangles are not one
  /// fan, and vertices of triangles without area: such a triangle has no plane to hold it and no normal to detect a
  /// flip, so a strip of them along a crease would open like a fan.
  void prepare(std::uint32_t v);

  enum class Fan { none, closed, open };

  /// Classifies the triangles around a vertex.
  Fan fan_of(std::uint32_t v) const;

  struct Collapse {
    std::uint32_t with = kNoVertex;
    double cost = 0;  ///< mean squared distance
    Vec3 position;
  };

  /// Vertex after v in a triangle: over a closed fan, each neighbour occurs once.
  static std::uint32_t after(const Triangle& t, std::uint32_t v) { return t[0] == v ? t[1] : t[1] == v ? t[2] : t[0]; }

  static std::uint32_t before(const Triangle& t, std::uint32_t v) { return t[0] == v ? t[2] : t[1] == v ? t[0] : t[1]; }

  using Neighbours = std::array<std::uint32_t, kMostRing + 1>;

  /// Lists each neighbour once; an open fan has one more than triangles. Returns their number.
  std::size_t neighbours_of(std::uint32_t v, Neighbours& found) const;

  /// Number of triangles of an edge.
  std::size_t triangles_at(std::uint32_t v, std::uint32_t w) const;

  /// Number of triangles that a collapse removes.
  std::size_t lost(std::uint32_t a, std::uint32_t b) const { return border[a] && border[b] ? 1 : 2; }

  /// Link condition: the common neighbours of both ends are those opposite the edge, and these keep three triangles, or
  /// one at a border. An edge between two border vertices must be a border edge.
  bool link_condition(std::uint32_t a, std::uint32_t b) const;

  /// Requirements on triangles that a collapse changes.
  struct Guard {
    double shape = 0;   ///< least shape (as CollapseOptions::least_shape) of those that are not worse already
    double cosine = 0;  ///< least cosine between the normals before and after
  };

  /// Whether all remaining triangles around `moved` meet the requirements if that vertex moves to p.
  bool keeps_shape(std::uint32_t moved, std::uint32_t other, const Vec3& p, const Guard& guard) const;

  /// Shape of a triangle.
  double shape_of(const Triangle& t) const;

  /// Cost and position of the collapse of an edge.
  Collapse measure(std::uint32_t a, std::uint32_t b) const;

  bool possible(std::uint32_t a, const Collapse& c) const;

  /// Whether a collapse keeps the topology and the valences, and the changed triangles meet the requirements.
  bool possible(std::uint32_t a, const Collapse& c, const Guard& guard) const;

  /// The cheapest collapse of v that is possible(collapse), among those that measure(neighbour, collapse) computes and
  /// accepts. Sets to[v], and blocked[v] to whether a cheaper one is impossible.
  template <class Measure, class Possible>
  std::optional<Collapse> cheapest(std::uint32_t v, const Measure& measure, const Possible& possible) {
    to[v] = kNoVertex, blocked[v] = 0;
    if (fixed[v] || crowded(v)) return std::nullopt;
    std::array<Collapse, kMostRing + 1> all;
    Neighbours neighbours;
    const std::size_t count = neighbours_of(v, neighbours);
    std::size_t n = 0;
    for (std::size_t k = 0; k < count; ++k)
      if (const std::uint32_t w = neighbours[k]; !fixed[w] && !crowded(w)) n += measure(w, all[n]);
    while (n > 0) {  // expensive tests only for the cheapest, then for the next one
      const auto best = std::min_element(all.begin(), all.begin() + n, [](const Collapse& a, const Collapse& b) {
        return a.cost != b.cost ? a.cost < b.cost : a.with < b.with;
      });
      if (possible(*best)) {
        to[v] = best->with;
        return *best;
      }
      *best = all[--n];
      blocked[v] = 1;
    }
    return std::nullopt;
  }

  /// Computes `to`, `cost` and `blocked` of a vertex.
  void find_cheapest(std::uint32_t v);

  /// Sort key: cheapest first, but costs within a factor of two are equal and a pseudo-random order decides. With exact
  /// order, few edges would be local minima where costs increase steadily over the mesh.
  std::uint64_t key(std::uint32_t v) const;

  /// Vertices whose ring a collapse changes: its ends, and the vertices opposite the edge except waiting ones.
  std::array<std::uint32_t, 4> touched(std::uint32_t v) const;

  /// Merges v into its partner. Changes only triangles around the two and the rings of `touched`, so that independent
  /// collapses run concurrently. `start`: start of the merged ring; p: position of the merged vertex.
  void collapse(std::uint32_t v, const Vec3& p, std::size_t start);

  /// Collapses edges sequentially, in the order of `key`.
  void collapse_in_turn();

  Box3 bounds_of() const {
    Box3 box;
    for (const Vec3& p : x) box.extend(p);
    return box;
  }
};

}  // namespace sansmesh::inline v1::detail
