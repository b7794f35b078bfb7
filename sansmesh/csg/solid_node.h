// What solids are made of, seen from inside: the nodes of the tree.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

class Solid;
class ExpressionBuilder;
struct ExpressionFrame;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Nodes that are deeper tell by their boxes alone what values are at least: each of the nodes above asks for it, and
/// would look through all that is below.
constexpr int kDeepForLeast = 12;

/// In place of a piece: the value of the node.
constexpr std::uint32_t kWholeNode = ~std::uint32_t{0};

/// A smallest box, as its extents in the directions −x, +x, −y, +y, −z, +z; they may contradict each other (no point).
using Extents = std::array<double, 6>;

/// One solid of a tree. Nodes never change once made.
///
/// Its support S(n) is a bound for ⟨n, x⟩ over the solid, for any unit vector n. Besides bounding the solid it bounds
/// the field: outside, value(x) ≥ rise · (⟨n, x⟩ − S(n)), by which a node that is far away need not be evaluated.
/// The same for the solid's complement, with the value's sign turned.
class SolidNode {
 public:
  virtual ~SolidNode() = default;
  SolidNode(const SolidNode&) = delete;
  SolidNode& operator=(const SolidNode&) = delete;

  /// Values, and gradients and active pieces unless their spans are empty.
  virtual void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                        std::span<std::uint32_t> active) const = 0;
  /// As PiecewiseField::evaluate_piece.
  virtual void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                              std::span<Vec3> gradients) const = 0;

  /// As PiecewiseField::survey. Where gradients are not known to be 1 at most, `ranges` gets what the values within
  /// reach.alone lie between; else it is left as it is.
  virtual void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
                      std::span<Surroundings> around, std::span<ValueRange> ranges) const = 0;
  /// As ScalarField::ranges. To be overridden where gradients are not known to be 1 at most.
  virtual void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const;

  /// A bound from below for sign (±1) times the values within `radius` of x, found without evaluating fields; −infinity
  /// where there is none.
  virtual double least(double sign, const Vec3& x, double radius) const { return far_value(sign, x, radius); }

  /// As minima and maxima of smooth functions (solid_expression.h): the number of its node there, or nothing.
  virtual std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const;
  /// As PieceExpression::bend, of a piece or of all that the node is (kWholeNode), where its value is `level` or more.
  virtual double bend(std::uint32_t piece, const Vec3& x, double radius, double level) const;
  /// As PieceExpression::bends_one_way, of all its pieces.
  virtual bool bends_one_way() const { return false; }

  virtual double support(const Vec3& n) const = 0;
  virtual double hollow_support(const Vec3& n) const = 0;

  std::uint32_t pieces() const { return pieces_; }
  double rise() const { return rise_; }
  /// Gradients are known to be 1 at most.
  bool lipschitz() const { return lipschitz_; }
  /// Rough time of one evaluation; a primitive takes 1.
  double cost() const { return cost_; }
  int depth() const { return depth_; }
  /// Of the thinnest part, as far as primitives and shells tell: what combinations leave of them may be thinner. What
  /// offsets have made vanish is 0 or less, and counts only if there is nothing else.
  double thickness() const { return thickness_; }
  /// Of the thinnest hole: the complement's thickness.
  double hollow_thickness() const { return hollow_thickness_; }
  /// The largest length that its values are computed from, coordinates of points aside: these are rounded as it is.
  double magnitude() const { return magnitude_; }
  /// The same from the extents alone: the least effort.
  double far_value(double sign, const Vec3& x, double radius) const;
  const Extents& extents() const { return extents_; }
  const Extents& hollow_extents() const { return hollow_extents_; }

 protected:
  struct Traits {
    std::uint64_t pieces = 1;
    double rise = 1;
    bool lipschitz = true;
    double cost = 1;
    int depth = 1;  ///< one more than the deepest child's
    double thickness = kUnbounded, hollow_thickness = kUnbounded;
    double magnitude = 0;  ///< as far as extents do not tell
  };
  /// Those of a child's parent that has no other.
  static Traits above(const SolidNode& child);
  /// Throws ArgumentError if the tree has become too deep or has too many pieces.
  explicit SolidNode(const Traits& traits);
  /// To be called by each constructor of a class that is not derived from any more.
  void keep_extents();

 private:
  std::uint32_t pieces_;
  double rise_;
  bool lipschitz_;
  double cost_;
  int depth_;
  double thickness_, hollow_thickness_;
  double magnitude_;
  Extents extents_{}, hollow_extents_{};
};

/// By how much a node's values within `radius` of x may be off through rounding, at most.
double value_rounding(const SolidNode& node, const Vec3& x, double radius);

/// The smaller one of two thicknesses, of those that are positive.
double thinner(double a, double b);

using NodePtr = std::shared_ptr<const SolidNode>;

/// Throws ArgumentError "WHAT: NAME must be … not VALUE".
void require_finite(const char* what, const char* name, double value);
void require_finite(const char* what, const char* name, const Vec3& value);
void require_positive(const char* what, const char* name, double value);
/// The unit vector; a zero one is an error too.
Vec3 require_direction(const char* what, const char* name, const Vec3& value);

}  // namespace sansmesh::inline v1
