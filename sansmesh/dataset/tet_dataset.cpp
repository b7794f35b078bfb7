#include "sansmesh/dataset/tet_dataset.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/volume/cells/cell_tetrahedra.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kFlatTet = 1e-12;  ///< volume over the cube of the longest edge

/// Six times the volume, and the longest edge.
std::pair<double, double> measures_of(const Tet& t, const std::vector<Vec3>& x) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, norm(x[t[i]] - x[t[j]]));
  return {dot(x[t[1]] - x[t[0]], cross(x[t[2]] - x[t[0]], x[t[3]] - x[t[0]])), longest};
}

/// Tetrahedra in order, with the cell of each.
struct TetPieces {
  std::vector<Tet> tets;
  std::vector<std::uint32_t> cells;
  std::size_t cut = 0, hidden = 0;
};

void append_pieces(const GridBlock& block, std::uint32_t first_point, std::uint32_t first_cell, TetPieces& all) {
  std::vector<Tet> pieces;
  std::vector<std::uint32_t> corners;
  for (std::size_t c = 0; c < block.cells.size(); ++c) {
    if (!block.hidden_cells.empty() && block.hidden_cells[c]) {
      ++all.hidden;
      continue;
    }
    const auto in_block = block.cells[c];
    corners.assign(in_block.begin(), in_block.end());
    pieces.clear();
    detail::cell_tetrahedra(block.cells.shapes[c], corners, pieces);
    if (block.cells.shapes[c] != CellShape::tetrahedron) ++all.cut;
    for (Tet& t : pieces) {
      for (std::uint32_t& v : t) v += first_point;
      all.tets.push_back(t);
      all.cells.push_back(first_cell + static_cast<std::uint32_t>(c));
    }
  }
}

/// Removes all but the first of tetrahedra with the same corners; returns the number removed.
std::size_t drop_twins(TetPieces& p) {
  std::vector<Tet> sorted = p.tets;
  for (Tet& t : sorted) std::sort(t.begin(), t.end());
  std::vector<std::uint32_t> order(sorted.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(sorted[a], a) < std::pair(sorted[b], b); });
  std::vector<std::uint8_t> twin(sorted.size(), 0);
  for (std::size_t k = 1; k < order.size(); ++k) twin[order[k]] = sorted[order[k]] == sorted[order[k - 1]];
  std::size_t kept = 0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    if (twin[k]) continue;
    p.tets[kept] = p.tets[k];
    p.cells[kept++] = p.cells[k];
  }
  const std::size_t dropped = sorted.size() - kept;
  p.tets.resize(kept);
  p.cells.resize(kept);
  return dropped;
}

std::string tets_in_words(std::size_t n) {
  return fmt::format("{} {}", grouped(n), n == 1 ? "tetrahedron" : "tetrahedra");
}

AttributeTable joined(const GridData& data, bool of_points, const std::vector<std::size_t>& rows) {
  std::vector<const AttributeTable*> tables;
  tables.reserve(data.blocks.size());
  for (const GridBlock& b : data.blocks) tables.push_back(of_points ? &b.point_arrays : &b.cell_arrays);
  return join_rows(tables, rows);
}

}  // namespace

std::uint32_t TetDataset::vertex(std::uint64_t number) const {
  // Numbers are consecutive in almost all files.
  const std::uint64_t guess = numbers.empty() || number < numbers[0] ? numbers.size() : number - numbers[0];
  if (guess < numbers.size() && numbers[guess] == number) return static_cast<std::uint32_t>(guess);
  const auto it = std::lower_bound(by_number.begin(), by_number.end(), number,
                                   [&](std::uint32_t v, std::uint64_t n) { return numbers[v] < n; });
  if (it != by_number.end() && numbers[*it] == number) return *it;
  if (by_number.empty()) throw DataError(fmt::format("there is no vertex {}", number));
  throw DataError(fmt::format("there is no vertex {} with tetrahedra: their numbers go from {} to {}", number,
                              numbers[by_number.front()], numbers[by_number.back()]));
}

