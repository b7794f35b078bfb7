#include "sansmesh/io/vtk/higher_order_cells.h"

#include <vtkHigherOrderHexahedron.h>
#include <vtkHigherOrderTetra.h>
#include <vtkHigherOrderWedge.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1::io {
namespace {

/// Nodes of a hexahedron of 27 in three layers of three rows of three.
constexpr std::uint8_t kThreeByThree[27] = {0,  8,  1,  11, 24, 9,  3, 10, 2,  16, 22, 17, 20, 26,
                                            21, 19, 23, 18, 4,  12, 5, 15, 25, 13, 7,  14, 6};

constexpr std::uint32_t kNoApex = 0xffffffffu;

}  // namespace

void CellPieces::piece(CellShape shape, std::initializer_list<std::uint32_t> nodes) {
  cells.add(shape, {nodes.begin(), nodes.size()});
  rows.push_back(row_);
}

bool CellPieces::comes_first(std::uint32_t a, std::uint32_t b) const {
  const Vec3 &x = points_[a], &y = points_[b];
  return x.x != y.x ? x.x < y.x : x.y != y.y ? x.y < y.y : x.z != y.z ? x.z < y.z : a < b;
}

void CellPieces::cone(std::span<const std::vector<std::uint32_t>> faces) {
  const auto before = [this](std::uint32_t a, std::uint32_t b) { return comes_first(a, b); };
  std::uint32_t apex = kNoApex;
  for (const auto& face : faces) {
    for (const std::uint32_t v : face) {
      if (apex == kNoApex || before(v, apex)) apex = v;
    }
  }
  for (const auto& face : faces) {
    if (face.size() < 3 || std::find(face.begin(), face.end(), apex) != face.end()) continue;
    const std::size_t first =
        static_cast<std::size_t>(std::min_element(face.begin(), face.end(), before) - face.begin());
    const auto at = [&](std::size_t k) { return face[(first + k) % face.size()]; };
    for (std::size_t k = 2; k < face.size(); ++k) piece(CellShape::tetrahedron, {at(0), at(k), at(k - 1), apex});
  }
}

void CellPieces::keep(HigherOrderFamily family, std::array<std::size_t, 3> orders, std::vector<std::uint32_t> nodes) {
  HigherOrderKind kind{family};
  bool linear = true;
  for (std::size_t k = 0; k < 3; ++k) {
    kind.orders[k] = static_cast<std::uint8_t>(std::min<std::size_t>(orders[k], 255));
    linear = linear && orders[k] == 1;
  }
  if (linear || node_count(kind) != nodes.size()) return;
  higher.of_piece.resize(cells.size(), HigherOrderCells::kNone);
  higher.add(kind, nodes);
}

template <class At>
void CellPieces::lattice(std::array<std::size_t, 3> n, const At& at) {
  std::vector<std::uint32_t> nodes;
  for (std::size_t k = 0; k <= n[2]; ++k) {
    for (std::size_t j = 0; j <= n[1]; ++j) {
      for (std::size_t i = 0; i <= n[0]; ++i) nodes.push_back(at(i, j, k));
    }
  }
  keep(HigherOrderFamily::hexahedron, n, std::move(nodes));
  for (std::size_t k = 0; k < n[2]; ++k) {
    for (std::size_t j = 0; j < n[1]; ++j) {
      for (std::size_t i = 0; i < n[0]; ++i) {
        piece(CellShape::hexahedron,
              {at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1), at(i + 1, j, k + 1),
               at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
      }
    }
  }
}

/// A cell at each lattice point: a tetrahedron like the whole, the octahedron beyond it, and the tetrahedron after
/// that.
template <class At>
void CellPieces::simplex(std::size_t n, const At& at) {
  std::vector<std::uint32_t> nodes;
  for (std::size_t k = 0; k <= n; ++k) {
    for (std::size_t j = 0; j + k <= n; ++j) {
      for (std::size_t i = 0; i + j + k <= n; ++i) nodes.push_back(at(i, j, k));
    }
  }
  keep(HigherOrderFamily::tetrahedron, {n, n, n}, std::move(nodes));
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t j = 0; j + k < n; ++j) {
      for (std::size_t i = 0; i + j + k < n; ++i) {
        piece(CellShape::tetrahedron, {at(i, j, k), at(i + 1, j, k), at(i, j + 1, k), at(i, j, k + 1)});
        if (i + j + k + 2 <= n) {
          octahedron({at(i + 1, j, k), at(i, j + 1, k), at(i, j, k + 1), at(i + 1, j + 1, k), at(i + 1, j, k + 1),
                      at(i, j + 1, k + 1)});
        }
        if (i + j + k + 3 <= n) {
          piece(CellShape::tetrahedron,
                {at(i + 1, j + 1, k), at(i, j + 1, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1)});
        }
      }
    }
  }
}

