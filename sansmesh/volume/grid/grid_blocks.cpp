#include "sansmesh/volume/grid/grid_blocks.h"

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

std::string name_of(const GridBlock& b, std::size_t number) {
  return b.name.empty() ? fmt::format("block {}", number) : fmt::format("block '{}'", printable(b.name, 60));
}

void check_block(const GridBlock& b, std::size_t number) {
  const std::size_t points = point_count_of(b);
  const auto fail = [&](const std::string& cause) { throw DataError(name_of(b, number) + ": " + cause); };
  if (b.kind == GridKind::curvilinear && b.points.size() != points)
    fail(fmt::format("{} points do not make a grid of {} x {} x {}", b.points.size(), b.dims[0], b.dims[1], b.dims[2]));
  if (b.kind == GridKind::lattice)
    for (const auto& axis : b.axes)
      for (std::size_t i = 0; i < axis.size(); ++i)
        if (!std::isfinite(axis[i]) || (i > 0 && !(axis[i] > axis[i - 1])))
          fail("the coordinates of an axis do not increase");
  for (const std::uint32_t p : b.cells.corners)
    if (p >= points) fail(fmt::format("a cell uses point {} of {}", p, points));
  for (const auto& flat : b.flat_cells)
    for (std::size_t k = 0; k < 4; ++k)
      if (flat[k] >= points && !(k == 3 && flat[k] == GridBlock::kNone))
        fail(fmt::format("a cell uses point {} of {}", flat[k], points));
  if (!b.hidden_points.empty() && b.hidden_points.size() != points)
    fail("the point flags do not have one row per point");
  if (!b.hidden_cells.empty() && b.hidden_cells.size() != cell_count_of(b))
    fail("the cell flags do not have one row per cell");
  if (!b.piece_of.empty() && b.piece_of.size() != b.cells.size())
    fail("the numbers of cut cells do not have one row per cell");
  if (const HigherOrderCells& higher = b.higher; !higher.of_piece.empty()) {
    if (higher.of_piece.size() != b.cells.size())
      fail("the numbers of cells of higher order do not have one row per cell");
    for (const std::uint32_t h : higher.of_piece)
      if (h != HigherOrderCells::kNone && h >= higher.size()) fail("a cell is a piece of a missing cell");
    for (std::size_t h = 0; h < higher.size(); ++h)
      if (node_count(higher.kinds[h]) == 0 || higher[h].size() != node_count(higher.kinds[h]))
        fail("a cell of higher order has a wrong number of nodes");
    for (const std::uint32_t p : higher.nodes)
      if (p >= points) fail(fmt::format("a cell uses point {} of {}", p, points));
  }
  for (const Attribute& a : b.point_arrays)
    if (a.rows() != points) fail("array '" + printable(a.name, 60) + "' does not have one row per point");
  for (const Attribute& a : b.cell_arrays)
    if (a.rows() != cell_count_of(b)) fail("array '" + printable(a.name, 60) + "' does not have one row per cell");
}

}  // namespace

std::size_t point_count_of(const GridBlock& b) {
  const auto n = dims_of(b);
  return is_structured(b) ? n[0] * n[1] * n[2] : b.points.size();
}

std::size_t cell_count_of(const GridBlock& b) {
  if (!is_structured(b)) return b.cells.empty() ? b.flat_cells.size() : b.cells.size();
  if (point_count_of(b) == 0) return 0;
  std::size_t product = 1;
  for (const std::size_t n : dims_of(b)) product *= std::max<std::size_t>(1, n - 1);
  return product;
}

std::size_t whole_count_of(const GridBlock& b) {
  std::size_t count = cell_count_of(b);
  for (std::size_t c = 1; c < b.piece_of.size(); ++c) count -= b.piece_of[c] == b.piece_of[c - 1];
  return count;
}

bool is_solid(const GridBlock& b) {
  return is_structured(b) ? point_count_of(b) > 0 && layers_of(b) == 0 : !b.cells.empty();
}

Vec3 point_of(const GridBlock& b, std::size_t i) {
  if (b.kind != GridKind::lattice) return b.points[i];
  const std::size_t nx = b.axes[0].size(), ny = b.axes[1].size();
  return b.origin + b.directions[0] * b.axes[0][i % nx] + b.directions[1] * b.axes[1][i / nx % ny] +
         b.directions[2] * b.axes[2][i / (nx * ny)];
}

void check_blocks(const GridData& data) {
  if (data.blocks.size() > 65536)
    throw DataError(fmt::format("{} blocks: at most 65536 can be used", data.blocks.size()));
  std::size_t points = 0;
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    check_block(data.blocks[b], b);
    points += point_count_of(data.blocks[b]);
  }
  if (points > 0xfffffff0u / 2) throw DataError(fmt::format("{} points are more than can be used", points));
}

}  // namespace sansmesh::inline v1
