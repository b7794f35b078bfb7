// Synthetic grids of cells of higher order, with their pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/grid_data.h"
#include "volume/volume_grids.h"

namespace sansmesh::test {

/// A cube of n³ hexahedra, or six times as many tetrahedra, of order p.
struct HigherOrderGrid {
  HigherOrderFamily family = HigherOrderFamily::tetrahedron;
  std::size_t n = 3, p = 2;
  std::function<Vec3(const Vec3&)> map = [](const Vec3& x) { return x; };
  bool straight = true;  ///< the map moves only corners; other nodes follow
};

using LatticeIndex = std::array<std::size_t, 3>;

class HigherOrderMaker {
 public:
  explicit HigherOrderMaker(const HigherOrderGrid& grid) : grid_(grid), p_(grid.p) {
    block_.kind = GridKind::unstructured;
  }

  GridBlock make() {
    for (std::size_t k = 0; k < grid_.n; ++k)
      for (std::size_t j = 0; j < grid_.n; ++j)
        for (std::size_t i = 0; i < grid_.n; ++i) add({i * p_, j * p_, k * p_});
    return std::move(block_);
  }

 private:
  void add(const LatticeIndex& from) {
    if (grid_.family == HigherOrderFamily::hexahedron) return add_hexahedron(from);
    if (grid_.family == HigherOrderFamily::hexahedron_20) return add_serendipity(from);
    // Around the diagonal; by the order of the axes.
    for (const auto& axes : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
      std::array<LatticeIndex, 4> v{from, from, from, from};
      for (std::size_t s = 1; s < 4; ++s) {
        v[s] = v[s - 1];
        v[s][static_cast<std::size_t>(axes[s - 1])] += p_;
      }
      add_tetrahedron(v);
    }
  }

  std::uint32_t node(const LatticeIndex& at) {
    const auto [found, fresh] = numbers_.try_emplace(at, static_cast<std::uint32_t>(block_.points.size()));
    if (fresh) block_.points.push_back(position(at));
    return found->second;
  }

  Vec3 mapped(const LatticeIndex& at) const {
    const double step = 1 / static_cast<double>(grid_.n * p_);
    return grid_.map(
        {static_cast<double>(at[0]) * step, static_cast<double>(at[1]) * step, static_cast<double>(at[2]) * step});
  }

