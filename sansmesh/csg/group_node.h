// Unions and intersections of many solids in one node.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/csg/solid_node.h"

namespace sansmesh::inline v1 {

/// The smallest (sign 1, a union) or largest (sign −1, an intersection) value of its members, all with slopes of at
/// most 1, without blends. Equivalent to a chain of pairs, with the same numbering of pieces, but each batch of points
/// evaluates only the members that a ball around the batch does not exclude. Of a thousand parts next to each other
/// only a few are relevant at any point.
class GroupNode final : public SolidNode {
 public:
  GroupNode(std::vector<NodePtr> members, double sign);

  const std::vector<NodePtr>& members() const { return members_; }
  double sign() const { return sign_; }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around, std::span<ValueRange> ranges) const override;
  double least(double sign, const Vec3& x, double radius) const override;
  std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const override;
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const override;
  double support(const Vec3& n) const override;
  double hollow_support(const Vec3& n) const override;

 private:
  /// A set of nearby members, and their bounding box.
  struct Cluster {
    Extents extents;
    double rise;
    std::uint32_t first, last;  ///< in order_
  };
  static Traits traits_of(std::span<const NodePtr> members);
  double support_of(const Vec3& n, double sign, bool largest) const;
  const Extents& extents_of(std::uint32_t member) const;
  void build_clusters();
  /// A member, and the group's sign times its value at the centre of a ball, if it was evaluated there.
  struct Near {
    std::uint32_t member;
    bool asked;
    double value;
  };
  /// All members in ascending order, except those whose value exceeds the smallest one by more than `room` in the whole
  /// ball around these points.
  std::vector<Near> candidates(std::span<const Vec3> x, double room) const;
  /// Filters them further for points closer together.
  void narrow(std::vector<Near>& found, std::span<const Vec3> x, double room) const;
  void ask(Near& near, const Vec3& x) const;
  void leave_out_far(std::vector<Near>& found, double radius, double room, double rounding, double smallest,
                     const Vec3& center) const;
  /// Evaluates each member once at one point.
  void evaluate_one(const Vec3& x, double& value, std::span<Vec3> gradient, std::span<std::uint32_t> active) const;

  std::vector<NodePtr> members_;
  double sign_;
  static constexpr std::uint32_t kNoMember = ~std::uint32_t{0};
  /// The most expensive member, if it has many nodes itself. It is not evaluated at the centres of balls, because the
  /// cost of deep trees would be quadratic. The smallest value there is then that of the others, or less.
  std::uint32_t heavy_ = kNoMember;
  std::vector<std::uint32_t> first_piece_;
  std::vector<std::uint32_t> order_;
  std::vector<Cluster> clusters_;
};

/// Union (sign 1) or intersection (−1) of two nodes as a group, whose members include those of groups of the same kind.
/// Both must be lipschitz().
NodePtr group_of(const NodePtr& a, const NodePtr& b, double sign);

}  // namespace sansmesh::inline v1
