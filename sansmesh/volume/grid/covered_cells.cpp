#include "sansmesh/volume/grid/covered_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

#include "sansmesh/core/parallel.h"
#include "sansmesh/data/grid_limits.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_finder.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {
namespace {

/// Whether a lattice contains x, and in which cell.
bool lattice_holds(const GridBlock& b, const Vec3& x, std::array<std::size_t, 3>& cell) {
  const Vec3 d = x - b.origin;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& axis = b.axes[k];
    const double a = dot(b.directions[k], d);
    if (!(a >= axis.front() && a <= axis.back())) return false;
    const auto above = std::upper_bound(axis.begin() + 1, axis.end() - 1, a);
    cell[k] = static_cast<std::size_t>(above - axis.begin()) - 1;
  }
  return true;
}

bool is_visible(const GridBlock& b, const std::array<std::size_t, 3>& cell) {
  const std::size_t nx = b.axes[0].size(), ny = b.axes[1].size();
  if (!b.hidden_cells.empty() && b.hidden_cells[cell[0] + (nx - 1) * (cell[1] + (ny - 1) * cell[2])] != 0) return false;
  if (b.hidden_points.empty()) return true;
  for (std::size_t c = 0; c < 8; ++c)
    if (b.hidden_points[cell[0] + (c & 1) + nx * (cell[1] + (c >> 1 & 1) + ny * (cell[2] + (c >> 2)))] != 0)
      return false;
  return true;
}

/// The point of a cell at parameters of the unit cube, mapped into the parameters of the shape.
Vec3 point_in_cell(CellShape shape, std::span<const Vec3> corners, Vec3 u) {
  if (shape == CellShape::tetrahedron)
    u = u / std::max(1.0, 1.01 * (u.x + u.y + u.z));
  else if (shape == CellShape::wedge)
    u.x *= 1 - u.y;
  std::array<double, 8> weights;
  shape_functions(shape, u, weights);
  Vec3 x;
  for (std::size_t k = 0; k < corners.size(); ++k) x += corners[k] * weights[k];
  return x;
}

template <class T>
void take_out(std::vector<T>& of, const std::vector<std::uint8_t>& gone) {
  if (of.empty()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < of.size(); ++i)
    if (!gone[i]) of[to++] = of[i];
  of.resize(to);
}

}  // namespace

std::size_t remove_below_levels(const GridData& data, GatheredCells& g) {
  if (g.cell_block.empty()) return 0;
  std::vector<std::size_t> covering;
  int lowest = data.blocks[0].level, highest = lowest;
  for (const GridBlock& b : data.blocks) lowest = std::min(lowest, b.level), highest = std::max(highest, b.level);
  if (lowest == highest) return 0;
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    const GridBlock& block = data.blocks[b];
    const bool whole = block.kind == GridKind::lattice &&
                       std::all_of(block.axes.begin(), block.axes.end(), [](const auto& a) { return a.size() > 1; });
    if (whole && block.level > lowest) covering.push_back(b);
  }
  const BoxTree tree(covering.size(), [&](std::size_t i) { return lattice_box(data.blocks[covering[i]]); });
  std::vector<std::uint8_t> gone(g.cells.size());
  parallel_ranges(0, g.cells.size(), 1024, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t c = first; c < last; ++c) {
      const int level = data.blocks[g.cell_block[c]].level;
      if (level == highest) continue;
      Vec3 middle;
      for (const std::uint32_t p : g.cells[c]) middle += g.points[p] / static_cast<double>(g.cells[c].size());
      bool all_visible = true;
      const auto covered = [&](const Vec3& x, bool by_visible) {
        tree.containing(x, near);
        return std::any_of(near.begin(), near.end(), [&](std::uint32_t i) {
          const GridBlock& b = data.blocks[covering[i]];
          std::array<std::size_t, 3> cell;
          if (b.level <= level || !lattice_holds(b, x, cell)) return false;
          all_visible = all_visible && b.hidden_cells.empty() && b.hidden_points.empty();
          return !by_visible || is_visible(b, cell);
        });
      };
      gone[c] = covered(middle, false) && std::all_of(g.cells[c].begin(), g.cells[c].end(), [&](std::uint32_t p) {
                  return covered(g.points[p] + (middle - g.points[p]) * 1e-3, false);
                });
      if (!gone[c] || all_visible) continue;
      // Ghosts and blanked cells cover nothing. For cells of two or four times their size every contained finer cell is
      // tested.
      std::array<Vec3, 8> corners;
      const std::size_t count = g.cells[c].size();
      for (std::size_t k = 0; k < count; ++k) corners[k] = g.points[g.cells[c][k]];
      for (int i = 0; i < 64 && gone[c]; ++i) {
        const int row = i / 4 % 4, layer = i / 16;
        const Vec3 u{0.125 + 0.25 * (i % 4), 0.125 + 0.25 * row, 0.125 + 0.25 * layer};
        gone[c] = covered(point_in_cell(g.cells.shapes[c], std::span(corners).first(count), u), true);
      }
    }
  });
  const auto count = static_cast<std::size_t>(std::count(gone.begin(), gone.end(), 1));
  if (count == 0) return 0;
  CellList cells;
  for (std::size_t c = 0; c < g.cells.size(); ++c)
    if (!gone[c]) cells.add(g.cells.shapes[c], g.cells[c]);
  g.cells = std::move(cells);
  take_out(g.cell_row, gone);
  take_out(g.cell_block, gone);
  take_out(g.cell_whole, gone);
  take_out(g.higher.of_piece, gone);
  take_out(g.centers, gone);
  return count;
}

