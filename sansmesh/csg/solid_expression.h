// Solids as minima and maxima of smooth functions.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/csg/solid_node.h"
#include "sansmesh/data/similarity.h"
#include "sansmesh/field/piece_expression.h"

namespace sansmesh::inline v1 {

/// How the values of a node enter the whole: sign · (those of the node moved by `map`) + shift + tie.
struct ExpressionFrame {
  Similarity map;
  double sign = 1;
  double shift = 0;
  double tie = 0;  ///< by what surfaces that coincide are told apart
};

/// What nodes are put into one after the other: the functions, and the nodes over them.
class ExpressionBuilder {
 public:
  using Node = PieceExpression::Node;
  /// A smooth function: a piece of a node in a frame, or the blend of two functions.
  struct Function {
    const SolidNode* node = nullptr;  ///< none: a blend
    std::uint32_t piece = 0;
    ExpressionFrame frame;
    std::uint32_t a = 0, b = 0;  ///< of a blend: functions that stand before it
    double radius = 0;
    double sign = 1;  ///< of a blend: 1 of a union, −1 of an intersection
  };

  /// Planes that are the same to well below the tie all over `box` become one function; if that ends somewhere.
  ExpressionBuilder(double tie, const Box3& box);

  std::uint32_t piece(const SolidNode& node, std::uint32_t number, const ExpressionFrame& frame);
  std::uint32_t combine(Node::Kind kind, std::uint32_t a, std::uint32_t b);
  /// The largest of the first `count` pieces of a node; of 0, the node as one function.
  std::uint32_t pieces(const SolidNode& node, std::uint32_t count, const ExpressionFrame& frame);
  /// Two children of a union (sign 1) or intersection (−1), blended within `radius`.
  std::optional<std::uint32_t> combine(const SolidNode& a, const SolidNode& b, double sign, double radius,
                                       const ExpressionFrame& frame);

  /// Any number of them, without blends.
  std::optional<std::uint32_t> combine(const std::vector<NodePtr>& members, double sign, const ExpressionFrame& frame);

  /// Of shells within shells, which are twice as many nodes each time but hardly more functions, parts that are equal
  /// become one: nodes are a tree no longer then. Others stay as they are, triangles come in their order.
  void merge_equal_parts();
  /// Counts how deep shells are within each other, as long as it is there.
  class WithinShell {
   public:
    explicit WithinShell(ExpressionBuilder& builder) : builder_(builder) {
      builder_.most_shells_ = std::max(builder_.most_shells_, ++builder_.shells_);
    }
    ~WithinShell() { --builder_.shells_; }
    WithinShell(const WithinShell&) = delete;
    WithinShell& operator=(const WithinShell&) = delete;

   private:
    ExpressionBuilder& builder_;
  };

  /// More functions, or nodes, than can be looked at one by one.
  bool full() const;

  std::vector<Function> functions;
  std::vector<Node> nodes;

 private:
  /// A plane, by its value in the middle of the box and its gradient.
  struct Plane {
    double value;
    Vec3 gradient;
    std::uint32_t function;
  };
  std::uint32_t add(const Node& node);
  /// Whether a function is a plane all over the box, and which.
  std::optional<Plane> plane_of(const Function& function) const;
  /// That of the parts of a union (side 1) or intersection (−1).
  ExpressionFrame frame_of_parts(const ExpressionFrame& frame, double side) const;
  double tie_;
  int shells_ = 0, most_shells_ = 0;
  std::map<std::array<std::uint32_t, 2>, std::vector<std::uint32_t>> blends_;  ///< by the functions that they blend
  Vec3 middle_;
  double radius_ = 0;  ///< of the box; 0: it has no end
  std::multimap<double, Plane> planes_;
};

/// Nothing where a part of the tree is no such thing.
std::shared_ptr<const PieceExpression> expression_of(std::shared_ptr<const SolidNode> root, double tie);

}  // namespace sansmesh::inline v1
