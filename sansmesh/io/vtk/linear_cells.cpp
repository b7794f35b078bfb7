#include "sansmesh/io/vtk/linear_cells.h"

#include <vtkCellType.h>
#include <vtkHigherOrderQuadrilateral.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace sansmesh::inline v1::io {
namespace {

constexpr std::uint32_t kNoCorner = 0xffffffffu;

using Ring = std::vector<std::uint8_t>;

/// Faces as rings in outside view, and edges in VTK's order of their nodes.
struct CellFrame {
  std::size_t corners;
  std::vector<Ring> faces;
  std::span<const std::array<std::uint8_t, 2>> edges;

  /// Index of the node on the edge between two corners; edge nodes follow the corners.
  std::size_t node_between(std::uint8_t a, std::uint8_t b) const {
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if ((edges[e][0] == a && edges[e][1] == b) || (edges[e][0] == b && edges[e][1] == a)) return corners + e;
    }
    return 0;
  }
};

const CellFrame& frame_of(CellShape shape) {
  static const CellFrame frames[] = {
      {4, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}}, cell_edges(CellShape::tetrahedron)},
      {5, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}, cell_edges(CellShape::pyramid)},
      {6, {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}, cell_edges(CellShape::wedge)},
      {8,
       {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}},
       cell_edges(CellShape::hexahedron)},
  };
  return frames[static_cast<std::size_t>(shape)];
}

std::string words_of(std::size_t n, const std::string& noun) {
  std::string digits = std::to_string(n);
  for (std::size_t k = digits.size(); k > 3; k -= 3) digits.insert(k - 3, ",");
  if (n == 1) return digits + " " + noun;
  if (noun.ends_with("on")) return digits + " " + noun.substr(0, noun.size() - 2) + "a";  // polyhedron
  if (noun.ends_with("ex")) return digits + " " + noun.substr(0, noun.size() - 2) + "ices";
  return digits + " " + noun + "s";
}

const char* kind_of_corners(int type) {
  switch (type) {
    case VTK_CUBIC_LINE:
    case VTK_LAGRANGE_CURVE:
    case VTK_BEZIER_CURVE:
    case VTK_QUADRATIC_EDGE:
    case VTK_LINE:
    case VTK_POLY_LINE:
      return "line";
    default:
      return "cell of higher order";
  }
}

}  // namespace

void LinearCells::flat(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  flat_cells.push_back({a, b, c, d});
  flat_rows.push_back(row_);
}

void LinearCells::fan(std::span<const std::uint32_t> ring) {
  if (ring.size() == 4) return flat(ring[0], ring[1], ring[2], ring[3]);
  for (std::size_t k = 2; k < ring.size(); ++k) flat(ring[0], ring[k - 1], ring[k], kNoCorner);
}

/// Corners are cut off at the nodes of their edges; the rest is cut into tetrahedra.
bool LinearCells::add_quadratic(CellShape shape, std::span<const std::uint32_t> nodes) {
  const CellFrame& frame = frame_of(shape);
  if (nodes.size() < frame.corners + frame.edges.size()) return false;
  std::vector<std::vector<std::uint32_t>> rest;
  for (const Ring& face : frame.faces) {
    std::vector<std::uint32_t>& inner = rest.emplace_back();
    for (std::size_t k = 0; k < face.size(); ++k)
      inner.push_back(nodes[frame.node_between(face[k], face[(k + 1) % face.size()])]);
  }
  for (std::uint8_t v = 0; v < frame.corners; ++v) {
    // Neighbours around the corner: from each face to the next one that shares an edge there.
    std::vector<std::uint8_t> around;
    for (const Ring& face : frame.faces) {
      const auto at = std::find(face.begin(), face.end(), v);
      if (at == face.end()) continue;
      const std::size_t k = static_cast<std::size_t>(at - face.begin());
      around = {face[(k + face.size() - 1) % face.size()], face[(k + 1) % face.size()]};
      break;
    }
    for (bool grown = true; grown;) {
      grown = false;
      for (const Ring& face : frame.faces) {
        const auto at = std::find(face.begin(), face.end(), v);
        if (at == face.end()) continue;
        const std::size_t k = static_cast<std::size_t>(at - face.begin());
        const std::uint8_t before = face[(k + face.size() - 1) % face.size()], after = face[(k + 1) % face.size()];
        if (before != around.back() || after == around.front()) continue;
        around.push_back(after);
        grown = true;
      }
    }
    std::vector<std::uint32_t> ring;
    for (const std::uint8_t other : around) ring.push_back(nodes[frame.node_between(v, other)]);
    if (ring.size() == 3)
      piece(CellShape::tetrahedron, {nodes[v], ring[0], ring[1], ring[2]});
    else
      piece(CellShape::pyramid, {ring[0], ring[3], ring[2], ring[1], nodes[v]});
    std::reverse(ring.begin(), ring.end());
    rest.push_back(std::move(ring));
  }
  cone(rest);
  return true;
}

