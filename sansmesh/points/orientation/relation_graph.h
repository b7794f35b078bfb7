// Graph of neighbouring normals with evidence on their relative signs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/orientation/sign_graph.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Neighbour graph in tree order; each edge has a relation of the signs at its ends.
class RelationGraph {
 public:
  /// The tree of the samples' positions must outlive the graph. Normals that are not finite count as zero. `noise`:
  /// length.
  RelationGraph(const KdTree& tree, std::span<const Vec3f> normals, int neighbours, double noise);

  std::size_t size() const { return positions_.size(); }
  std::size_t degree() const { return degree_; }
  std::uint32_t neighbour(std::size_t s, std::size_t k) const { return neighbours_[s * degree_ + k]; }
  int relation_to(std::size_t s, std::size_t k) const { return relations_[s * degree_ + k]; }
  /// Whether the sample's normal is correlated with those of its neighbours.
  bool firm(std::size_t s) const;
  /// Weighted share of edges that confirm the signs of the normals.
  double agreement() const;
  /// Same, with the normals multiplied by these signs.
  double agreement(std::span<const std::int8_t> sign) const;
  /// Noise (length) within a sheet: the given one unless the nearest neighbours contradict it.
  double noise() const { return noise_; }
  /// Whether wide neighbourhoods mistake sheets close to each other for noise.
  bool has_close_sheets() const { return close_sheets_; }
  const KdTree& tree() const { return tree_; }
  const std::vector<Vec3f>& positions() const { return positions_; }
  const std::vector<Vec3f>& normals() const { return normals_; }
  const std::vector<float>& area() const { return area_; }  ///< up to a common factor

 private:
  /// Returns `noise`, or the noise of the nearest neighbours if it differs: two sheets a few spacings apart look like
  /// noise in wide neighbourhoods, or hide the noise within each. Noise is the distance of neighbours from the mean of
  /// their tangent planes; the contribution of curvature has opposite signs at both ends.
  double within_sheet(double noise) const;
  void limit_areas();

  const KdTree& tree_;
  std::size_t degree_;
  double noise_ = 0;
  bool close_sheets_ = false;
  std::vector<Vec3f> positions_, normals_;
  std::vector<float> area_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::int8_t> relations_;
};

/// Edge of the graph: a sample and the rank of its neighbour.
struct RelationEdge {
  std::uint32_t sample, rank;
};

/// Number of samples per range when threads process edges.
inline constexpr std::size_t kEdgeSamples = 32768;

/// Calls visit(edge) in order for all edges with keep(sample, rank); evaluates keep for all edges first, in parallel.
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

/// Joins along edges at least this reliable within stretches of this many samples in tree order, independently, in a
/// forest of single samples. With `only`, joins these samples among themselves.
void join_stretches(const RelationGraph& graph, SignForest& forest, int sure, std::size_t stretch = kEdgeSamples,
                    std::span<const std::uint8_t> only = {});

/// Joins along all edges at least this reliable; the forest is flat before and after. Most edges connect samples
/// already joined, which all threads detect in parallel. Edges of samples in `apart`, if any, do not count.
void join_sure(const RelationGraph& graph, SignForest& forest, int sure, std::span<const std::uint8_t> apart = {});

/// Joins the remaining sets of a flat forest by the votes of all edges between them, and further ones (`contract`).
void join_by_votes(const RelationGraph& graph, SignForest& forest, std::vector<SignVote> votes = {});

}  // namespace sansmesh::inline v1::detail
