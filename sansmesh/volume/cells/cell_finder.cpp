#include "sansmesh/volume/cells/cell_finder.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel_collect.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {

CellFinder::CellFinder(const CellList& cells, std::span<const Vec3> points)
    : cells_(cells), points_(points), tree_(cells.size(), [this](std::size_t c) { return box(c); }) {}

Box3 CellFinder::box(std::size_t cell) const {
  Box3 around;
  for (const std::uint32_t p : cells_[cell]) around.extend(points_[p]);
  return around;
}

Vec3 CellFinder::middle(std::size_t cell) const {
  const Vec3 base = corner(cell, 0);
  Vec3 sum;
  for (const std::uint32_t p : cells_[cell]) sum += points_[p] - base;
  return base + sum / static_cast<double>(cells_[cell].size());
}

double CellFinder::mean_edge(std::size_t cell) const {
  const auto edges = cell_edges(cells_.shapes[cell]);
  double sum = 0;
  for (const auto& edge : edges) sum += norm(corner(cell, edge[0]) - corner(cell, edge[1]));
  return sum / static_cast<double>(edges.size());
}

std::uint32_t CellFinder::smallest(const Vec3& x, const std::function<bool(std::uint32_t)>& accept,
                                   std::vector<std::uint32_t>& scratch) const {
  constexpr double kRounding = -1e-9;
  tree_.containing(x, scratch);
  std::uint32_t best = kNoCell;
  double least = 0;
  std::array<Vec3, 8> corners;
  for (const std::uint32_t cell : scratch) {
    if (!accept(cell)) continue;
    const std::size_t count = cells_[cell].size();
    for (std::size_t k = 0; k < count; ++k) corners[k] = corner(cell, k) - x;
    const std::span<const Vec3> these = std::span(corners).first(count);
    Vec3 u;
    if (!CellMap(cells_.shapes[cell], these).invert(u) || !parameters_within(cells_.shapes[cell], u, kRounding))
      continue;
    const double volume = cell_volume(cells_.shapes[cell], these);
    if (best == kNoCell || volume < least || (volume == least && cell < best)) best = cell, least = volume;
  }
  return best;
}

FaceNeighbours::FaceNeighbours(const CellList& cells, std::span<const Vec3> points)
    : finder_(cells, points), equal_(face_neighbours(cells, points.size())) {}

std::uint32_t FaceNeighbours::beyond(std::size_t cell, std::size_t face, double r, double s,
                                     std::vector<std::uint32_t>& scratch) const {
  const CellFace& f = cell_faces(finder_.cells().shapes[cell])[face];
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k) x[k] = finder_.corner(cell, f.corner[std::min<std::size_t>(k, f.count - 1)]);
  const Vec3 on_face = x[0] + ((x[1] - x[0]) * (1 - s) + (x[2] - x[3]) * s) * r + (x[3] - x[0]) * s;
  const Vec3 normal = normalized(cross(x[2] - x[0], x[3] - x[1]));
  // A tenth of the way from the cell centre to the face, beyond the face along its normal.
  const double half = dot(normal, (x[0] + x[1] + x[2] + x[3]) / 4 - finder_.middle(cell));
  return finder_.smallest(
      on_face + normal * (0.1 * std::abs(half)), [cell](std::uint32_t other) { return other != cell; }, scratch);
}

void for_each_partial_neighbour(const FaceNeighbours& faces,
                                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)>& visit) {
  struct Found {
    std::uint32_t cell, corner, other;
  };
  const CellList& cells = faces.finder().cells();
  const auto collect = [&](std::size_t first, std::size_t last, std::vector<Found>& found) {
    std::vector<std::uint32_t> scratch;
    for (std::size_t c = first; c < last; ++c) {
      const auto of_cell = cell_faces(cells.shapes[c]);
      for (std::size_t f = 0; f < of_cell.size(); ++f) {
        if (faces.equal(c, f) != kNoCell) continue;
        constexpr double kParameters[4][2] = {{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}};
        for (std::size_t k = 0; k < of_cell[f].count; ++k) {
          const std::uint32_t other = faces.beyond(c, f, kParameters[k][0], kParameters[k][1], scratch);
          if (other != kNoCell) found.push_back({static_cast<std::uint32_t>(c), cells[c][of_cell[f].corner[k]], other});
        }
      }
    }
  };
  for (const Found& at : parallel_collect<Found>(cells.size(), 1024, collect)) visit(at.cell, at.corner, at.other);
}

}  // namespace sansmesh::inline v1
