#include "sansmesh/volume/grid/gather_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/grid/block_order.h"
#include "sansmesh/volume/grid/flat_cells.h"
#include "sansmesh/volume/grid/grid_blocks.h"

namespace sansmesh::inline v1 {
namespace {

/// Visits the cells of a single-layer structured block as quadrilaterals, in order.
template <class Visit>
void each_flat_cell(const GridBlock& b, const Visit& visit) {
  std::array<std::size_t, 2> m{}, stride{};
  std::size_t axes = 0, step = 1;
  const auto n = dims_of(b);
  for (std::size_t k = 0; k < 3; step *= n[k++])
    if (n[k] > 1) m[axes] = n[k], stride[axes++] = step;
  std::size_t row = 0;
  for (std::size_t j = 0; j + 1 < m[1]; ++j)
    for (std::size_t i = 0; i + 1 < m[0]; ++i, ++row) {
      const auto p = static_cast<std::uint32_t>(i * stride[0] + j * stride[1]);
      const auto x = static_cast<std::uint32_t>(stride[0]), y = static_cast<std::uint32_t>(stride[1]);
      visit(row, std::array{p, p + x, p + x + y, p + y});
    }
}

/// Appends one block to the lists.
class BlockGatherer {
 public:
  BlockGatherer(const GridBlock& block, std::size_t number, bool many, bool centers, bool cut, GatheredCells& out,
                std::vector<FlatCell>& flat, VolumeFacts& facts)
      : b_(block),
        number_(static_cast<std::uint16_t>(number)),
        many_(many),
        centers_(centers),
        cut_(cut),
        out_(out),
        flat_(flat),
        facts_(facts),
        rows_(canonical_rows(block)) {}

  void run() {
    add_points();
    if (cut_) number_wholes();
    if (!is_structured(b_))
      b_.cells.empty() ? add_flat_cells() : add_cells();
    else if (layers_of(b_) == 0)
      add_structured();
    else if (layers_of(b_) == 1)
      each_flat_cell(b_, [&](std::size_t row, const std::array<std::uint32_t, 4>& c) { add_flat(row, c); });
  }

 private:
  void add_points() {
    const std::size_t n = point_count_of(b_), first = out_.points.size();
    usable_.assign(n, 1);
    out_.points.reserve(first + n);
    out_.point_row.reserve(first + n);
    number_of_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = rows_.points.empty() ? k : rows_.points[k];
      const Vec3 p = point_of(b_, i);
      if (!is_finite(p))
        usable_[i] = 0, ++facts_.not_finite;
      else if (!b_.hidden_points.empty() && b_.hidden_points[i])
        usable_[i] = 0, ++facts_.hidden;
      number_of_[i] = static_cast<std::uint32_t>(first + k);
      out_.points.push_back(usable_[i] ? p : Vec3{});
      out_.point_row.push_back(static_cast<std::uint32_t>(i));
      if (many_) out_.point_block.push_back(number_);
      out_.joinable.push_back(!is_structured(b_) || many_ || on_side(i));
    }
  }

  /// Numbers the cells of the file: runs of equal numbers in piece_of.
  void number_wholes() {
    whole_of_.resize(cell_count_of(b_));
    for (std::size_t c = 0; c < whole_of_.size(); ++c) {
      const bool continues = c > 0 && !b_.piece_of.empty() && b_.piece_of[c] == b_.piece_of[c - 1];
      whole_of_[c] = continues ? out_.wholes - 1 : out_.wholes++;
    }
  }

  bool on_side(std::size_t i) const {
    const auto n = dims_of(b_);
    const std::size_t at[] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
    for (std::size_t k = 0; k < 3; ++k)
      if (at[k] == 0 || at[k] + 1 == n[k]) return true;
    return false;
  }

  bool visible(std::size_t row, std::span<const std::uint32_t> points) {
    if (!b_.hidden_cells.empty() && b_.hidden_cells[row]) {
      ++facts_.hidden;
      return false;
    }
    return std::all_of(points.begin(), points.end(), [this](std::uint32_t p) { return usable_[p] != 0; });
  }