  Vec3 position(const LatticeIndex& at) const {
    if (!grid_.straight) return mapped(at);
    std::array<double, 3> u{};
    LatticeIndex low{};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = at[k] / p_ * p_;
      u[k] = static_cast<double>(at[k] % p_) / static_cast<double>(p_);
    }
    if (grid_.family != HigherOrderFamily::tetrahedron) return trilinear(low, u);
    // Tetrahedra around the diagonal: linear along the largest coordinate, then the next one.
    std::array<std::size_t, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return u[a] > u[b]; });
    Vec3 sum = mapped(low) * (1 - u[order[0]]);
    for (std::size_t s = 0; s < 3; ++s) {
      low[order[s]] += p_;
      const double weight = u[order[s]] - (s < 2 ? u[order[s + 1]] : 0);
      if (weight > 0) sum += mapped(low) * weight;
    }
    return sum;
  }

  Vec3 trilinear(const LatticeIndex& low, const std::array<double, 3>& u) const {
    Vec3 sum;
    for (std::size_t c = 0; c < 8; ++c) {
      double weight = 1;
      LatticeIndex at = low;
      for (std::size_t k = 0; k < 3; ++k) {
        const bool up = (c >> k & 1u) != 0;
        weight *= up ? u[k] : 1 - u[k];
        if (up) at[k] += p_;
      }
      if (weight > 0) sum += mapped(at) * weight;
    }
    return sum;
  }

  void piece(CellShape shape, std::span<const std::uint32_t> corners) {
    block_.cells.add(shape, corners);
    block_.higher.of_piece.push_back(static_cast<std::uint32_t>(block_.higher.size() - 1));
    block_.piece_of.push_back(block_.higher.of_piece.back());
  }
  /// A tetrahedron with positive volume.
  void tetrahedron(std::array<std::uint32_t, 4> c) {
    const auto& x = block_.points;
    if (dot(x[c[1]] - x[c[0]], cross(x[c[2]] - x[c[0]], x[c[3]] - x[c[0]])) < 0) std::swap(c[0], c[1]);
    piece(CellShape::tetrahedron, c);
  }

  void add_hexahedron(const LatticeIndex& from) {
    const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
      return node({from[0] + i, from[1] + j, from[2] + k});
    };
    std::vector<std::uint32_t> nodes;
    for (std::size_t k = 0; k <= p_; ++k)
      for (std::size_t j = 0; j <= p_; ++j)
        for (std::size_t i = 0; i <= p_; ++i) nodes.push_back(at(i, j, k));
    const auto order = static_cast<std::uint8_t>(p_);
    block_.higher.add({HigherOrderFamily::hexahedron, {order, order, order}}, nodes);
    for (std::size_t k = 0; k < p_; ++k)
      for (std::size_t j = 0; j < p_; ++j)
        for (std::size_t i = 0; i < p_; ++i)
          piece(CellShape::hexahedron,
                std::array{at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                           at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
  }

  /// Corners cut off; the rest as pyramids and tetrahedra from one of its nodes.
  void add_serendipity(const LatticeIndex& from) {
    constexpr std::size_t kCorner[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0},
                                           {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
    std::vector<std::uint32_t> nodes;
    for (const auto& c : kCorner) nodes.push_back(node({from[0] + c[0], from[1] + c[1], from[2] + c[2]}));
    const auto edges = cell_edges(CellShape::hexahedron);
    for (const auto& [a, b] : edges) {
      LatticeIndex at = from;
      for (std::size_t k = 0; k < 3; ++k) at[k] += (kCorner[a][k] + kCorner[b][k]) / 2;
      nodes.push_back(node(at));
    }
    block_.higher.add({HigherOrderFamily::hexahedron_20, {2, 2, 2}}, nodes);
    const auto between = [&](std::size_t a, std::size_t b) {
      std::size_t e = 0;
      while (!(edges[e][0] == a && edges[e][1] == b) && !(edges[e][0] == b && edges[e][1] == a)) ++e;
      return nodes[8 + e];
    };
    const std::uint32_t tip = nodes[8];
    for (std::size_t v = 0; v < 8; ++v) {
      std::array<std::uint32_t, 4> c{nodes[v]};
      std::size_t count = 1;
      for (const auto& [a, b] : edges)
        if (a == v || b == v) c[count++] = between(a, b);
      tetrahedron(c);
      c[0] = tip;
      if (c[1] != tip && c[2] != tip && c[3] != tip) tetrahedron(c);
    }
    for (const CellFace& f : cell_faces(CellShape::hexahedron)) {
      std::array<std::uint32_t, 5> c{};
      bool at_tip = false;
      for (std::size_t k = 0; k < 4; ++k) {
        c[3 - k] = between(f.corner[k], f.corner[(k + 1) % 4]);  // inward seen from the tip
        at_tip = at_tip || c[3 - k] == tip;
      }
      c[4] = tip;
      if (!at_tip) piece(CellShape::pyramid, c);
    }
  }

  void add_tetrahedron(const std::array<LatticeIndex, 4>& v) {
    const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
      LatticeIndex x{};
      for (std::size_t m = 0; m < 3; ++m)
        x[m] = (i * v[1][m] + j * v[2][m] + k * v[3][m] + (p_ - i - j - k) * v[0][m]) / p_;
      return node(x);
    };
    std::vector<std::uint32_t> nodes;
    for (std::size_t k = 0; k <= p_; ++k)
      for (std::size_t j = 0; j + k <= p_; ++j)
        for (std::size_t i = 0; i + j + k <= p_; ++i) nodes.push_back(at(i, j, k));
    const auto order = static_cast<std::uint8_t>(p_);
    block_.higher.add({HigherOrderFamily::tetrahedron, {order, order, order}}, nodes);
    for (std::size_t k = 0; k < p_; ++k)
      for (std::size_t j = 0; j + k < p_; ++j)
        for (std::size_t i = 0; i + j + k < p_; ++i) {
          tetrahedron({at(i, j, k), at(i + 1, j, k), at(i, j + 1, k), at(i, j, k + 1)});
          if (i + j + k + 2 > p_) continue;
          const std::uint32_t a = at(i + 1, j, k), f = at(i, j + 1, k + 1);
          const std::array ring{at(i, j + 1, k), at(i + 1, j + 1, k), at(i + 1, j, k + 1), at(i, j, k + 1)};
          for (std::size_t s = 0; s < 4; ++s) tetrahedron({a, f, ring[s], ring[(s + 1) % 4]});
          if (i + j + k + 3 > p_) continue;
          tetrahedron({at(i + 1, j + 1, k), at(i + 1, j, k + 1), f, at(i + 1, j + 1, k + 1)});
        }
  }

  const HigherOrderGrid& grid_;
  std::size_t p_;
  GridBlock block_;
  std::map<LatticeIndex, std::uint32_t> numbers_;
};

inline GridData higher_order_grid(const HigherOrderGrid& grid, const VolumeFunction& f) {
  return one_block(HigherOrderMaker(grid).make(), f);
}

/// The same nodes and pieces as linear cells.
inline GridData without_higher_order(GridData data) {
  data.blocks[0].higher = {};
  return data;
}

}  // namespace sansmesh::test
