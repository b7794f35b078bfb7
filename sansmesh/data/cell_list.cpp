#include "sansmesh/cell_list.h"

namespace sansmesh::inline v1 {
namespace {

using Edge = std::array<std::uint8_t, 2>;

constexpr Edge kTetrahedronEdges[] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
constexpr Edge kPyramidEdges[] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
constexpr Edge kWedgeEdges[] = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
constexpr Edge kHexahedronEdges[] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                     {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

constexpr CellFace kTetrahedronFaces[] = {{3, {0, 2, 1}}, {3, {0, 1, 3}}, {3, {1, 2, 3}}, {3, {2, 0, 3}}};
constexpr CellFace kPyramidFaces[] = {
    {4, {0, 3, 2, 1}}, {3, {0, 1, 4}}, {3, {1, 2, 4}}, {3, {2, 3, 4}}, {3, {3, 0, 4}}};
// The first triangle of VTK's wedge is counter-clockwise seen from outside.
constexpr CellFace kWedgeFaces[] = {
    {3, {0, 1, 2}}, {3, {3, 5, 4}}, {4, {0, 3, 4, 1}}, {4, {1, 4, 5, 2}}, {4, {2, 5, 3, 0}}};
constexpr CellFace kHexahedronFaces[] = {{4, {0, 3, 2, 1}}, {4, {4, 5, 6, 7}}, {4, {0, 1, 5, 4}},
                                         {4, {1, 2, 6, 5}}, {4, {2, 3, 7, 6}}, {4, {3, 0, 4, 7}}};

}  // namespace

std::span<const std::array<std::uint8_t, 2>> cell_edges(CellShape shape) {
  switch (shape) {
    case CellShape::tetrahedron:
      return kTetrahedronEdges;
    case CellShape::pyramid:
      return kPyramidEdges;
    case CellShape::wedge:
      return kWedgeEdges;
    case CellShape::hexahedron:
      break;
  }
  return kHexahedronEdges;
}

std::span<const CellFace> cell_faces(CellShape shape) {
  switch (shape) {
    case CellShape::tetrahedron:
      return kTetrahedronFaces;
    case CellShape::pyramid:
      return kPyramidFaces;
    case CellShape::wedge:
      return kWedgeFaces;
    case CellShape::hexahedron:
      break;
  }
  return kHexahedronFaces;
}

std::size_t node_count(const HigherOrderKind& kind) {
  std::array<std::size_t, 3> n{};
  for (std::size_t k = 0; k < 3; ++k) {
    n[k] = kind.orders[k];
    if (n[k] < 1 || n[k] > HigherOrderKind::kMostOrder) return 0;
  }
  switch (kind.family) {
    case HigherOrderFamily::tetrahedron:
      return (n[0] + 1) * (n[0] + 2) * (n[0] + 3) / 6;
    case HigherOrderFamily::wedge:
      return (n[0] + 1) * (n[0] + 2) / 2 * (n[2] + 1);
    case HigherOrderFamily::hexahedron:
      return (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
    case HigherOrderFamily::hexahedron_20:
      return 20;
    case HigherOrderFamily::hexahedron_24:
      return 24;
    case HigherOrderFamily::wedge_15:
      return 15;
    case HigherOrderFamily::pyramid_13:
      return 13;
  }
  return 0;
}

}  // namespace sansmesh::inline v1
