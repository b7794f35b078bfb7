// Edges of a triangle mesh that are collapsed into a vertex: the mesh meanwhile, what each would cost, and the
// collapse.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/mesh/edit/collapse_options.h"
#include "sansmesh/mesh/edit/quadric.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

constexpr std::size_t kMostRing = 24;  ///< triangles around a vertex that is to be merged

/// The mesh while it is simplified.
struct EdgeCollapses {
  const CollapseOptions& options;
  double error;  ///< accepted now
  std::vector<Vec3> x;
  std::vector<Quadric> quadric;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> original;  ///< the number that each triangle had; filled before `pack_triangles`
  /// By which those are put in order that cost the same. Of the place, so that it is the same for a part of the mesh.
  std::vector<std::uint32_t> chance;
  std::vector<float> limit;  ///< of the error, by vertex; or empty
  std::vector<std::uint8_t> fixed;
  std::vector<std::uint8_t> border;        ///< of vertices that are not fixed: on a border
  std::vector<std::uint32_t> merged_into;  ///< kNoVertex: alive
  // Triangles around each vertex: around[first .. first + valence]. A merged ring gets a new place at the end; places
  // that were given up go when they are as many as those in use.
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> valence, around;
  // The cheapest collapse of an edge from a vertex to one of higher index.
  std::vector<std::uint32_t> to;
  std::vector<float> cost;
  std::vector<std::uint8_t> blocked;  ///< a cheaper one would have spoilt the shape: worth another try after changes
  std::vector<std::uint8_t> waits;    ///< crowded: 1, 2 while `note_hubs` has it; empty if none is
  std::size_t left, left_triangles;

  EdgeCollapses(const CollapseOptions& o, std::size_t vertices, std::vector<Triangle> all);

  std::span<const std::uint32_t> ring(std::uint32_t v) const { return {around.data() + first[v], valence[v]}; }

  /// Of the triangles as they are.
  void build_rings();

  /// Places for all rings, one after the other; returns where they end.
  std::size_t place_rings(std::vector<std::size_t>& place) const;

  /// Gives up the places of rings that were merged, if they are as many as those of the rings that are left: each
  /// collapse needs a place for two rings, and without this they would add up to three times the mesh.
  void pack_rings();

  /// Leaves out the triangles that went, and makes the rings anew.
  void pack_triangles();

  /// Too many triangles to be merged: until collapses around it leave few enough it waits.
  bool crowded(std::uint32_t v) const { return valence[v] > kMostRing; }

  bool is_waiting(std::uint32_t v) const { return !waits.empty() && waits[v] != 0; }

  /// Fills in `waits`.
  void note_crowded();

  /// Appends the waiting vertices around w, into which another one merged, to `hubs`, each once. Their rings still have
  /// the triangles that went, so that many edges around one may collapse at a time.
  void note_hubs(std::uint32_t w, std::vector<std::uint32_t>& hubs) {
    if (waits.empty()) return;
    for (const std::uint32_t i : ring(w))
      for (const std::uint32_t u : triangles[i])
        if (waits[u] == 1) waits[u] = 2, hubs.push_back(u);
  }

  /// Takes those triangles out of the rings. Calls look(u) for those that need not wait any more, and their neighbours.
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

  /// The quadric of a vertex. Those of a border have planes along it, too, across the surface. Vertices whose triangles
  /// are not one fan stay: what is not manifold. So do those of a triangle without area: it has no plane to hold them,
  /// and no normal by which to see that it turns over, so a strip of such triangles along a crease would open like a
  /// fan.
  void prepare(std::uint32_t v);

  enum class Fan { none, closed, open };

  /// Whether the triangles around a vertex are one fan.
  Fan fan_of(std::uint32_t v) const;

  struct Collapse {
    std::uint32_t with = kNoVertex;
    double cost = 0;  ///< mean squared distance
    Vec3 position;
  };

  /// The vertex after v in a triangle: over a closed fan, each neighbour once.
  static std::uint32_t after(const Triangle& t, std::uint32_t v) { return t[0] == v ? t[1] : t[1] == v ? t[2] : t[0]; }

  static std::uint32_t before(const Triangle& t, std::uint32_t v) { return t[0] == v ? t[2] : t[1] == v ? t[0] : t[1]; }

  using Neighbours = std::array<std::uint32_t, kMostRing + 1>;

  /// Each once; over an open fan there is one more than triangles. Returns how many.
  std::size_t neighbours_of(std::uint32_t v, Neighbours& found) const;

  /// How many triangles have the edge.
  std::size_t triangles_at(std::uint32_t v, std::uint32_t w) const;

  /// Triangles that go with an edge.
  std::size_t lost(std::uint32_t a, std::uint32_t b) const { return border[a] && border[b] ? 1 : 2; }

  /// The ends of the edge have no neighbours in common but those opposite to it, and these keep three triangles, or one
  /// at a border. Two vertices of borders have a border between them.
  bool link_condition(std::uint32_t a, std::uint32_t b) const;

  /// No triangle around `moved` that stays turns too far or becomes too thin if that goes to p.
  bool keeps_shape(std::uint32_t moved, std::uint32_t other, const Vec3& p) const;

  /// Of the edge between two vertices.
  Collapse measure(std::uint32_t a, std::uint32_t b) const;

  bool possible(std::uint32_t a, const Collapse& c) const;

  /// Fills in `to`, `cost` and `blocked` of a vertex.
  void find_cheapest(std::uint32_t v);

  /// Cheapest first, but costs within a factor of two count as equal and chance decides: where costs rise steadily
  /// over the mesh there would be few that are cheapest among their surroundings.
  std::uint64_t key(std::uint32_t v) const;

  /// The vertices whose ring a collapse changes: its ends, and those opposite to the edge but for waiting ones.
  std::array<std::uint32_t, 4> touched(std::uint32_t v) const;

  /// Merges v into its partner. Changes only triangles around the two and the rings of `touched`, so that those that
  /// win run at a time. `place`: room for the merged ring.
  void collapse(std::uint32_t v, std::size_t place);

  /// One collapse after the other: cheapest first, but for the costs that count as equal.
  void collapse_in_turn();

  Box3 bounds_of() const {
    Box3 box;
    for (const Vec3& p : x) box.extend(p);
    return box;
  }
};

}  // namespace sansmesh::inline v1::detail
