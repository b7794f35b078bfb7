// Nodes of the tree of a solid.
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
class FaceBuilder;
struct Similarity;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Deeper nodes use only their boxes as bounds: each of their ancestors queries a bound, and would otherwise traverse
/// the whole subtree.
constexpr int kDeepForLeast = 12;

/// Limit of a survey with reach r, in units of r. The division of blocks of half edge r needs up to half the diagonal
/// plus two cells, at most 3.8 r.
constexpr double kSurveyed = 6;
/// Lipschitz constant of the difference of two values whose slopes are at most 1, and hence of their weights in a
/// blend.
constexpr double kDifferenceSlope = 2;

/// Piece number that denotes the whole node.
constexpr std::uint32_t kWholeNode = ~std::uint32_t{0};

/// A bounding box as its extents in the directions −x, +x, −y, +y, −z, +z; contradicting extents denote an empty set.
using Extents = std::array<double, 6>;
/// Distance of x from a box in one direction; negative inside.
double outside_of(const Extents& e, const Vec3& x);
/// Lower bound of the values within `radius` of a point this far outside of a node's box.
double least_value(double outside, double rise, double radius);

/// One immutable node of a tree of solids.
///
/// Its support S(n) is a bound for ⟨n, x⟩ over the solid, for any unit vector n. It also bounds the field: outside,
/// value(x) ≥ rise · (⟨n, x⟩ − S(n)), so that a distant node need not be evaluated. The hollow support is that of the
/// solid's complement, with the sign of the value reversed.
class SolidNode {
 public:
  virtual ~SolidNode() = default;
  SolidNode(const SolidNode&) = delete;
  SolidNode& operator=(const SolidNode&) = delete;

  /// Values, and gradients and active pieces unless their spans are empty.
  virtual void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                        std::span<std::uint32_t> active) const = 0;
  /// See PiecewiseField::evaluate_piece.
  virtual void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                              std::span<Vec3> gradients) const = 0;

  /// See PiecewiseField::survey. Unless gradients are known to be at most 1, `ranges` receives bounds of the values
  /// within reach.alone; otherwise it is unchanged.
  virtual void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
                      std::span<Surroundings> around, std::span<ValueRange> ranges) const = 0;
  /// See ScalarField::ranges. Must be overridden unless gradients are known to be at most 1.
  virtual void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const;

  /// Lower bound of sign (±1) times the values within `radius` of x, found without evaluating fields; −infinity if
  /// unknown.
  virtual double least(double sign, const Vec3& x, double radius) const { return far_value(sign, x, radius); }

  /// As minima and maxima of smooth functions (solid_expression.h): the index of its node there, or nothing.
  virtual std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const;
  /// As a Boolean expression of solids with faces (face_builder.h), moved by `map`: the index of its node there, or
  /// nothing if a part has no faces.
  virtual std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const;
  /// See PieceExpression::curvature_bound, for a piece or for the whole node (kWholeNode), where its value is at least
  /// `level`.
  virtual double curvature_bound(std::uint32_t piece, const Vec3& x, double radius, double level) const;
  /// See PieceExpression::singly_curved, for all its pieces.
  virtual bool singly_curved() const { return false; }

  virtual double support(const Vec3& n) const = 0;
  virtual double hollow_support(const Vec3& n) const = 0;

  std::uint32_t pieces() const { return pieces_; }
  double rise() const { return rise_; }
  /// Whether gradients are known to be at most 1.
  bool lipschitz() const { return lipschitz_; }
  /// Approximate time of one evaluation; a primitive takes 1.
  double cost() const { return cost_; }
  int depth() const { return depth_; }
  /// Thickness of the thinnest part, derived from primitives and shells; combinations may leave thinner parts. Parts
  /// that offsets remove have a thickness of at most 0, which counts only if there are no others.
  double thickness() const { return thickness_; }
  /// Thickness of the thinnest hole, that is, of the complement.
  double hollow_thickness() const { return hollow_thickness_; }
  /// The largest length in the computation of its values, besides coordinates of points; it determines the rounding
  /// error.
  double magnitude() const { return magnitude_; }
  /// The bound from the extents alone, the cheapest one.
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
    double magnitude = 0;  ///< beyond the magnitude of the extents

    /// Adds another child.
    void join(const SolidNode& child);
  };
  /// Traits of a parent whose only child this is.
  static Traits above(const SolidNode& child);
  /// Throws ArgumentError if the tree is too deep or has too many pieces.
  explicit SolidNode(const Traits& traits);
  /// Must be called by the constructor of each most derived class.
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

/// Upper bound of the rounding error of a node's values within `radius` of x.
double value_rounding(const SolidNode& node, const Vec3& x, double radius);

/// The smaller positive one of two thicknesses.
double thinner(double a, double b);

using NodePtr = std::shared_ptr<const SolidNode>;

/// Throws ArgumentError "WHAT: NAME must be … not VALUE".
void require_finite(const char* what, const char* name, double value);
void require_finite(const char* what, const char* name, const Vec3& value);
void require_positive(const char* what, const char* name, double value);
/// The unit vector; throws also for a zero vector.
Vec3 require_direction(const char* what, const char* name, const Vec3& value);

}  // namespace sansmesh::inline v1