  /// `points`: indices in the block.
  void add_cell(CellShape shape, std::span<const std::uint32_t> points, std::size_t row) {
    if (!visible(row, points)) return;
    std::array<std::uint32_t, 8> corners;
    Vec3 sum;
    for (std::size_t c = 0; c < points.size(); ++c) {
      corners[c] = number_of_[points[c]];
      if (centers_) sum += out_.points[corners[c]];
    }
    out_.cells.add(shape, std::span(corners).first(points.size()));
    out_.cell_row.push_back(static_cast<std::uint32_t>(row));
    if (many_) out_.cell_block.push_back(number_);
    if (cut_) out_.cell_whole.push_back(whole_of_[row]);
    if (centers_) out_.centers.push_back(sum / static_cast<double>(points.size()));
    if (!centers_ && !b_.higher.of_piece.empty()) add_higher(row);
  }

  /// Marks the last cell as a piece of its cell of higher order, if all nodes of that are usable.
  void add_higher(std::size_t row) {
    HigherOrderCells& higher = out_.higher;
    higher.of_piece.resize(out_.cells.size(), HigherOrderCells::kNone);
    const std::uint32_t from = b_.higher.of_piece[row];
    if (from == HigherOrderCells::kNone) return;
    if (higher_of_.empty()) higher_of_.assign(b_.higher.size(), HigherOrderCells::kNone);
    if (higher_of_[from] == HigherOrderCells::kNone) {
      std::vector<std::uint32_t> nodes;
      for (const std::uint32_t p : b_.higher[from])
        if (usable_[p]) nodes.push_back(number_of_[p]);
      if (nodes.size() < b_.higher[from].size()) return;
      higher_of_[from] = static_cast<std::uint32_t>(higher.size());
      higher.add(b_.higher.kinds[from], nodes);
    }
    higher.of_piece.back() = higher_of_[from];
  }

  void add_cells() {
    for (const std::uint32_t c : rows_.cells) add_cell(b_.cells.shapes[c], b_.cells[c], c);
  }

  void add_structured() {
    const auto n = dims_of(b_);
    std::size_t row = 0;
    out_.cells.shapes.reserve(out_.cells.size() + cell_count_of(b_));
    out_.cells.first.reserve(out_.cells.first.size() + cell_count_of(b_));
    out_.cells.corners.reserve(out_.cells.corners.size() + 8 * cell_count_of(b_));
    for (std::size_t k = 0; k + 1 < n[2]; ++k)
      for (std::size_t j = 0; j + 1 < n[1]; ++j)
        for (std::size_t i = 0; i + 1 < n[0]; ++i, ++row) {
          const auto p = static_cast<std::uint32_t>(i + n[0] * (j + n[1] * k));
          const auto x = std::uint32_t{1}, y = static_cast<std::uint32_t>(n[0]),
                     z = static_cast<std::uint32_t>(n[0] * n[1]);
          add_cell(CellShape::hexahedron,
                   std::array{p, p + x, p + x + y, p + y, p + z, p + z + x, p + z + x + y, p + z + y}, row);
        }
  }

  void add_flat(std::size_t row, std::array<std::uint32_t, 4> corners) {
    const std::size_t count = corners[3] == GridBlock::kNone ? 3 : 4;
    if (!visible(row, std::span(corners).first(count))) return;
    for (std::size_t k = 0; k < count; ++k) corners[k] = number_of_[corners[k]];
    flat_.push_back({corners, static_cast<std::uint32_t>(row), number_});
  }

  void add_flat_cells() {
    for (const std::uint32_t c : rows_.cells) add_flat(c, b_.flat_cells[c]);
  }

