// Boolean expressions of solids with faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Faces of a solid in double precision.
struct SolidFaces {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from outside
  bool overlaps = false;            ///< whether parts may overlap each other; the solid is their union
};

/// A tree of unions, intersections and complements of numbered sets. Nodes precede their parents; the last is the
/// whole.
struct BooleanExpression {
  enum class Kind : std::uint8_t { leaf, any, all, complement };
  struct Node {
    Kind kind = Kind::leaf;
    std::uint32_t set = 0;                ///< set of a leaf
    std::vector<std::uint32_t> children;  ///< children of the others; a complement has one
  };
  std::vector<Node> nodes;

  std::uint32_t leaf(std::uint32_t set);
  std::uint32_t combine(Kind kind, std::vector<std::uint32_t> children);
};

/// Value of an expression for points that are in few of many sets: its work is that of the sets that contain the point.
class BooleanState {
 public:
  BooleanState(const BooleanExpression& expression, std::size_t sets);

  /// Moves the point into a set, or out of it; it begins outside of all.
  void put(std::uint32_t set, bool inside);
  bool value() const { return value_.empty() ? false : value_.back() != 0; }

 private:
  void set_node(std::uint32_t node, bool value);
  bool value_of(std::uint32_t node) const;

  static constexpr std::uint32_t kNoParent = ~std::uint32_t{0};
  const BooleanExpression& expression_;
  std::vector<std::uint32_t> parent_, true_children_;
  std::vector<std::uint8_t> value_;
  std::vector<std::vector<std::uint32_t>> leaves_;  ///< leaves of each set
};

}  // namespace sansmesh::inline v1
