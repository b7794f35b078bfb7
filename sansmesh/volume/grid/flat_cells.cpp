#include "sansmesh/volume/grid/flat_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/volume/grid/coincident_points.h"

namespace sansmesh::inline v1 {
namespace {

std::size_t ring_size(const FlatCell& cell) { return cell.corners[3] == GridBlock::kNone ? 3 : 4; }

/// Twice the vector area; corners are counter-clockwise seen from its side.
Vec3 area_of(const FlatCell& cell, const std::vector<Vec3>& points) {
  const std::size_t count = ring_size(cell);
  const Vec3& o = points[cell.corners[0]];
  Vec3 area;
  for (std::size_t k = 0; k < count; ++k)
    area += cross(points[cell.corners[k]] - o, points[cell.corners[(k + 1) % count]] - o);
  return area;
}

/// Two cells adjacent to an edge.
struct CellLink {
  std::uint32_t cell, other;
  bool opposed;  ///< their orientations differ
};

/// A sheet listed once per side.
bool same_corners(const FlatCell& a, const FlatCell& b, const std::vector<std::uint32_t>& at) {
  const auto numbers = [&](const FlatCell& cell) {
    std::vector<std::uint32_t> all(ring_size(cell));
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = at[cell.corners[k]];
    std::sort(all.begin(), all.end());
    return all;
  };
  return numbers(a) == numbers(b);
}

/// For each cell the cells connected by an edge with no third cell; corners by `at`, the first coincident point.
std::vector<CellLink> links_of(const std::vector<FlatCell>& cells, const std::vector<std::uint32_t>& at) {
  struct Side {
    std::uint64_t edge;
    std::uint32_t cell;
    bool upwards;  ///< from the corner of smaller index to the other
  };
  std::vector<Side> sides;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t count = ring_size(cells[c]);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint64_t a = at[cells[c].corners[k]], b = at[cells[c].corners[(k + 1) % count]];
      if (a != b) sides.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<std::uint32_t>(c), a < b});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::pair(a.edge, a.cell) < std::pair(b.edge, b.cell); });
  std::vector<CellLink> links;
  for (std::size_t first = 0, last; first < sides.size(); first = last) {
    for (last = first + 1; last < sides.size() && sides[last].edge == sides[first].edge;) ++last;
    const Side &a = sides[first], &b = sides[last - 1];
    if (last - first != 2 || a.cell == b.cell || same_corners(cells[a.cell], cells[b.cell], at)) continue;
    const bool opposed = a.upwards == b.upwards;
    links.push_back({a.cell, b.cell, opposed});
    links.push_back({b.cell, a.cell, opposed});
  }
  std::sort(links.begin(), links.end(), [](const CellLink& a, const CellLink& b) {
    return std::pair(a.cell, a.other) < std::pair(b.cell, b.other);
  });
  return links;
}

/// The cells to be flipped for consistent sides.
std::vector<std::uint8_t> turned_cells(const std::vector<FlatCell>& cells, const std::vector<Vec3>& areas,
                                       const std::vector<std::uint32_t>& at) {
  const std::vector<CellLink> links = links_of(cells, at);
  std::vector<std::uint8_t> turned(cells.size(), 0), seen(cells.size(), 0);
  std::vector<std::uint32_t> part;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (seen[start]) continue;
    part.assign(1, start);
    seen[start] = 1;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const auto from = std::lower_bound(links.begin(), links.end(), part[k],
                                         [](const CellLink& l, std::uint32_t cell) { return l.cell < cell; });
      for (auto link = from; link != links.end() && link->cell == part[k]; ++link) {
        if (std::exchange(seen[link->other], std::uint8_t{1})) continue;
        turned[link->other] = turned[part[k]] != static_cast<std::uint8_t>(link->opposed);
        part.push_back(link->other);
      }
    }
    // Planar parts show the side towards which their largest coordinate grows; closed parts have no preference.
    Vec3 sum;
    double all = 0;
    for (const std::uint32_t c : part) sum += turned[c] ? -areas[c] : areas[c], all += norm(areas[c]);
    std::size_t largest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(sum[k]) > std::abs(sum[largest]) * (1 + 1e-9)) largest = k;
    if (sum[largest] < -1e-9 * all)
      for (const std::uint32_t c : part) turned[c] ^= 1;
  }
  return turned;
}

}  // namespace

void thicken(const std::vector<FlatCell>& cells, bool centers, GatheredCells& g, VolumeFacts& facts) {
  const std::size_t n = g.points.size();
  const auto each_edge = [&](const auto& visit) {
    for (const FlatCell& cell : cells) {
      const std::size_t count = ring_size(cell);
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t a = cell.corners[k], b = cell.corners[(k + 1) % count];
        visit(a, b, norm(g.points[a] - g.points[b]));
      }
    }
  };
  std::vector<double> lengths;
  each_edge([&](std::uint32_t, std::uint32_t, double length) {
    if (length > 0) lengths.push_back(length);
  });
  if (lengths.empty()) return;
  const double thickness = median(lengths);
  facts.layer = thickness;

  std::vector<std::uint32_t> at = coincident_points(g.points, shortest_edges(n, each_edge, g.joinable), g.joinable);
  if (at.empty()) at.resize(n), std::iota(at.begin(), at.end(), 0u);
  std::vector<Vec3> areas;
  areas.reserve(cells.size());
  for (const FlatCell& cell : cells) areas.push_back(area_of(cell, g.points));
  const std::vector<std::uint8_t> turned = turned_cells(cells, areas, at);
  std::vector<Vec3> sides(n);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t k = 0; k < ring_size(cells[c]); ++k)
      sides[at[cells[c].corners[k]]] += turned[c] ? -areas[c] : areas[c];

  GatheredCells solid;
  solid.points.reserve(2 * n);
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3 half = normalized(sides[at[p]]) * (thickness / 2);
    for (const double side : {-1.0, 1.0}) {
      solid.points.push_back(g.points[at[p]] + half * side);
      solid.point_row.push_back(g.point_row[p]);
      if (!g.point_block.empty()) solid.point_block.push_back(g.point_block[p]);
      solid.joinable.push_back(g.joinable[p]);
    }
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t count = ring_size(cells[c]);
    std::array<std::uint32_t, 4> ring = cells[c].corners;
    if (turned[c]) std::reverse(ring.begin() + 1, ring.begin() + static_cast<std::ptrdiff_t>(count));
    // The first triangle of a wedge is counter-clockwise from outside, that of a hexahedron from inside.
    std::array<std::uint32_t, 8> corners{};
    Vec3 sum;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t p = ring[count == 3 ? (3 - k) % 3 : k];
      corners[k] = 2 * p, corners[count + k] = 2 * p + 1;
      sum += g.points[at[p]];
    }
    solid.cells.add(count == 3 ? CellShape::wedge : CellShape::hexahedron, std::span(corners).first(2 * count));
    solid.cell_row.push_back(cells[c].row);
    if (!g.point_block.empty()) solid.cell_block.push_back(cells[c].block);
    if (centers) solid.centers.push_back(sum / static_cast<double>(count));
  }
  g = std::move(solid);
}

}  // namespace sansmesh::inline v1