bool LinearCells::add_solid(int type, std::span<const std::uint32_t> p) {
  const auto at_least = [&](std::size_t n) { return p.size() >= n; };
  const auto wedge = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d, std::size_t e, std::size_t f) {
    piece(CellShape::wedge, {p[a], p[b], p[c], p[d], p[e], p[f]});
  };
  switch (type) {
    case VTK_TETRA:
      if (at_least(4)) piece(CellShape::tetrahedron, {p[0], p[1], p[2], p[3]});
      return at_least(4);
    case VTK_PYRAMID:
      if (at_least(5)) piece(CellShape::pyramid, {p[0], p[1], p[2], p[3], p[4]});
      return at_least(5);
    case VTK_WEDGE:
      if (at_least(6)) wedge(0, 1, 2, 3, 4, 5);
      return at_least(6);
    case VTK_HEXAHEDRON:
      if (at_least(8)) piece(CellShape::hexahedron, {p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]});
      return at_least(8);
    case VTK_VOXEL:
      if (at_least(8)) piece(CellShape::hexahedron, {p[0], p[1], p[3], p[2], p[4], p[5], p[7], p[6]});
      return at_least(8);
    case VTK_PENTAGONAL_PRISM:
      if (!at_least(10)) return false;
      for (std::size_t k = 2; k < 5; ++k) wedge(0, k, k - 1, 5, 5 + k, 4 + k);
      return true;
    case VTK_HEXAGONAL_PRISM:
      if (!at_least(12)) return false;
      piece(CellShape::hexahedron, {p[0], p[1], p[2], p[3], p[6], p[7], p[8], p[9]});
      piece(CellShape::hexahedron, {p[0], p[3], p[4], p[5], p[6], p[9], p[10], p[11]});
      return true;
    default:
      return add_quadratic_solid(type, p);
  }
}

bool LinearCells::add_quadratic_solid(int type, std::span<const std::uint32_t> p) {
  const auto at_least = [&](std::size_t n) { return p.size() >= n; };
  switch (type) {
    case VTK_QUADRATIC_TETRA:
      if (at_least(10)) add_tetrahedron_10(p);
      return at_least(10);
    case VTK_QUADRATIC_PYRAMID:
    case 37:  // VTK_TRIQUADRATIC_PYRAMID, which older versions lack
      if (type != 37 && at_least(13)) keep(HigherOrderFamily::pyramid_13, {2, 2, 2}, {p.begin(), p.begin() + 13});
      return add_quadratic(CellShape::pyramid, p);
    case VTK_QUADRATIC_WEDGE:
      if (at_least(15)) keep(HigherOrderFamily::wedge_15, {2, 2, 2}, {p.begin(), p.begin() + 15});
      return add_quadratic(CellShape::wedge, p);
    case VTK_QUADRATIC_HEXAHEDRON:
      if (at_least(20)) keep(HigherOrderFamily::hexahedron_20, {2, 2, 2}, {p.begin(), p.begin() + 20});
      return add_quadratic(CellShape::hexahedron, p);
    case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
      if (at_least(24)) add_hexahedron_24(p);
      return at_least(24);
    case VTK_TRIQUADRATIC_HEXAHEDRON:
      if (at_least(27)) add_hexahedron_27(p);
      return at_least(27);
    case VTK_QUADRATIC_LINEAR_WEDGE:
      if (at_least(12)) add_wedge(p.first(12));
      return at_least(12);
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
      if (at_least(18)) add_wedge(p);
      return at_least(18);
    default:
      return add_higher_order(type, p);
  }
}

