// Constructive solid geometry: solids from analytic primitives and arbitrary fields, combined, moved and blended
// (ricci1973, pasko1995). Every solid is a field with known creases.
#pragma once

#include <memory>
#include <optional>

#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

class SolidNode;

/// A solid: negative inside, positive outside, in units of length near its surface. An immutable tree with cheap,
/// shared copies. Created and combined by the functions below.
///
/// Values are exact signed distances for sphere, half-space, torus, capsule, rounded box and infinite cylinder. For
/// solids with creases they are exact next to the surface, inside and opposite the faces, and less than the distance in
/// front of creases, where the value continues that of the nearest face.
class Solid final : public PiecewiseField {
 public:
  explicit Solid(std::shared_ptr<const SolidNode> node) : node_(std::move(node)) {}

  /// Bounding box: ±infinity where it is unbounded, empty (Box3::empty) if the solid is known to be empty. Tight for
  /// rotated primitives and their unions; slightly larger for intersections and blends.
  Box3 bounds() const override;

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;

  /// Each smooth part of a primitive's surface is a piece, each leaf field, and each pair of pieces that a blend joins.
  /// Where a blended piece ends, it continues the other without a crease.
  std::uint32_t pieces() const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  /// 1, unless it contains other fields.
  std::optional<double> slope_bound() const override;
  /// Thickness of the thinnest primitive or shell, hole of a torus, or subtracted tool, including offsets. Parts that
  /// an offset removes are ignored, and with them parts of equal thickness in the same subexpression.
  double thickness() const override;
  /// For solids made of primitives; null if they contain other fields, or blends of too many pieces.
  std::shared_ptr<const PieceExpression> expression(double tie) const override;
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around) const override;
  /// Combined from the ranges of its fields.
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
/// `rounding`: radius of edges and corners, less than half the shortest edge; it does not change the size.
Solid box(const Vec3& lower, const Vec3& upper, double rounding = 0);
/// All points x with ⟨x, normal/‖normal‖⟩ ≤ offset.
Solid half_space(const Vec3& normal, double offset);
/// Infinite cylinder.
Solid cylinder(const Vec3& center, const Vec3& axis, double radius);
/// `center` is at half the height.
Solid cylinder(const Vec3& center, const Vec3& axis, double radius, double height);
/// A frustum, whose radius changes from `bottom` to `top` in the direction of the axis; one of them may be 0. `center`
/// is at half the height.
Solid cone(const Vec3& center, const Vec3& axis, double bottom, double top, double height);
/// The radius `tube` is less than the radius `ring`.
Solid torus(const Vec3& center, const Vec3& axis, double ring, double tube);
/// All points within `radius` of the segment.
Solid capsule(const Vec3& from, const Vec3& to, double radius);

// ---- Other fields ------------------------------------------------------------------------------------------------

/// Additional knowledge about a field. Queried by several threads for each point: it should be fast.
class FieldKnowledge {
 public:
  virtual ~FieldKnowledge() = default;
  /// Edge of blocks that resolve the field within `reach` of x.
  virtual double detail(const Vec3& x, double reach) const = 0;
  /// Lower bound of sign (±1) times the values within `radius` of x, −infinity if unknown. Where another solid
  /// dominates, the field is not evaluated.
  virtual double least(double sign, const Vec3& x, double radius) const = 0;
};

/// Any field as a solid that ends at the field's bounds, if these are finite: a field that is negative there is cut off
/// by a flat face. A PiecewiseField keeps its pieces.
Solid leaf(std::shared_ptr<const ScalarField> field, std::shared_ptr<const FieldKnowledge> known = {});

/// A field that is the signed distance to a solid within its finite bounds(), also outside of them: it is not cut off
/// there.
Solid distance_leaf(std::shared_ptr<const ScalarField> field);

/// A closed mesh as faces alone (face_builder.h): its bounds are known, its values are not. For solids that may never
/// be evaluated; evaluation throws std::logic_error. `overlaps`: its parts may overlap each other.
Solid face_leaf(std::shared_ptr<const TriangleMesh> mesh, bool overlaps = false);

// ---- Combinations ------------------------------------------------------------------------------------------------
//
// With `blend` = r > 0 the crease between the two surfaces becomes a smooth transition: with the values a and b of the
// two, min(a, b) becomes (a + b)/2 − (r² + (a − b)²)/(4r) where |a − b| < r and stays min(a, b) elsewhere. The gradient
// is continuous (if those of a and b are), its norm is at most the larger of both, the value changes by at most r/4,
// and the surface changes only within r of both. Therefore unions grow; intersections and differences shrink.

Solid unite(const Solid& a, const Solid& b, double blend = 0);
Solid intersect(const Solid& a, const Solid& b, double blend = 0);
/// a without b.
Solid subtract(const Solid& a, const Solid& b, double blend = 0);
/// All points outside of a.
Solid complement(const Solid& a);

/// Grows by `distance`, shrinks if it is negative. Creases of primitives are preserved.
Solid offset(const Solid& a, double distance);

enum class ShellSide {
  both,     ///< half the thickness to each side of the surface
  inside,   ///< the surface stays the outer one
  outside,  ///< the surface becomes the inner one
};
/// A wall along the surface.
Solid shell(const Solid& a, double thickness, ShellSide side = ShellSide::both);

// ---- Transformations ---------------------------------------------------------------------------------------------

Solid translate(const Solid& a, const Vec3& by);
/// Counter-clockwise seen from the tip of the axis.
Solid rotate(const Solid& a, const Vec3& axis, double degrees, const Vec3& center = {});
/// Uniform scaling; values stay distances.
Solid scale(const Solid& a, double factor, const Vec3& center = {});
/// Reflection at the plane ⟨x, normal/‖normal‖⟩ = offset.
Solid mirror(const Solid& a, const Vec3& normal, double offset = 0);
/// Transforms a solid from local to world coordinates.
Solid place(const Solid& a, const LocalFrame& placement);

}  // namespace csg
}  // namespace sansmesh::inline v1