void CellPieces::octahedron(const std::array<std::uint32_t, 6>& p) {
  const std::vector<std::uint32_t> faces[] = {{p[0], p[2], p[1]}, {p[3], p[5], p[4]}, {p[0], p[1], p[3]},
                                              {p[0], p[4], p[2]}, {p[1], p[2], p[5]}, {p[0], p[3], p[4]},
                                              {p[1], p[5], p[3]}, {p[2], p[4], p[5]}};
  cone(faces);
}

template <class At>
void CellPieces::prism(std::size_t n, std::size_t layers, const At& at) {
  std::vector<std::uint32_t> nodes;
  for (std::size_t k = 0; k <= layers; ++k) {
    for (std::size_t j = 0; j <= n; ++j) {
      for (std::size_t i = 0; i + j <= n; ++i) nodes.push_back(at(i, j, k));
    }
  }
  keep(HigherOrderFamily::wedge, {n, n, layers}, std::move(nodes));
  for (std::size_t k = 0; k < layers; ++k) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i + j < n; ++i) {
        piece(CellShape::wedge, {at(i, j, k), at(i + 1, j, k), at(i, j + 1, k), at(i, j, k + 1), at(i + 1, j, k + 1),
                                 at(i, j + 1, k + 1)});
        if (i + j + 2 <= n) {
          piece(CellShape::wedge, {at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i + 1, j, k + 1),
                                   at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
        }
      }
    }
  }
}

/// Between two layers of nodes: a wedge at each corner, and a hexahedron between the nodes of the edges.
void CellPieces::add_hexahedron_24(std::span<const std::uint32_t> p) {
  keep(HigherOrderFamily::hexahedron_24, {2, 2, 2}, {p.begin(), p.begin() + 24});
  constexpr std::uint8_t corner[3][4] = {{0, 1, 2, 3}, {16, 17, 18, 19}, {4, 5, 6, 7}};
  constexpr std::uint8_t edge[3][4] = {{8, 9, 10, 11}, {22, 21, 23, 20}, {12, 13, 14, 15}};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto &e = edge[k], &f = edge[k + 1];
    piece(CellShape::hexahedron, {p[e[0]], p[e[1]], p[e[2]], p[e[3]], p[f[0]], p[f[1]], p[f[2]], p[f[3]]});
    for (std::size_t v = 0; v < 4; ++v) {
      const std::size_t before = (v + 3) % 4;
      piece(CellShape::wedge, {p[corner[k][v]], p[e[before]], p[e[v]], p[corner[k + 1][v]], p[f[before]], p[f[v]]});
    }
  }
}

void CellPieces::add_tetrahedron_10(std::span<const std::uint32_t> p) {
  constexpr std::uint8_t order[3][6] = {{0, 4, 1, 6, 5, 2}, {7, 8, 9}, {3}};
  const auto row = [](std::size_t i, std::size_t j, std::size_t k) { return i + (j == 0 ? 0 : j == 1 ? 3 - k : 5); };
  simplex(2, [&](std::size_t i, std::size_t j, std::size_t k) { return p[order[k][row(i, j, k)]]; });
}

