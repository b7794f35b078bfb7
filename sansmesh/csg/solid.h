// Constructive solid geometry: solids made of analytic primitives and of any fields, combined, moved and blended
// (METHODS §3.4; Ricci 1973; Pasko et al. 1995). Every solid is a field whose creases are known.
#pragma once

#include <memory>
#include <optional>

#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/local_frame.h"

namespace sansmesh::inline v1 {

class SolidNode;

/// A solid: negative inside, positive outside, and next to its surface measured in units of length. An immutable tree,
/// so copies are cheap and share it. Made and combined by the functions below.
///
/// Values are exact signed distances for sphere, half-space, torus, capsule, rounded box and infinite cylinder; for
/// solids with creases they are next to the surface, inside and opposite the faces, and less than the distance in
/// front of creases, where the value continues that of the nearest face.
class Solid final : public PiecewiseField {
 public:
  explicit Solid(std::shared_ptr<const SolidNode> node) : node_(std::move(node)) {}

  /// Box around the solid: ±infinity where it has no end, empty (Box3::empty) if it is known to hold no point. Tight
  /// for primitives however they are turned and for their unions; a little larger for intersections and blends.
  Box3 bounds() const override;

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;

  /// Each smooth part of a primitive's surface is a piece, so is each field of others, and each pair of pieces that a
  /// blend blends. Where a blended piece ends, it continues the other without a crease.
  std::uint32_t pieces() const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  /// 1, unless fields of others are part of it.
  std::optional<double> slope_bound() const override;
  /// Of the thinnest primitive or shell, hole of a torus, or tool that was taken away; offsets counted. What an
  /// offset made vanish is left out, and with it what is as thick and in the same part of the expression.
  double thickness() const override;
  /// Of solids made of primitives; not where fields of others are part of it, or blends of too many pieces.
  std::shared_ptr<const PieceExpression> expression(double tie) const override;
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around) const override;
  /// Put together from those of its fields.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  const std::shared_ptr<const SolidNode>& node() const { return node_; }

 private:
  std::shared_ptr<const SolidNode> node_;
};

/// All of these throw ArgumentError, which names function, argument, value and remedy, if a number is not finite, a
/// radius, size or factor that must be positive is not, or a direction is zero. Directions need not have unit length.
namespace csg {

// ---- Primitives --------------------------------------------------------------------------------------------------

Solid sphere(const Vec3& center, double radius);
/// `rounding`: radius of edges and corners, less than half the shortest edge; the size stays.
Solid box(const Vec3& lower, const Vec3& upper, double rounding = 0);
/// All points x with ⟨x, normal/‖normal‖⟩ ≤ offset.
Solid half_space(const Vec3& normal, double offset);
/// Without ends.
Solid cylinder(const Vec3& center, const Vec3& axis, double radius);
/// `center` is half-way up.
Solid cylinder(const Vec3& center, const Vec3& axis, double radius, double height);
/// A frustum, whose radius changes from `bottom` to `top` in the direction of the axis; one of them may be 0. `center`
/// is half-way up.
Solid cone(const Vec3& center, const Vec3& axis, double bottom, double top, double height);
/// The tube's radius `tube` is less than the ring's.
Solid torus(const Vec3& center, const Vec3& axis, double ring, double tube);
/// All points within `radius` of the segment.
Solid capsule(const Vec3& from, const Vec3& to, double radius);

// ---- Other fields ------------------------------------------------------------------------------------------------

/// What may be known of a field apart from its values. Asked by several threads at once, for each point: it should be
/// quick.
class FieldKnowledge {
 public:
  virtual ~FieldKnowledge() = default;
  /// Edge of blocks that resolve the field within `reach` of x.
  virtual double detail(const Vec3& x, double reach) const = 0;
  /// A bound from below for sign (±1) times the values within `radius` of x, −infinity where there is none: where
  /// another solid decides anyway, the field is not evaluated.
  virtual double least(double sign, const Vec3& x, double radius) const = 0;
};

/// Any field, as a solid that ends at the field's bounds, where those are finite: a field that is still negative there
/// is cut off by a flat face. A PiecewiseField keeps its pieces.
Solid leaf(std::shared_ptr<const ScalarField> field, std::shared_ptr<const FieldKnowledge> known = {});

/// A field that is the signed distance to a solid which its finite bounds() hold, also outside of these: it is not cut
/// off there.
Solid distance_leaf(std::shared_ptr<const ScalarField> field);

// ---- Combinations ------------------------------------------------------------------------------------------------
//
// With `blend` = r > 0 the crease between the two surfaces becomes a smooth transition: with the values a and b of the
// two, min(a, b) becomes (a + b)/2 − (r² + (a − b)²)/(4r) where |a − b| < r and stays min(a, b) elsewhere. The gradient
// is continuous (where those of a and b are), its norm at most the larger of both, the value changes by r/4 at most,
// and the surface changes only within r of both. So unions grow; intersections and differences shrink.

Solid unite(const Solid& a, const Solid& b, double blend = 0);
Solid intersect(const Solid& a, const Solid& b, double blend = 0);
/// a without b.
Solid subtract(const Solid& a, const Solid& b, double blend = 0);
/// All points outside.
Solid complement(const Solid& a);

/// Grows by `distance`, shrinks if it is negative. Creases of primitives stay creases.
Solid offset(const Solid& a, double distance);

enum class ShellSide {
  both,     ///< half the thickness to each side of the surface
  inside,   ///< the surface stays the outer one
  outside,  ///< the surface becomes the inner one
};
/// A wall along the surface.
Solid shell(const Solid& a, double thickness, ShellSide side = ShellSide::both);

// ---- Placements --------------------------------------------------------------------------------------------------

Solid translate(const Solid& a, const Vec3& by);
/// Counter-clockwise seen from the axis' tip.
Solid rotate(const Solid& a, const Vec3& axis, double degrees, const Vec3& center = {});
/// The same in all directions; values stay distances.
Solid scale(const Solid& a, double factor, const Vec3& center = {});
/// Mirrored at the plane ⟨x, normal/‖normal‖⟩ = offset.
Solid mirror(const Solid& a, const Vec3& normal, double offset = 0);
/// A solid in coordinates of its own placed in the world.
Solid place(const Solid& a, const LocalFrame& placement);

}  // namespace csg
}  // namespace sansmesh::inline v1
