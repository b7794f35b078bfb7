#include "sansmesh/volume/grid/gather_points.h"

#include <numeric>

#include "sansmesh/error.h"
#include "sansmesh/volume/grid/block_order.h"
#include "sansmesh/volume/grid/coincident_points.h"
#include "sansmesh/volume/grid/delaunay.h"
#include "sansmesh/volume/grid/point_order.h"

namespace sansmesh::inline v1 {

GatheredCells gather_scattered(const GridData& data, const std::vector<std::size_t>& order, VolumeFacts& facts,
                               std::vector<std::uint32_t>& first) {
  struct Source {
    std::uint32_t row;
    std::uint16_t block;
  };
  std::vector<Source> sources;
  std::vector<Vec3> positions;
  Box3 box;
  for (const std::size_t b : order) {
    const GridBlock& block = data.blocks[b];
    if (block.kind != GridKind::scattered) continue;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      if (!is_finite(block.points[i])) {
        ++facts.not_finite;
      } else if (!block.hidden_points.empty() && block.hidden_points[i]) {
        ++facts.hidden;
      } else {
        positions.push_back(block.points[i]);
        sources.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint16_t>(b)});
        box.extend(block.points[i]);
      }
    }
  }
  if (positions.empty())
    throw DataError(facts.hidden > 0 ? "all points are hidden" : "no point has finite coordinates");
  const auto sorted = canonical_point_order(positions, [&](std::uint32_t i, std::uint32_t j) {
    return digest_of_point(data.blocks[sources[i].block], sources[i].row) <
           digest_of_point(data.blocks[sources[j].block], sources[j].row);
  });
  GatheredCells g;
  for (const std::uint32_t i : sorted) {
    g.points.push_back(positions[i]);
    g.point_row.push_back(sources[i].row);
    if (data.blocks.size() > 1) g.point_block.push_back(sources[i].block);
  }
  positions = {}, sources = {};
  const double reach = 1e-9 * box.diagonal();
  std::vector<std::uint32_t> distinct(g.points.size());
  std::iota(distinct.begin(), distinct.end(), 0u);
  first = joined_points(g.points, distinct, [&](std::uint32_t) { return reach; });
  if (!first.empty()) std::erase_if(distinct, [&](std::uint32_t i) { return first[i] != i; });
  std::vector<Vec3> apart;
  apart.reserve(distinct.size());
  for (const std::uint32_t i : distinct) apart.push_back(g.points[i]);
  g.cells = delaunay_tetrahedra(apart);
  for (std::uint32_t& p : g.cells.corners) p = distinct[p];
  return g;
}

}  // namespace sansmesh::inline v1
