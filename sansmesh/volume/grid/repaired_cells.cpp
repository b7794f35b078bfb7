#include "sansmesh/volume/grid/repaired_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/grid/coincident_points.h"

namespace sansmesh::inline v1 {
namespace {

/// The faces of a cell with coincident corners, as rings without repetitions.
struct Hull {
  std::array<std::array<std::uint32_t, 4>, 6> rings;
  std::array<std::size_t, 6> sizes;
  std::size_t faces = 0;

  Hull(CellShape shape, std::span<const std::uint32_t> corners) {
    for (const CellFace& face : cell_faces(shape)) {
      std::array<std::uint32_t, 4> ring{};
      std::size_t size = 0;
      for (std::size_t k = 0; k < face.count; ++k) {
        const std::uint32_t p = corners[face.corner[k]];
        if (std::find(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(size), p) ==
            ring.begin() + static_cast<std::ptrdiff_t>(size))
          ring[size++] = p;
      }
      if (size >= 3) rings[faces] = ring, sizes[faces++] = size;
    }
    cancel();
  }

  bool has(std::size_t face, std::uint32_t p) const {
    return std::find(rings[face].begin(), rings[face].begin() + static_cast<std::ptrdiff_t>(sizes[face]), p) !=
           rings[face].begin() + static_cast<std::ptrdiff_t>(sizes[face]);
  }