TetDataset tet_dataset(const GridData& data) {
  TetDataset result;
  result.notes = data.notes;
  TetPieces pieces;
  std::vector<Vec3> points;
  std::vector<std::size_t> point_rows, cell_rows;
  std::size_t cells = 0;
  const auto usable = [](const GridBlock& b) { return b.kind == GridKind::unstructured && !b.cells.empty(); };
  GridData used;
  for (const GridBlock& b : data.blocks) {
    if (!usable(b)) {
      if (b.kind == GridKind::lattice || b.kind == GridKind::curvilinear)
        throw DataError("holds a structured grid and no tetrahedra: mesh it by a tetrahedral mesher first");
      continue;
    }
    if (points.size() + b.points.size() >= GridBlock::kNone || cells + b.cells.size() >= GridBlock::kNone)
      throw DataError("holds more points or cells than are supported (2^32)");
    append_pieces(b, static_cast<std::uint32_t>(points.size()), static_cast<std::uint32_t>(cells), pieces);
    points.insert(points.end(), b.points.begin(), b.points.end());
    cells += b.cells.size();
    point_rows.push_back(b.points.size());
    cell_rows.push_back(b.cells.size());
    GridBlock& arrays = used.blocks.emplace_back();
    arrays.point_arrays = b.point_arrays, arrays.cell_arrays = b.cell_arrays;
    if (point_rows.size() == 1) arrays.point_numbers = b.point_numbers;
  }
  if (pieces.tets.empty()) throw DataError("holds no tetrahedra");
  if (pieces.cut > 0) result.notes.push_back(fmt::format("{} cut into tetrahedra", counted(pieces.cut, "cell")));
  if (pieces.hidden > 0) result.notes.push_back(fmt::format("{} left out", counted(pieces.hidden, "hidden cell")));
  if (point_rows.size() > 1)
    result.notes.emplace_back("vertices of its blocks are apart, and counted from 0 through all of them");

  std::size_t turned = 0;
  for (std::size_t k = 0; k < pieces.tets.size(); ++k) {
    Tet& t = pieces.tets[k];
    for (const std::uint32_t v : t)
      if (!(std::isfinite(points[v].x) && std::isfinite(points[v].y) && std::isfinite(points[v].z)))
        throw DataError(fmt::format("the position of point {} (counted from 0) is not finite", v));
    const auto [six, longest] = measures_of(t, points);
    if (std::abs(six) <= 6 * kFlatTet * longest * longest * longest)
      throw DataError(
          fmt::format("cell {} (counted from 0) has no volume: its corners lie in a plane; take it out, or mesh "
                      "the body anew",
                      pieces.cells[k]));
    if (six > 0) continue;
    std::swap(t[2], t[3]);
    ++turned;
  }
  if (turned > 0)
    result.notes.push_back(fmt::format("{} inside out {} turned", tets_in_words(turned), turned == 1 ? "was" : "were"));
  if (const std::size_t twins = drop_twins(pieces); twins > 0)
    result.notes.push_back(fmt::format("{} of the same corners as others left out", tets_in_words(twins)));

  std::vector<std::uint32_t> new_index(points.size(), GridBlock::kNone), kept;
  for (const Tet& t : pieces.tets)
    for (const std::uint32_t v : t) new_index[v] = 0;
  const std::vector<std::uint64_t> numbers =
      point_rows.size() == 1 ? std::move(used.blocks[0].point_numbers) : std::vector<std::uint64_t>();
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (new_index[v] == GridBlock::kNone) continue;
    new_index[v] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(static_cast<std::uint32_t>(v));
    result.mesh.vertices.push_back(points[v]);
    result.numbers.push_back(numbers.empty() ? v : numbers[v]);
  }
  result.by_number.resize(kept.size());
  std::iota(result.by_number.begin(), result.by_number.end(), 0u);
  std::stable_sort(result.by_number.begin(), result.by_number.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return result.numbers[a] < result.numbers[b]; });
  if (kept.size() < points.size())
    result.notes.push_back(
        fmt::format("{} without tetrahedra left out", counted(points.size() - kept.size(), "point")));
  for (Tet& t : pieces.tets)
    for (std::uint32_t& v : t) v = new_index[v];
  result.mesh.tets = std::move(pieces.tets);
  result.mesh.attributes = joined(used, true, point_rows).taken(kept);
  result.mesh.tet_attributes = joined(used, false, cell_rows).taken(pieces.cells);
  return result;
}

TetDataset read_tets(const std::string& file) {
  try {
    VolumeReadOptions options;
    options.fill.usual = false;  // arrays keep their values
    return tet_dataset(read_volume(file, options));
  } catch (const DataError& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace sansmesh::inline v1
