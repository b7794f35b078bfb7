#include "sansmesh/volume/grid/block_order.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/grid/grid_blocks.h"
#include "sansmesh/volume/grid/point_order.h"

namespace sansmesh::inline v1 {
namespace {

/// Hash of all bytes added.
struct Digest {
  std::uint64_t value = 0x9E3779B97F4A7C15u;
  void add(std::uint64_t v) {
    value = (value ^ v) * 0xff51afd7ed558ccdu;
    value ^= value >> 32;
  }
  void add(const Vec3& x) {
    for (std::size_t k = 0; k < 3; ++k) add(std::bit_cast<std::uint64_t>(x[k]));
  }
  template <class T>
  void add(std::span<const T> numbers) {
    add(numbers.size());
    const auto* bytes = reinterpret_cast<const unsigned char*>(numbers.data());
    const std::size_t size = numbers.size_bytes();
    std::size_t i = 0;
    for (; i + 8 <= size; i += 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes + i, 8);
      add(word);
    }
    for (; i < size; ++i) add(std::uint64_t{bytes[i]});
  }
  template <class T>
  void add(const std::vector<T>& numbers) {
    add(std::span<const T>(numbers));
  }
  void add_row(const AttributeTable& table, std::size_t row) {
    for (const Attribute& a : table)
      std::visit([&](const auto& v) { add(std::span(v).subspan(row * a.components, a.components)); }, a.values);
  }
};

/// Corners of a flat or solid cell.
std::span<const std::uint32_t> corners_of_row(const GridBlock& b, std::size_t row) {
  if (!b.cells.empty()) return b.cells[row];
  const auto& flat = b.flat_cells[row];
  return std::span(flat).first(flat[3] == GridBlock::kNone ? 3 : 4);
}

std::uint64_t digest_of_cell(const GridBlock& b, std::size_t row) {
  Digest d;
  d.add_row(b.cell_arrays, row);
  if (!b.hidden_cells.empty()) d.add(std::uint64_t{b.hidden_cells[row]});
  return d.value;
}

/// Structured blocks: all bytes in order; others: order-independent sums over rows.
std::uint64_t digest_of_block(const GridBlock& b) {
  Digest d;
  d.add(static_cast<std::uint64_t>(b.kind));
  for (const AttributeTable* const table : {&b.point_arrays, &b.cell_arrays})
    for (const Attribute& a : *table) {
      d.add(std::vector<char>(a.name.begin(), a.name.end()));
      d.add(a.components);
    }
  if (is_structured(b)) {
    for (const auto& axis : b.axes) d.add(axis);
    for (const Vec3& direction : b.directions) d.add(direction);
    d.add(b.origin);
    for (const std::size_t n : b.dims) d.add(n);
    d.add(b.points);
    for (const AttributeTable* const table : {&b.point_arrays, &b.cell_arrays})
      for (const Attribute& a : *table) std::visit([&](const auto& v) { d.add(v); }, a.values);
    d.add(b.hidden_points);
    d.add(b.hidden_cells);
    return d.value;
  }
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    Digest point;
    point.add(b.points[i]);
    point.add(digest_of_point(b, i));
    sum += point.value;
  }
  for (std::size_t c = 0; c < cell_count_of(b); ++c) {
    Digest cell;
    for (const std::uint32_t p : corners_of_row(b, c)) cell.add(b.points[p]);
    cell.add(digest_of_cell(b, c));
    sum += cell.value;
  }
  d.add(b.points.size());
  d.add(sum);
  return d.value;
}

}  // namespace

std::uint64_t digest_of_point(const GridBlock& b, std::size_t row) {
  Digest d;
  d.add_row(b.point_arrays, row);
  if (!b.hidden_points.empty()) d.add(std::uint64_t{b.hidden_points[row]});
  return d.value;
}

std::vector<std::size_t> canonical_order(const GridData& data) {
  std::vector<std::size_t> order(data.blocks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() < 2) return order;
  std::vector<std::uint64_t> digests(order.size());
  parallel_for(0, order.size(), 1, [&](std::size_t b) { digests[b] = digest_of_block(data.blocks[b]); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const int la = data.blocks[a].level, lb = data.blocks[b].level;
    return la != lb ? la < lb : digests[a] < digests[b];
  });
  return order;
}

BlockRows canonical_rows(const GridBlock& b) {
  BlockRows rows;
  if (is_structured(b)) return rows;
  rows.points = canonical_point_order(
      b.points, [&](std::uint32_t i, std::uint32_t j) { return digest_of_point(b, i) < digest_of_point(b, j); });
  std::vector<Vec3> middles(cell_count_of(b));
  parallel_for(0, middles.size(), 8192, [&](std::size_t c) {
    const auto corners = corners_of_row(b, c);
    Vec3 sum;
    for (const std::uint32_t p : corners) sum += b.points[p];
    middles[c] = sum / static_cast<double>(corners.size());
  });
  rows.cells = canonical_point_order(middles, [&](std::uint32_t i, std::uint32_t j) {
    const auto p = corners_of_row(b, i), q = corners_of_row(b, j);
    if (p.size() != q.size()) return p.size() < q.size();
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec3 &x = b.points[p[k]], &y = b.points[q[k]];
      if (x != y) return lexicographic_less(x, y);
    }
    return digest_of_cell(b, i) < digest_of_cell(b, j);
  });
  return rows;
}

}  // namespace sansmesh::inline v1