/// Only the corners of other cells of higher order are used.
bool LinearCells::add_higher_order(int type, std::span<const std::uint32_t> p) {
  switch (type) {
    case VTK_LAGRANGE_HEXAHEDRON:
      return add_lagrange_hexahedron(p, degrees_) || add_solid(VTK_HEXAHEDRON, p);
    case VTK_LAGRANGE_TETRAHEDRON:
      return add_lagrange_tetrahedron(p) || add_solid(VTK_TETRA, p);
    case VTK_LAGRANGE_WEDGE:
      return add_lagrange_wedge(p, degrees_) || add_solid(VTK_WEDGE, p);
    case VTK_BEZIER_HEXAHEDRON:
    case VTK_HIGHER_ORDER_HEXAHEDRON:
      return add_solid(VTK_HEXAHEDRON, p);
    case VTK_BEZIER_TETRAHEDRON:
    case VTK_HIGHER_ORDER_TETRAHEDRON:
      return add_solid(VTK_TETRA, p);
    case VTK_BEZIER_WEDGE:
    case VTK_HIGHER_ORDER_WEDGE:
      return add_solid(VTK_WEDGE, p);
    case VTK_LAGRANGE_PYRAMID:
    case VTK_BEZIER_PYRAMID:
    case VTK_HIGHER_ORDER_PYRAMID:
      return add_solid(VTK_PYRAMID, p);
    default:
      return false;
  }
}

bool LinearCells::add_flat(int type, std::span<const std::uint32_t> p) {
  const auto at_least = [&](std::size_t n) { return p.size() >= n; };
  const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) { flat(p[a], p[b], p[c], kNoCorner); };
  const auto quad = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) { flat(p[a], p[b], p[c], p[d]); };
  switch (type) {
    case VTK_TRIANGLE:
    case VTK_BEZIER_TRIANGLE:
    case VTK_HIGHER_ORDER_TRIANGLE:
      if (at_least(3)) triangle(0, 1, 2);
      return at_least(3);
    case VTK_TRIANGLE_STRIP:
      for (std::size_t k = 2; k < p.size(); ++k) k % 2 == 0 ? triangle(k - 2, k - 1, k) : triangle(k - 1, k - 2, k);
      return at_least(3);
    case VTK_POLYGON:
      fan(p);
      return at_least(3);
    case VTK_PIXEL:
      if (at_least(4)) quad(0, 1, 3, 2);
      return at_least(4);
    case VTK_QUAD:
    case VTK_BEZIER_QUADRILATERAL:
    case VTK_HIGHER_ORDER_QUAD:
      if (at_least(4)) quad(0, 1, 2, 3);
      return at_least(4);
    case VTK_LAGRANGE_TRIANGLE:
      if (p.size() != 6) return add_flat(VTK_TRIANGLE, p);
      [[fallthrough]];
    case VTK_QUADRATIC_TRIANGLE:
      if (!at_least(6)) return false;
      triangle(0, 3, 5), triangle(3, 1, 4), triangle(5, 4, 2), triangle(3, 4, 5);
      return true;
    case VTK_BIQUADRATIC_TRIANGLE: {
      if (!at_least(7)) return false;
      constexpr std::size_t ring[6] = {0, 3, 1, 4, 2, 5};
      for (std::size_t k = 0; k < 6; ++k) triangle(ring[k], ring[(k + 1) % 6], 6);
      return true;
    }
    case VTK_QUADRATIC_QUAD:
      if (!at_least(8)) return false;
      triangle(0, 4, 7), triangle(4, 1, 5), triangle(5, 2, 6), triangle(6, 3, 7), quad(4, 5, 6, 7);
      return true;
    case VTK_BIQUADRATIC_QUAD:
      if (!at_least(9)) return false;
      quad(0, 4, 8, 7), quad(4, 1, 5, 8), quad(8, 5, 2, 6), quad(7, 8, 6, 3);
      return true;
    case VTK_QUADRATIC_LINEAR_QUAD:
      if (!at_least(6)) return false;
      quad(0, 4, 5, 3), quad(4, 1, 2, 5);
      return true;
    case VTK_QUADRATIC_POLYGON: {
      std::vector<std::uint32_t> ring;  // corners, then edge nodes in the second half
      for (std::size_t k = 0; k < p.size() / 2; ++k) ring.insert(ring.end(), {p[k], p[p.size() / 2 + k]});
      fan(ring);
      return at_least(6);
    }
    case VTK_LAGRANGE_QUADRILATERAL: {
      const int n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(p.size())))) - 1;
      if (n < 1 || static_cast<std::size_t>((n + 1) * (n + 1)) != p.size()) return add_flat(VTK_QUAD, p);
      const int orders[2] = {n, n};
      const auto at = [&](int i, int j) {
        return static_cast<std::size_t>(vtkHigherOrderQuadrilateral::PointIndexFromIJK(i, j, orders));
      };
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
      return true;
    }
    default:
      return false;
  }
}