 private:
  /// Removes pairs of faces with the same corners.
  void cancel() {
    for (std::size_t f = 0; f < faces; ++f)
      for (std::size_t g = f + 1; g < faces; ++g) {
        bool same = sizes[f] == sizes[g];
        for (std::size_t k = 0; same && k < sizes[f]; ++k) same = has(g, rings[f][k]);
        if (!same) continue;
        for (const std::size_t gone : {g, f}) {
          --faces;
          rings[gone] = rings[faces], sizes[gone] = sizes[faces];
        }
        return cancel();
      }
  }
};

struct Piece {
  CellShape shape;
  std::array<std::uint32_t, 8> corners;
};

/// Replaces a cell with repeated corners by cells without repetitions, if any volume remains.
void pieces_of(CellShape shape, std::span<const std::uint32_t> corners, std::vector<Piece>& pieces) {
  pieces.clear();
  const Hull hull(shape, corners);
  if (hull.faces < 4) return;
  std::array<std::uint32_t, 8> distinct{};
  std::size_t count = 0;
  for (const std::uint32_t p : corners)
    if (std::find(distinct.begin(), distinct.begin() + static_cast<std::ptrdiff_t>(count), p) ==
        distinct.begin() + static_cast<std::ptrdiff_t>(count))
      distinct[count++] = p;
  if (count < 4) return;
  std::array<std::size_t, 2> triangles{};
  std::size_t triangle_count = 0;
  for (std::size_t f = 0; f < hull.faces; ++f)
    if (hull.sizes[f] == 3) {
      if (triangle_count < 2) triangles[triangle_count] = f;
      ++triangle_count;
    }
  if (count == 6 && hull.faces == 5 && triangle_count == 2) {
    // The cell is a wedge if each corner of one triangle has a partner on the other: the only other corner common to
    // the two quadrilaterals around it, and adjacent to it in both.
    const auto& one = hull.rings[triangles[0]];
    Piece wedge{CellShape::wedge, {one[0], one[1], one[2]}};
    bool complete = true;
    for (std::size_t k = 0; k < 3; ++k) {
      std::optional<std::uint32_t> partner;
      for (const std::uint32_t p : std::span(distinct).first(6)) {
        if (!hull.has(triangles[1], p)) continue;
        std::size_t shared = 0;
        for (std::size_t f = 0; f < hull.faces; ++f)
          shared += hull.sizes[f] == 4 && hull.has(f, one[k]) && hull.has(f, p);
        if (shared == 2) partner = p;
      }
      complete = complete && partner;
      if (partner) wedge.corners[3 + k] = *partner;
    }
    if (complete) pieces.push_back(wedge);
  }
  if (!pieces.empty()) return;
  // Cones over all faces from a repeated corner: only faces at this corner are degenerate.
  std::uint32_t tip = corners[0];
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (std::count(corners.begin(), corners.end(), corners[i]) > 1) {
      tip = corners[i];
      break;
    }
  for (std::size_t f = 0; f < hull.faces; ++f) {
    const auto& r = hull.rings[f];
    if (hull.has(f, tip)) continue;
    if (hull.sizes[f] == 3)
      pieces.push_back({CellShape::tetrahedron, {r[0], r[2], r[1], tip}});
    else
      pieces.push_back({CellShape::pyramid, {r[0], r[3], r[2], r[1], tip}});
  }
}

void turn(CellShape shape, std::span<std::uint32_t> c) {
  switch (shape) {
    case CellShape::tetrahedron:
      return std::swap(c[0], c[1]);
    case CellShape::pyramid:
      return std::swap(c[1], c[3]);
    case CellShape::wedge:
      for (std::size_t k = 0; k < 3; ++k) std::swap(c[k], c[k + 3]);
      return;
    case CellShape::hexahedron:
      for (std::size_t k = 0; k < 4; ++k) std::swap(c[k], c[k + 4]);
      return;
  }
}

enum class CellState : std::uint8_t { good, inverted, repeating, flat };

std::array<Vec3, 8> corner_positions(const GatheredCells& g, std::span<const std::uint32_t> corners) {
  std::array<Vec3, 8> x;
  for (std::size_t c = 0; c < corners.size(); ++c) x[c] = g.points[corners[c]];
  return x;
}

CellState state_of(const GatheredCells& g, CellShape shape, std::span<const std::uint32_t> corners) {
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (std::find(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(i), corners[i]) !=
        corners.begin() + static_cast<std::ptrdiff_t>(i))
      return CellState::repeating;
  const auto x = corner_positions(g, corners);
  const std::span<const Vec3> positions = std::span(x).first(corners.size());
  const double volume = cell_volume(shape, positions), edge = std::sqrt(squared_edges(shape, positions).longest);
  // Layers 1e5 times thinner than long in two directions have 1e-10 of the cube of their longest edge.
  if (!(std::abs(volume) > 1e-15 * edge * edge * edge)) return CellState::flat;
  return volume > 0 ? CellState::good : CellState::inverted;
}

}  // namespace

std::vector<std::uint32_t> join_coincident(GatheredCells& g) {
  const auto each_edge = [&](const auto& visit) {
    for (std::size_t c = 0; c < g.cells.size(); ++c) {
      const auto corners = g.cells[c];
      for (const auto& edge : cell_edges(g.cells.shapes[c])) {
        const std::uint32_t a = corners[edge[0]], b = corners[edge[1]];
        visit(a, b, norm(g.points[a] - g.points[b]));
      }
    }
  };
  const std::vector<double> shortest = shortest_edges(g.points.size(), each_edge, g.joinable);
  auto first = coincident_points(g.points, shortest, g.joinable);
  if (!first.empty()) {
    for (std::uint32_t& p : g.cells.corners) p = first[p];
    for (std::uint32_t& p : g.higher.nodes) p = first[p];
  }
  return first;
}

std::vector<std::uint32_t> repair_cells(GatheredCells& g, VolumeFacts& facts) {
  const std::size_t n = g.cells.size();
  std::vector<CellState> states(n);
  parallel_for(0, n, 4096, [&](std::size_t c) { states[c] = state_of(g, g.cells.shapes[c], g.cells[c]); });
  // A block in which all cells are inverted only has a reversed index order.
  std::vector<std::size_t> right(65536, 0), wrong(65536, 0);
  const auto block = [&](std::size_t c) { return g.cell_block.empty() ? std::size_t{0} : g.cell_block[c]; };
  bool all_good = true;
  for (std::size_t c = 0; c < n; ++c) {
    if (states[c] == CellState::good) ++right[block(c)];
    if (states[c] == CellState::inverted) ++wrong[block(c)];
    all_good = all_good && states[c] == CellState::good;
  }
  for (std::size_t b = 0; b < right.size(); ++b) facts.inverted += std::min(right[b], wrong[b]);
  if (all_good) return {};
  CellList cells;
  std::vector<std::uint32_t> source;
  cells.shapes.reserve(n), cells.first.reserve(n + 1), cells.corners.reserve(g.cells.corners.size());
  source.reserve(n);
  std::vector<Piece> pieces;
  const auto keep = [&](CellShape shape, std::span<std::uint32_t> corners, CellState state, std::size_t c) {
    if (state == CellState::flat || state == CellState::repeating) return;
    if (state == CellState::inverted) turn(shape, corners);
    cells.add(shape, corners);
    source.push_back(static_cast<std::uint32_t>(c));
  };
  for (std::size_t c = 0; c < n; ++c) {
    if (states[c] == CellState::repeating) {
      ++facts.degenerate;
      pieces_of(g.cells.shapes[c], g.cells[c], pieces);
      for (Piece& piece : pieces) {
        const std::span<std::uint32_t> corners = std::span(piece.corners).first(corner_count(piece.shape));
        keep(piece.shape, corners, state_of(g, piece.shape, corners), c);
      }
      continue;
    }
    if (states[c] == CellState::flat) ++facts.degenerate;
    std::array<std::uint32_t, 8> corners;
    std::copy(g.cells[c].begin(), g.cells[c].end(), corners.begin());
    keep(g.cells.shapes[c], std::span(corners).first(g.cells[c].size()), states[c], c);
  }
  g.cells = std::move(cells);
  return source;
}

}  // namespace sansmesh::inline v1
