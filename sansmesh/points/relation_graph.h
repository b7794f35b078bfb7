// Neighbouring normals, and what they say of each other's signs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/sign_graph.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// The neighbour graph in tree order, and what its edges say.
class RelationGraph {
 public:
  /// The tree of the samples' positions stays where it is. `noise`: length.
  RelationGraph(const KdTree& tree, std::span<const Vec3f> normals, int neighbours, double noise);

  std::size_t size() const { return positions_.size(); }
  std::size_t degree() const { return degree_; }
  std::uint32_t neighbour(std::size_t s, std::size_t k) const { return neighbours_[s * degree_ + k]; }
  int relation_to(std::size_t s, std::size_t k) const { return relations_[s * degree_ + k]; }
  /// Whether the sample's normal has to do with those of its neighbours.
  bool firm(std::size_t s) const;
  /// The share of what neighbours say, by its weight, that confirms the signs that the normals have.
  double agreement() const;
  /// The same with the signs of the normals times these.
  double agreement(std::span<const std::int8_t> sign) const;
  const KdTree& tree() const { return tree_; }
  const std::vector<Vec3f>& positions() const { return positions_; }
  const std::vector<Vec3f>& normals() const { return normals_; }
  const std::vector<float>& area() const { return area_; }  ///< up to a common factor

 private:
  /// `noise`, or what the nearest neighbours say of it where that is something else: two sheets that are a few spacings
  /// apart look like noise in wide neighbourhoods, or hide the noise that each of them has. How far neighbours lie off
  /// the mean of their tangent planes is noise; what the shape does to it has the other sign at the other end.
  double within_sheet(double noise) const;
  void limit_areas();

  const KdTree& tree_;
  std::size_t degree_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<float> area_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::int8_t> relations_;
};

/// An edge of the graph by the sample that it belongs to and its rank there.
struct RelationEdge {
  std::uint32_t sample, rank;
};

/// Edges are looked at in stretches of so many samples, which threads share out.
inline constexpr std::size_t kEdgeSamples = 32768;

/// Calls visit(edge) for those for which keep(sample, rank) is true, in their order; all are asked before.
template <class Keep, class Visit>
void visit_edges(const RelationGraph& graph, const Keep& keep, const Visit& visit) {
  std::vector<std::vector<RelationEdge>> kept((graph.size() + kEdgeSamples - 1) / kEdgeSamples);
  parallel_for(0, kept.size(), 1, [&](std::size_t c) {
    const std::size_t last = std::min(graph.size(), (c + 1) * kEdgeSamples);
    for (std::size_t s = c * kEdgeSamples; s < last; ++s)
      for (std::size_t k = 0; k < graph.degree(); ++k)
        if (keep(s, k)) kept[c].push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(k)});
  });
  for (std::vector<RelationEdge>& some : kept)
    for (const RelationEdge& e : std::exchange(some, {})) visit(e);
}

/// Joins along the edges at least so sure within stretches of so many samples along the tree, each by itself, in a
/// forest of single samples.
void join_stretches(const RelationGraph& graph, SignForest& forest, int sure, std::size_t stretch = kEdgeSamples);

/// Joins along all edges at least so sure; the forest is flat before and after. Most of them join what belongs together
/// already, which all threads see at once.
void join_sure(const RelationGraph& graph, SignForest& forest, int sure);

/// Joins what is left apart in a flat forest by the votes of all edges between (`contract`).
void join_by_votes(const RelationGraph& graph, SignForest& forest);

}  // namespace sansmesh::inline v1::detail
