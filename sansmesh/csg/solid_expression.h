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

/// Transformation of a node's values in the whole: sign · (values of the node moved by `map`) + shift + tie.
struct ExpressionFrame {
  Similarity map;
  double sign = 1;
  double shift = 0;
  double tie = 0;  ///< offset that separates coincident surfaces
};

/// Collects the functions and nodes of an expression, to which nodes of solids are added in turn.
class ExpressionBuilder {
 public:
  using Node = PieceExpression::Node;
  /// A smooth function: a piece of a node in a frame, or the blend of two functions.
  struct Function {
    const SolidNode* node = nullptr;  ///< null: a blend
    std::uint32_t piece = 0;
    ExpressionFrame frame;
    std::uint32_t a = 0, b = 0;  ///< blends only: previous functions
    double radius = 0;
    double sign = 1;  ///< blends only: 1 for a union, −1 for an intersection
  };

  /// Planes that agree far below the tie all over `box` are merged into one function, if the box is bounded.
  ExpressionBuilder(double tie, const Box3& box);

  std::uint32_t piece(const SolidNode& node, std::uint32_t number, const ExpressionFrame& frame);
  std::uint32_t combine(Node::Kind kind, std::uint32_t a, std::uint32_t b);
  /// The largest of the first `count` pieces of a node; for 0, the node as one function.
  std::uint32_t pieces(const SolidNode& node, std::uint32_t count, const ExpressionFrame& frame);
  /// Two children of a union (sign 1) or intersection (−1), blended within `radius`.
  std::optional<std::uint32_t> combine(const SolidNode& a, const SolidNode& b, double sign, double radius,
                                       const ExpressionFrame& frame);

  /// Any number of members, without blends.
  std::optional<std::uint32_t> combine(const std::vector<NodePtr>& members, double sign, const ExpressionFrame& frame);

  /// Merges equal parts of nested shells, which double the number of nodes at each level but hardly that of functions.
  /// The nodes then form a graph instead of a tree. Other expressions are unchanged, because the order of triangles
  /// depends on them.
  void merge_equal_parts();
  /// Counts the nesting depth of shells during its lifetime.
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

  /// Whether there are too many functions or nodes.
  bool full() const;

  std::vector<Function> functions;
  std::vector<Node> nodes;

 private:
  /// A plane, by its value at the centre of the box and its gradient.
  struct Plane {
    double value;
    Vec3 gradient;
    std::uint32_t function;
  };
  std::uint32_t add(const Node& node);
  /// The plane that a function equals all over the box, if any.
  std::optional<Plane> plane_of(const Function& function) const;
  /// Frame of the parts of a union (side 1) or intersection (−1).
  ExpressionFrame frame_of_parts(const ExpressionFrame& frame, double side) const;
  double tie_;
  int shells_ = 0, most_shells_ = 0;
  std::map<std::array<std::uint32_t, 2>, std::vector<std::uint32_t>> blends_;  ///< keyed by the blended functions
  Vec3 middle_;
  double radius_ = 0;  ///< radius of the box; 0: unbounded
  std::multimap<double, Plane> planes_;
};

/// Null if a part of the tree has no such form.
std::shared_ptr<const PieceExpression> expression_of(std::shared_ptr<const SolidNode> root, double tie);

}  // namespace sansmesh::inline v1