  const GridBlock& b_;
  std::uint16_t number_;
  bool many_, centers_, cut_;
  GatheredCells& out_;
  std::vector<FlatCell>& flat_;
  VolumeFacts& facts_;
  BlockRows rows_;
  std::vector<std::uint8_t> usable_;      ///< per row
  std::vector<std::uint32_t> number_of_;  ///< per row: index in the list of all points
  std::vector<std::uint32_t> higher_of_;  ///< per cell of higher order: its number in the list; empty until needed
  std::vector<std::uint32_t> whole_of_;   ///< per row of cells: number of the file's cell, if any block has cut cells
};

/// Moves the centers of the pieces of one cell to the mean of these centers, weighted by volume.
void join_centers(GatheredCells& g) {
  struct Mean {
    Vec3 sum, plain;
    double volume = 0, count = 0;
  };
  std::vector<Mean> means(g.wholes);
  for (std::size_t c = 0; c < g.centers.size(); ++c) {
    const std::size_t w = g.cell_whole[c];
    std::array<Vec3, 8> x;
    const auto corners = g.cells[c];
    for (std::size_t k = 0; k < corners.size(); ++k) x[k] = g.points[corners[k]] - g.points[corners[0]];
    const double volume = std::abs(cell_volume(g.cells.shapes[c], std::span(x).first(corners.size())));
    means[w].sum += g.centers[c] * volume, means[w].volume += volume;
    means[w].plain += g.centers[c], means[w].count += 1;
  }
  for (std::size_t c = 0; c < g.centers.size(); ++c) {
    const Mean& m = means[g.cell_whole[c]];
    if (m.count == 1) continue;
    const Vec3 center = m.sum / m.volume;
    g.centers[c] = is_finite(center) ? center : m.plain / m.count;
  }
}

}  // namespace

GatheredCells gather_cells(const GridData& data, const std::vector<std::size_t>& order, bool centers,
                           VolumeFacts& facts) {
  facts.blocks = data.blocks.size();
  bool solid = false, cut = false;
  for (const GridBlock& b : data.blocks) {
    facts.points += point_count_of(b);
    facts.cells += whole_count_of(b);
    cut = cut || !b.piece_of.empty();
    solid = solid || is_solid(b);
  }
  GatheredCells gathered;
  std::vector<FlatCell> flat;
  for (const std::size_t b : order) {
    const GridBlock& block = data.blocks[b];
    if (block.kind == GridKind::scattered || point_count_of(block) == 0 || (solid && !is_solid(block))) continue;
    BlockGatherer(block, b, data.blocks.size() > 1, centers, cut, gathered, flat, facts).run();
  }
  if (!gathered.higher.of_piece.empty())
    gathered.higher.of_piece.resize(gathered.cells.size(), HigherOrderCells::kNone);
  if (!gathered.cell_whole.empty() && centers) join_centers(gathered);
  if (!flat.empty()) thicken(flat, centers, gathered, facts);
  return gathered;
}

HigherOrderCells kept_higher(const HigherOrderCells& all, const std::vector<std::uint32_t>& source,
                             const std::vector<std::uint32_t>& number, std::size_t cells) {
  HigherOrderCells kept;
  if (all.of_piece.empty()) return kept;
  constexpr std::uint32_t kNew = 0xfffffffeu;
  std::vector<std::uint32_t> kept_as(all.size(), kNew), nodes, sorted;
  kept.of_piece.assign(cells, HigherOrderCells::kNone);
  for (std::size_t c = 0; c < cells; ++c) {
    const std::uint32_t whole = all.of_piece[source.empty() ? c : source[c]];
    if (whole == HigherOrderCells::kNone) continue;
    if (kept_as[whole] == kNew) {
      nodes.clear();
      for (const std::uint32_t p : all[whole]) nodes.push_back(number[p]);
      sorted = nodes;
      std::sort(sorted.begin(), sorted.end());
      const bool usable = sorted.back() != kUnused && std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
      kept_as[whole] = usable ? static_cast<std::uint32_t>(kept.size()) : HigherOrderCells::kNone;
      if (usable) kept.add(all.kinds[whole], nodes);
    }
    kept.of_piece[c] = kept_as[whole];
  }
  if (kept.empty()) kept = {};
  return kept;
}

}  // namespace sansmesh::inline v1
