#include "sansmesh/volume/grid/assemble_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/grid_limits.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_finder.h"
#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/grid/block_order.h"
#include "sansmesh/volume/grid/covered_cells.h"
#include "sansmesh/volume/grid/gather_blocks.h"
#include "sansmesh/volume/grid/gather_points.h"
#include "sansmesh/volume/grid/gathered_cells.h"
#include "sansmesh/volume/grid/grid_blocks.h"
#include "sansmesh/volume/grid/repaired_cells.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {
namespace {

bool any_set(const std::vector<std::uint8_t>& flags) {
  return std::any_of(flags.begin(), flags.end(), [](std::uint8_t f) { return f != 0; });
}

/// Rounds coordinates that are negligible relative to the extent to 0: slopes over such lengths would overflow the
/// float coefficients.
void round_off(std::vector<Vec3>& points) {
  constexpr double kNothing = 1e-30;
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  if (box.empty()) return;
  const Vec3 size = box.size();
  const double least = kNothing * std::max({size.x, size.y, size.z});
  for (Vec3& p : points)
    for (std::size_t k = 0; k < 3; ++k)
      if (p[k] != 0 && std::abs(p[k]) < least) p[k] = 0;
}

/// Tolerates the rounding of float coordinates.
bool is_uniform(const std::vector<double>& axis) {
  const double step = (axis.back() - axis.front()) / static_cast<double>(axis.size() - 1);
  const double largest = std::max(std::abs(axis.front()), std::abs(axis.back()));
  for (std::size_t i = 0; i < axis.size(); ++i)
    if (std::abs(axis[i] - (axis[0] + step * static_cast<double>(i))) >
        1e-6 * step + 2.5e-7 * largest * (step > 4e-6 * largest))
      return false;
  return true;
}

void set_spacings(VolumeFacts& facts, std::vector<double> steps) {
  if (steps.empty()) return;
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  facts.least_spacing = *least, facts.most_spacing = *most;
  facts.median_spacing = median(steps);
}

/// A single lattice block with values and without missing points.
bool stays_lattice(const GridData& data) {
  if (data.blocks.size() != 1) return false;
  const GridBlock& b = data.blocks[0];
  if (b.kind != GridKind::lattice || any_set(b.hidden_points) || any_set(b.hidden_cells)) return false;
  std::size_t layers = 0;
  for (const auto& axis : b.axes) {
    if (axis.empty()) return false;
    layers += axis.size() == 1;
    for (std::size_t i = 0; i < axis.size(); ++i)
      if (!std::isfinite(axis[i]) || (i > 0 && !(axis[i] > axis[i - 1]))) return false;
  }
  return layers <= 1 && is_finite(b.origin);
}

SampledVolume lattice_volume(const GridBlock& block, bool in_cells) {
  SampledVolume volume;
  Lattice lattice;
  lattice.directions = block.directions, lattice.origin = block.origin;
  VolumeFacts& facts = volume.facts;
  facts.blocks = 1, facts.points = 1, facts.cells = 1;
  bool uniform = true;
  std::vector<double> steps, of_axis;
  for (const auto& axis : block.axes) {
    facts.points *= axis.size();
    facts.cells *= std::max<std::size_t>(1, axis.size() - 1);
    for (std::size_t i = 1; i < axis.size(); ++i) of_axis.push_back(axis[i] - axis[i - 1]);
  }
  const double typical = median(of_axis);
  std::array<std::size_t, 3> copies{1, 1, 1};  // repetitions of a single layer
  std::array<std::size_t, 3> rows{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> axis = block.axes[k];
    if (axis.size() == 1) {
      facts.layer = typical;
      axis = {axis[0] - typical / 2, axis[0] + typical / 2};
      if (!in_cells) copies[k] = 2;
    }
    lattice.lower[k] = axis.front(), lattice.upper[k] = axis.back();
    for (std::size_t i = 1; i < axis.size(); ++i) steps.push_back(axis[i] - axis[i - 1]);
    rows[k] = block.axes[k].size();
    if (in_cells) {
      uniform = uniform && is_uniform(axis);
      rows[k] = axis.size() - 1;
      for (std::size_t i = 0; i + 1 < axis.size(); ++i) axis[i] = axis[i] * 0.5 + axis[i + 1] * 0.5;
      axis.pop_back();
      if (axis.size() == 1) axis = {lattice.lower[k], lattice.upper[k]}, copies[k] = 2;
    }
    uniform = uniform && is_uniform(axis);
    lattice.axes[k] = std::move(axis);
  }
  lattice.uniform = uniform;
  if (lattice.size() > 0xfffffff0u)
    throw DataError(fmt::format("{} samples are more than can be used", lattice.size()));
  const AttributeTable& table = in_cells ? block.cell_arrays : block.point_arrays;
  table.check_rows(rows[0] * rows[1] * rows[2], in_cells ? "cells" : "points");
  if (copies == std::array<std::size_t, 3>{1, 1, 1}) {
    volume.attributes = table;
  } else {
    std::vector<std::uint32_t> taken;
    taken.reserve(lattice.size());
    for (std::size_t k = 0; k < lattice.axes[2].size(); ++k)
      for (std::size_t j = 0; j < lattice.axes[1].size(); ++j)
        for (std::size_t i = 0; i < lattice.axes[0].size(); ++i)
          taken.push_back(static_cast<std::uint32_t>(
              (copies[0] == 2 ? 0 : i) + rows[0] * ((copies[1] == 2 ? 0 : j) + rows[1] * (copies[2] == 2 ? 0 : k))));
    volume.attributes = table.taken(taken);
  }
  facts.grid = uniform ? "uniform" : "rectilinear";
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  facts.aspect = *most / *least;
  set_spacings(facts, std::move(steps));
  volume.lattice = std::move(lattice);
  volume.in_cells = in_cells;
  return volume;
}

std::string grid_in_words(const GridData& data, const VolumeFacts& facts) {
  if (facts.levels > 1) return fmt::format("AMR, {} levels", facts.levels);
  std::set<std::string> kinds;
  for (const GridBlock& b : data.blocks)
    kinds.insert(b.kind == GridKind::lattice       ? "rectilinear"
                 : b.kind == GridKind::curvilinear ? "curvilinear"
                 : b.kind == GridKind::scattered   ? "scattered"
                                                   : "unstructured");
  std::string words;
  for (const std::string& kind : kinds) words += (words.empty() ? "" : " and ") + kind;
  if (data.blocks.size() == 1) return words;
  return fmt::format("{} {}{} blocks", data.blocks.size(), facts.overlapped > 0 ? "overlapping " : "", words);
}

/// Common type of arrays of one name in several tables.
struct CommonArray {
  std::size_t components = 1;
  NumberType type = NumberType::f64;
};

template <class T>
AttributeValues numbers_as(const Attribute& a) {
  return std::visit([](const auto& v) -> AttributeValues { return std::vector<T>(v.begin(), v.end()); }, a.values);
}

/// The number of components of most rows (among several the largest), and a type that holds all numbers of these: a
/// real type if rows are unknown, for NaN.
CommonArray common_array(const std::string& name, std::span<const AttributeTable* const> tables,
                         std::span<const std::size_t> rows) {
  std::map<std::size_t, std::size_t> rows_of_width;
  for (std::size_t k = 0; k < tables.size(); ++k)
    if (const Attribute* const a = tables[k]->find(name)) rows_of_width[a->components] += rows[k];
  CommonArray common;
  std::size_t most = 0;
  for (const auto& [components, count] : rows_of_width)
    if (count >= most) most = count, common.components = components;
  std::set<NumberType> types;
  bool everywhere = true, real = false, narrow = true;
  for (const AttributeTable* const table : tables) {
    const Attribute* const a = table->find(name);
    if (!a || a->components != common.components) {
      everywhere = false;
      continue;
    }
    types.insert(a->type());
    real = real || is_real(a->type());
    narrow = narrow && (a->type() == NumberType::f32 || size_of(a->type()) <= 2);
  }
  if (types.size() == 1 && (everywhere || real))
    common.type = *types.begin();
  else if (everywhere && !real && !types.contains(NumberType::u64))
    common.type = NumberType::i64;
  else
    common.type = narrow ? NumberType::f32 : NumberType::f64;
  return common;
}

/// Like join_rows, but without loss of precision if blocks have an array with different types.
AttributeTable join_unlike(std::vector<const AttributeTable*> tables, std::span<const std::size_t> rows) {
  std::set<std::string> names;
  for (const AttributeTable* const table : tables)
    for (const Attribute& a : *table) names.insert(a.name);
  const std::vector<const AttributeTable*> given = tables;
  std::vector<AttributeTable> changed(tables.size());
  const auto to_change = [&](std::size_t k) -> AttributeTable& {
    if (tables[k] == given[k]) changed[k] = *given[k], tables[k] = &changed[k];
    return changed[k];
  };
  for (const std::string& name : names) {
    const CommonArray common = common_array(name, given, rows);
    for (std::size_t k = 0; k < given.size(); ++k) {
      const Attribute* const a = given[k]->find(name);
      if (!a || (a->components == common.components && a->type() == common.type)) continue;
      if (a->components != common.components)
        to_change(k).erase(name);
      else
        to_change(k).set({name,
                          common.type == NumberType::f64   ? numbers_as<double>(*a)
                          : common.type == NumberType::f32 ? numbers_as<float>(*a)
                                                           : numbers_as<std::int64_t>(*a),
                          a->components});
    }
  }
  return join_rows(tables, rows);
}

/// The arrays of selected rows of all blocks: `blocks` (empty: the first) and `rows` of each.
AttributeTable rows_of_blocks(const GridData& data, const std::vector<std::size_t>& order, bool of_cells,
                              std::span<const std::uint16_t> blocks, std::span<const std::uint32_t> rows) {
  const auto table = [&](std::size_t b) -> const AttributeTable& {
    return of_cells ? data.blocks[b].cell_arrays : data.blocks[b].point_arrays;
  };
  if (blocks.empty()) return table(0).taken(rows);
  std::vector<const AttributeTable*> tables;
  std::vector<std::size_t> counts, first(data.blocks.size(), 0);
  std::vector<std::size_t> most(data.blocks.size(), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) most[blocks[i]] = std::max<std::size_t>(most[blocks[i]], rows[i] + 1);
  std::size_t total = 0;
  for (const std::size_t b : order) {
    if (most[b] == 0) continue;
    tables.push_back(&table(b));
    counts.push_back(table(b).empty() ? most[b] : table(b)[0].rows());
    first[b] = total;
    total += counts.back();
  }
  const AttributeTable joined = join_unlike(std::move(tables), counts);
  std::vector<std::uint32_t> taken(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) taken[i] = static_cast<std::uint32_t>(first[blocks[i]] + rows[i]);
  return joined.taken(taken);
}

/// Numbers the points used as cell corners from 0, in order of use; kUnused for the others.
std::vector<std::uint32_t> used_points(const CellList& cells, std::size_t points, std::size_t& count) {
  std::vector<std::uint32_t> number(points, kUnused);
  for (const std::uint32_t p : cells.corners) number[p] = 0;
  count = 0;
  for (std::uint32_t& n : number)
    if (n != kUnused) n = static_cast<std::uint32_t>(count++);
  return number;
}

void set_cell_facts(SampledVolume& volume) {
  const CellList& cells = volume.cells;
  volume.facts.aspect = std::sqrt(parallel_reduce(
      cells.size(), 65536, 1.0,
      [&](std::size_t first, std::size_t last) {
        double most = 1;
        std::array<Vec3, 8> x;
        for (std::size_t c = first; c < last; ++c) {
          const auto corners = cells[c];
          for (std::size_t k = 0; k < corners.size(); ++k) x[k] = volume.corner(corners[k]);
          const EdgeRange edges = squared_edges(cells.shapes[c], std::span(x).first(corners.size()));
          if (edges.shortest > 0) most = std::max(most, edges.longest / edges.shortest);
        }
        return most;
      },
      [](double a, double b) { return std::max(a, b); }));
  std::vector<double> steps;
  const std::size_t every = 1 + volume.stars.entries.size() / 20000000;
  for (std::size_t i = 0; i < volume.positions.size(); ++i)
    for (const std::uint32_t j : volume.stars[i])
      if (j > i && (every == 1 || (i + j) % every == 0))
        steps.push_back(norm(volume.positions[j] - volume.positions[i]));
  set_spacings(volume.facts, std::move(steps));
}

/// Removes the cells covered by finer cells of other blocks. Keeps `source` of each cell in step.
void remove_overlapped(GatheredCells& gathered, std::vector<std::uint32_t>& source, VolumeFacts& facts) {
  if (gathered.cell_block.empty()) return;
  std::vector<std::uint16_t> block(gathered.cells.size());
  for (std::size_t c = 0; c < block.size(); ++c) block[c] = gathered.cell_block[source.empty() ? c : source[c]];
  if (std::all_of(block.begin(), block.end(), [&](std::uint16_t b) { return b == block[0]; })) return;
  const auto gone = overlapped_cells(gathered.cells, gathered.points, block);
  if (!any_set(gone)) return;
  std::size_t before = 0, after = 0;
  used_points(gathered.cells, gathered.points.size(), before);
  CellList cells;
  std::vector<std::uint32_t> left;
  for (std::size_t c = 0; c < gone.size(); ++c) {
    if (gone[c]) continue;
    cells.add(gathered.cells.shapes[c], gathered.cells[c]);
    left.push_back(source.empty() ? static_cast<std::uint32_t>(c) : source[c]);
  }
  const std::size_t lost = gone.size() - cells.size();
  gathered.cells = std::move(cells);
  source = std::move(left);
  used_points(gathered.cells, gathered.points.size(), after);
  facts.overlapped = gathered.centers.empty() ? before - after : lost;
}

/// Samples at cell corners; `source`: previous index of each cell, empty if unchanged.
void set_point_samples(const GridData& data, const std::vector<std::size_t>& order, GatheredCells& gathered,
                       const std::vector<std::uint32_t>& first_there, const std::vector<std::uint32_t>& source,
                       SampledVolume& volume) {
  const std::size_t points = gathered.points.size();
  std::size_t count = 0;
  const auto number = used_points(gathered.cells, points, count);
  std::vector<std::uint32_t> rows, group;
  std::vector<std::uint16_t> blocks;
  volume.positions.resize(count);
  if (!gathered.point_block.empty()) volume.block.resize(count);
  for (std::size_t p = 0; p < points; ++p) {
    const std::uint32_t there = first_there.empty() ? static_cast<std::uint32_t>(p) : first_there[p];
    if (number[there] == kUnused) continue;
    if (there == p) {
      volume.positions[number[p]] = gathered.points[p];
      if (!gathered.point_block.empty()) volume.block[number[p]] = gathered.point_block[p];
    } else {
      ++volume.facts.merged;
    }
    rows.push_back(gathered.point_row[p]);
    if (!first_there.empty()) group.push_back(number[there]);
    if (!gathered.point_block.empty()) blocks.push_back(gathered.point_block[p]);
  }
  volume.attributes = rows_of_blocks(data, order, false, blocks, rows);
  if (volume.facts.merged > 0)
    volume.attributes = volume.attributes.means(group, std::vector<double>(group.size(), 1.0), count);
  volume.cells = std::move(gathered.cells);
  for (std::uint32_t& p : volume.cells.corners) p = number[p];
  volume.higher = kept_higher(gathered.higher, source, number, volume.cells.size());
  volume.stars = edge_neighbours(volume.cells, count);
  if (volume.block.empty()) return;
  // Links across non-conforming block borders: a sample there and the corners of the cell beyond.
  const FaceNeighbours faces(volume.cells, volume.positions);
  std::vector<std::uint64_t> links;
  for_each_partial_neighbour(faces, [&](std::uint32_t cell, std::uint32_t corner, std::uint32_t other) {
    const double most = 1.5 * std::max(faces.finder().mean_edge(cell), faces.finder().mean_edge(other));
    for (const std::uint32_t p : volume.cells[other])
      if (squared_norm(volume.positions[p] - volume.positions[corner]) <= most * most)
        links.push_back(link_of(corner, p));
  });
  if (!links.empty()) volume.stars = united(volume.stars, symmetric_links(links, count));
}

/// Cell data as samples; `source`: previous index of each cell, empty if unchanged.
void set_cell_samples(const GridData& data, const std::vector<std::size_t>& order, GatheredCells& gathered,
                      const std::vector<std::uint32_t>& source, SampledVolume& volume) {
  std::size_t count = 0;
  const auto number = used_points(gathered.cells, gathered.points.size(), count);
  volume.corners.resize(count);
  for (std::size_t p = 0; p < number.size(); ++p)
    if (number[p] != kUnused) volume.corners[number[p]] = gathered.points[p];
  volume.cells = std::move(gathered.cells);
  for (std::uint32_t& p : volume.cells.corners) p = number[p];
  // The pieces of one cell share its sample, whether the reader cut it or a repair.
  std::vector<std::uint32_t> rows;
  std::vector<std::uint32_t> sample_of(std::max<std::size_t>(gathered.cell_row.size(), gathered.wholes), kUnused);
  std::vector<std::uint16_t> blocks;
  volume.cell_sample.resize(volume.cells.size());
  for (std::size_t c = 0; c < volume.cells.size(); ++c) {
    const std::uint32_t from = source.empty() ? static_cast<std::uint32_t>(c) : source[c];
    std::uint32_t& sample = sample_of[gathered.cell_whole.empty() ? from : gathered.cell_whole[from]];
    if (sample == kUnused) {
      sample = static_cast<std::uint32_t>(volume.positions.size());
      rows.push_back(gathered.cell_row[from]);
      if (!gathered.cell_block.empty()) blocks.push_back(gathered.cell_block[from]);
      volume.positions.push_back(gathered.centers[from]);
    }
    volume.cell_sample[c] = sample;
  }
  volume.attributes = rows_of_blocks(data, order, true, blocks, rows);
  volume.block = std::move(blocks);
  const FaceNeighbours faces(volume.cells, volume.corners);
  std::vector<std::uint64_t> links;
  for (std::size_t c = 0; c < volume.cells.size(); ++c)
    for (std::size_t f = 0; f < kMostFaces; ++f)
      if (const std::uint32_t other = faces.equal(c, f); other != kNoCell && other > c)
        links.push_back(link_of(volume.cell_sample[c], volume.cell_sample[other]));
  for_each_partial_neighbour(faces, [&](std::uint32_t cell, std::uint32_t, std::uint32_t other) {
    links.push_back(link_of(volume.cell_sample[cell], volume.cell_sample[other]));
  });
  volume.stars = symmetric_links(links, volume.positions.size());
}

/// Sets the level of each sample from its block.
void set_levels(const GridData& data, SampledVolume& volume) {
  std::set<int> levels;
  for (const GridBlock& b : data.blocks) levels.insert(b.level);
  volume.facts.levels = levels.size();
  if (levels.size() < 2) return;
  volume.level.resize(volume.block.size());
  for (std::size_t i = 0; i < volume.level.size(); ++i)
    volume.level[i] = static_cast<std::uint8_t>(std::clamp(data.blocks[volume.block[i]].level, 0, 255));
}

/// Throws if arrays exist, but none of the association; grids without any arrays are valid.
void check_arrays(const GridData& data, const SampledVolume& volume) {
  if (volume.attributes.empty() && std::any_of(data.blocks.begin(), data.blocks.end(), [](const GridBlock& b) {
        return !b.point_arrays.empty() || !b.cell_arrays.empty();
      }))
    throw DataError(volume.in_cells ? "there are no arrays of cells" : "there are no arrays of points");
}

}  // namespace