bool LinearCells::add(int type, std::span<const std::uint32_t> nodes, std::uint32_t row, std::array<int, 3> degrees) {
  row_ = row, degrees_ = degrees;
  const std::size_t shaped = higher.size();
  if (type == VTK_EMPTY_CELL) return true;
  if (type == VTK_VERTEX || type == VTK_POLY_VERTEX) return ++vertices, true;
  if (std::string_view(kind_of_corners(type)) == "line") return ++lines, true;
  const std::size_t solids = cells.size(), flats = flat_cells.size();
  if (!add_solid(type, nodes) && !add_flat(type, nodes)) {
    const bool known =
        (type > 0 && type <= VTK_CONVEX_POINT_SET) || (type >= VTK_HIGHER_ORDER_EDGE && type <= VTK_BEZIER_PYRAMID);
    if (!known) leave_out("cell of an unknown type");
    return !known;
  }
  if (higher.size() > shaped) higher.of_piece.resize(cells.size(), static_cast<std::uint32_t>(shaped));
  const std::size_t made = cells.size() - solids + flat_cells.size() - flats;
  if (type == VTK_TETRA || type == VTK_PYRAMID || type == VTK_WEDGE || type == VTK_HEXAHEDRON || type == VTK_VOXEL ||
      type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_PIXEL)
    return true;
  const bool late = type >= VTK_HIGHER_ORDER_EDGE;
  if (late && made == 1 && nodes.size() > 8) {
    ++corners_only_["cell of higher order"];
  } else if (made > 1) {
    const bool own = higher.size() > shaped;
    auto& [before, after] =
        (own ? shaped_ : cut_)[late                                                          ? "cell of higher order"
                               : type >= VTK_QUADRATIC_EDGE && type <= 37                    ? "quadratic cell"
                               : type == VTK_PENTAGONAL_PRISM || type == VTK_HEXAGONAL_PRISM ? "prism"
                                                                                             : "polygon or strip"];
    ++before, after += made;
  }
  return true;
}

void LinearCells::add_polyhedron(std::span<const std::vector<std::uint32_t>> faces, std::uint32_t row) {
  row_ = row;
  const std::size_t before = cells.size();
  cone(faces);
  auto& counts = cut_["polyhedron"];
  ++counts[0], counts[1] += cells.size() - before;
}

void LinearCells::add_tetrahedra(std::span<const std::uint32_t> nodes, std::uint32_t row) {
  row_ = row;
  for (std::size_t k = 0; k + 4 <= nodes.size(); k += 4)
    piece(CellShape::tetrahedron, {nodes[k], nodes[k + 1], nodes[k + 2], nodes[k + 3]});
  auto& counts = cut_["convex point set"];
  ++counts[0], counts[1] += nodes.size() / 4;
}

std::vector<std::string> LinearCells::notes() const {
  std::vector<std::string> notes;
  for (const auto& [kind, counts] : cut_)
    notes.push_back(words_of(counts[0], kind) + (counts[0] == 1 ? " was" : " were") + " cut into " +
                    words_of(counts[1], "linear cell"));
  for (const auto& [kind, counts] : shaped_)
    notes.push_back(words_of(counts[0], kind) + (counts[0] == 1 ? " was" : " were") + " cut into " +
                    words_of(counts[1], "piece") + " that follow " + (counts[0] == 1 ? "its" : "their") +
                    " shape functions");
  for (const auto& [kind, count] : corners_only_)
    notes.push_back("of " + words_of(count, kind) + " only the corners are used");
  const auto left = [&](std::size_t n, const std::string& noun) {
    if (n > 0) notes.push_back(words_of(n, noun) + (n == 1 ? " was" : " were") + " left out");
  };
  for (const auto& [kind, count] : left_out_) left(count, kind);
  left(lines, "line");
  left(vertices, "vertex");
  if (!cells.empty()) left(flat_cells.size(), "flat cell");
  return notes;
}

}  // namespace sansmesh::inline v1::io