void CellPieces::add_hexahedron_27(std::span<const std::uint32_t> p) {
  lattice({2, 2, 2}, [&](std::size_t i, std::size_t j, std::size_t k) { return p[kThreeByThree[i + 3 * j + 9 * k]]; });
}

/// Wedges of 12 or 18 nodes: layers of rows of three, two and one.
void CellPieces::add_wedge(std::span<const std::uint32_t> p) {
  constexpr std::uint8_t layers[3][6] = {{0, 6, 1, 8, 7, 2}, {12, 15, 13, 17, 16, 14}, {3, 9, 4, 11, 10, 5}};
  const bool all = p.size() >= 18;
  prism(2, all ? 2 : 1, [&](std::size_t i, std::size_t j, std::size_t k) {
    return p[layers[all ? k : 2 * k][i + (j == 0 ? 0 : j == 1 ? 3 : 5)]];
  });
}

bool CellPieces::add_lagrange_hexahedron(std::span<const std::uint32_t> p, const std::array<int, 3>& degrees) {
  std::array<std::size_t, 3> n{};
  for (std::size_t k = 0; k < 3; ++k) n[k] = static_cast<std::size_t>(std::max(degrees[k], 0));
  const auto fits = [&] {
    return n[0] > 0 && n[1] > 0 && n[2] > 0 && (n[0] + 1) * (n[1] + 1) * (n[2] + 1) == p.size();
  };
  if (!fits()) n.fill(static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(p.size())))) - 1);
  if (p.empty() || !fits()) return false;
  const int orders[3] = {static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2])};
  lattice(n, [&](std::size_t i, std::size_t j, std::size_t k) {
    return p[static_cast<std::size_t>(vtkHigherOrderHexahedron::PointIndexFromIJK(
        static_cast<int>(i), static_cast<int>(j), static_cast<int>(k), orders))];
  });
  return true;
}

bool CellPieces::add_lagrange_tetrahedron(std::span<const std::uint32_t> p) {
  std::size_t n = 1;
  while ((n + 1) * (n + 2) * (n + 3) / 6 < p.size()) ++n;
  if ((n + 1) * (n + 2) * (n + 3) / 6 != p.size()) return false;
  simplex(n, [&](std::size_t i, std::size_t j, std::size_t k) {
    const vtkIdType at[4] = {static_cast<vtkIdType>(i), static_cast<vtkIdType>(j), static_cast<vtkIdType>(k),
                             static_cast<vtkIdType>(n - i - j - k)};
    return p[static_cast<std::size_t>(vtkHigherOrderTetra::Index(at, static_cast<vtkIdType>(n)))];
  });
  return true;
}

bool CellPieces::add_lagrange_wedge(std::span<const std::uint32_t> p, const std::array<int, 3>& degrees) {
  const auto count = [](std::size_t n, std::size_t layers) { return (n + 1) * (n + 2) / 2 * (layers + 1); };
  std::size_t n = static_cast<std::size_t>(std::max(degrees[0], 0)),
              layers = static_cast<std::size_t>(std::max(degrees[2], 0));
  if (n == 0 || layers == 0 || count(n, layers) != p.size()) {
    for (n = 1; count(n, n) < p.size();) ++n;
    layers = n;
  }
  if (count(n, layers) != p.size()) return false;
  const int orders[4] = {static_cast<int>(n), static_cast<int>(n), static_cast<int>(layers),
                         static_cast<int>(p.size())};
  prism(n, layers, [&](std::size_t i, std::size_t j, std::size_t k) {
    return p[static_cast<std::size_t>(
        vtkHigherOrderWedge::PointIndexFromIJK(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k), orders))];
  });
  return true;
}

}  // namespace sansmesh::inline v1::io