SampledVolume assemble_volume(const GridData& data, Association association, Progress& progress) {
  const bool in_cells = association == Association::cells;
  progress.begin("assembling the volume", 5);
  if (data.blocks.empty()) throw DataError("there are no points");
  if (const std::string cause = out_of_limits(data); !cause.empty()) throw DataError(cause);
  if (stays_lattice(data)) {
    SampledVolume volume = lattice_volume(data.blocks[0], in_cells);
    check_arrays(data, volume);
    progress.finish();
    return volume;
  }
  SampledVolume volume;
  volume.in_cells = in_cells;
  check_blocks(data);
  const auto order = canonical_order(data);
  GatheredCells gathered = gather_cells(data, order, in_cells, volume.facts);
  round_off(gathered.points);
  progress.advance();
  const bool scattered = gathered.cells.empty() &&
                         std::any_of(data.blocks.begin(), data.blocks.end(),
                                     [](const auto& b) { return b.kind == GridKind::scattered && !b.points.empty(); });
  if (scattered && in_cells) throw DataError("scattered points have no cells");
  std::vector<std::uint32_t> scattered_groups;
  if (scattered) gathered = gather_scattered(data, order, volume.facts, scattered_groups);
  volume.scattered = scattered;
  if (volume.facts.points == 0) throw DataError("there are no points");
  if (volume.facts.points == volume.facts.not_finite) throw DataError("no point has finite coordinates");
  if (gathered.cells.empty())
    throw DataError(volume.facts.hidden > 0 ? "all cells are hidden" : "there are no cells: all points lie on a line");
  volume.facts.hidden += remove_below_levels(data, gathered);
  const auto first_there = scattered ? std::move(scattered_groups) : join_coincident(gathered);
  progress.advance();
  auto source = repair_cells(gathered, volume.facts);
  if (gathered.cells.empty()) throw DataError("no cell has any volume: all points lie in a plane or on a line");
  if (!scattered) remove_overlapped(gathered, source, volume.facts);
  progress.advance();
  if (in_cells)
    set_cell_samples(data, order, gathered, source, volume);
  else
    set_point_samples(data, order, gathered, first_there, source, volume);
  gathered = {};
  check_arrays(data, volume);
  progress.advance();
  set_levels(data, volume);
  volume.part = connected_parts(volume.stars, volume.facts.parts);
  if (volume.facts.parts == 1) volume.part = {};
  set_cell_facts(volume);
  volume.facts.grid = grid_in_words(data, volume.facts);
  volume.facts.unstructured =
      data.blocks.size() == 1 && volume.facts.levels == 1 && data.blocks[0].kind == GridKind::unstructured;
  progress.finish();
  return volume;
}

}  // namespace sansmesh::inline v1