std::vector<std::uint8_t> overlapped_cells(const CellList& cells, const std::vector<Vec3>& points,
                                           const std::vector<std::uint16_t>& block) {
  const std::size_t n = cells.size();
  std::vector<std::uint8_t> gone(n, 0);
  const CellFinder finder(cells, points);
  std::vector<double> size(n);
  std::vector<Vec3> middle(n);
  parallel_for(0, n, 4096, [&](std::size_t c) { size[c] = finder.mean_edge(c), middle[c] = finder.middle(c); });
  const auto wins = [&](std::size_t a, std::size_t b) {
    const auto key = [&](std::size_t c) { return std::tie(size[c], middle[c].x, middle[c].y, middle[c].z); };
    return key(a) < key(b) || (key(a) == key(b) && a < b);  // the same cell in two blocks
  };
  // Faces at which a block ends: a cell that contains part of one is only partly covered.
  const std::vector<std::uint32_t> ends = open_faces(cells, points.size());
  const BoxTree end_tree(ends.size(), [&](std::size_t i) {
    Box3 box;
    for (const std::uint32_t p : ring_of_face(cells, ends[i])) box.extend(points[p]);
    return box;
  });
  parallel_ranges(0, n, 256, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t c = first; c < last; ++c) {
      const std::uint32_t finer = finder.smallest(
          middle[c], [&](std::uint32_t other) { return block[other] != block[c] && wins(other, c); }, near);
      if (finer == kNoCell) continue;
      Box3 box = finder.box(c);
      const Vec3 inset = box.size() * 1e-6;
      box = {box.lower + inset, box.upper - inset};
      end_tree.overlapping(box, near);
      gone[c] = std::none_of(near.begin(), near.end(),
                             [&](std::uint32_t e) { return block[ends[e] / kMostFaces] == block[finer]; });
    }
  });
  // Cells that cover another may have been removed themselves, since sizes vary: no space may stay empty.
  std::vector<std::uint8_t> back(n, 0);
  parallel_ranges(0, n, 64, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    std::array<Vec3, 8> corners;
    for (std::size_t c = first; c < last; ++c) {
      if (!gone[c]) continue;
      const std::size_t count = cells[c].size();
      for (std::size_t k = 0; k < count; ++k) corners[k] = finder.corner(c, k);
      for (int i = 0; i < 27 && !back[c]; ++i) {
        constexpr double kAlong[] = {0.01, 0.5, 0.99};
        const Vec3 u{kAlong[i % 3], kAlong[i / 3 % 3], kAlong[i / 9]};
        const Vec3 x = point_in_cell(cells.shapes[c], std::span(corners).first(count), u);
        back[c] = finder.smallest(
                      x, [&](std::uint32_t other) { return !gone[other]; }, near) == kNoCell;
      }
    }
  });
  for (std::size_t c = 0; c < n; ++c)
    if (back[c]) gone[c] = 0;
  return gone;
}

}  // namespace sansmesh::inline v1
