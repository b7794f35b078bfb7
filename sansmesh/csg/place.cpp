// Nodes that transform solids, and nodes of external fields.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "sansmesh/csg/face_builder.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/csg/solid_expression.h"
#include "sansmesh/csg/solid_node.h"
#include "sansmesh/data/similarity.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

class PlacedNode final : public SolidNode {
 public:
  PlacedNode(NodePtr child, const Similarity& map)
      : SolidNode(traits_of(*child, map)), child_(std::move(child)), map_(map) {
    keep_extents();
  }
  const NodePtr& child() const { return child_; }
  const Similarity& map() const { return map_; }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    child_->evaluate(map_.back(x), values, gradients, active);
    map_.carry(values, gradients);
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    child_->evaluate_piece(piece, map_.back(x), values, gradients);
    map_.carry(values, gradients);
  }
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around, std::span<ValueRange> ranges) const override {
    child_->survey(map_.back(x), {reach.detail / map_.scale, reach.alone / map_.scale}, values, around, ranges);
    map_.carry(values, {});
    for (Surroundings& s : around) {
      s.alone *= map_.scale;
      s.detail *= map_.scale;
    }
    carry(ranges);
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    child_->ranges(map_.back(x), radius / map_.scale, found);
    carry(found);
  }
  double least(double sign, const Vec3& x, double radius) const override {
    return map_.scale * child_->least(sign, map_.back(x), radius / map_.scale);
  }
  std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const override {
    ExpressionFrame inner = frame;
    inner.map = frame.map * map_;
    return child_->express(builder, inner);
  }
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const override {
    return child_->faces(builder, map * map_);
  }
  double support(const Vec3& n) const override { return placed(n, child_->support(map_.rotate_back(n))); }
  double hollow_support(const Vec3& n) const override { return placed(n, child_->hollow_support(map_.rotate_back(n))); }

 private:
  static Traits traits_of(const SolidNode& child, const Similarity& map) {
    Traits t = above(child);
    t.cost += 1;
    t.thickness *= map.scale;
    t.hollow_thickness *= map.scale;
    t.magnitude = t.magnitude * map.scale + norm(map.translation);
    return t;
  }
  void carry(std::span<ValueRange> ranges) const {
    for (ValueRange& r : ranges) r = {r.least * map_.scale, r.most * map_.scale};
  }
  double placed(const Vec3& n, double support) const { return dot(n, map_.translation) + map_.scale * support; }

  NodePtr child_;
  Similarity map_;
};

/// An external field, of which only values and ranges are known.
class LeafNode final : public SolidNode {
 public:
  /// `solid`: the field is a distance to the content of this box.
  LeafNode(std::shared_ptr<const ScalarField> field, std::shared_ptr<const csg::FieldKnowledge> known,
           const std::optional<Box3>& solid = {})
      : SolidNode(traits_of(*field, solid.has_value())),
        solid_(solid),
        field_(std::move(field)),
        known_(std::move(known)),
        piecewise_(dynamic_cast<const PiecewiseField*>(field_.get())) {
    keep_extents();
  }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    field_->evaluate(x, values, gradients);
    if (active.empty()) return;
    if (piecewise_) return piecewise_->active(x, active);
    std::fill(active.begin(), active.end(), 0u);
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    if (piecewise_) return piecewise_->evaluate_piece(piece, x, values, gradients);
    field_->evaluate(x, values, gradients);
  }
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around, std::span<ValueRange> ranges) const override {
    if (piecewise_) {
      piecewise_->survey(x, reach, values, around);
    } else {
      field_->evaluate(x, values);
      std::fill(around.begin(), around.end(), Surroundings{kUnbounded, 0});
    }
    if (!lipschitz()) field_->ranges(x, reach.alone, ranges);
    if (known_)
      for (std::size_t i = 0; i < x.size(); ++i) around[i].detail = known_->detail(x[i], reach.detail);
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    field_->ranges(x, radius, found);
  }
  double least(double sign, const Vec3& x, double radius) const override {
    return known_ ? known_->least(sign, x, radius) : far_value(sign, x, radius);
  }
  double support(const Vec3& n) const override {
    double sum = solid_ ? 0 : kUnbounded;
    for (std::size_t k = 0; solid_ && k < 3; ++k) sum += n[k] * (n[k] > 0 ? solid_->upper[k] : solid_->lower[k]);
    return sum;
  }
  double hollow_support(const Vec3&) const override { return kUnbounded; }

 private:
  static Traits traits_of(const ScalarField& field, bool distance) {
    const auto* piecewise = dynamic_cast<const PiecewiseField*>(&field);
    return {.pieces = piecewise ? piecewise->pieces() : 1,
            .lipschitz = distance,
            .cost = 50,
            .thickness = piecewise ? piecewise->thickness() : kUnbounded,
            .hollow_thickness = piecewise ? piecewise->thickness() : kUnbounded};
  }
  std::optional<Box3> solid_;
  std::shared_ptr<const ScalarField> field_;
  std::shared_ptr<const csg::FieldKnowledge> known_;
  const PiecewiseField* piecewise_;
};

/// A mesh without a field.
class FaceLeafNode final : public SolidNode {
 public:
  FaceLeafNode(std::shared_ptr<const TriangleMesh> mesh, bool overlaps)
      : SolidNode(Traits{}), mesh_(std::move(mesh)), overlaps_(overlaps) {
    for (const Vec3f& v : mesh_->vertices) box_.extend(mesh_->origin + Vec3(v));
    keep_extents();
  }
  void evaluate(std::span<const Vec3>, std::span<double>, std::span<Vec3>, std::span<std::uint32_t>) const override {
    no_values();
  }
  void evaluate_piece(std::uint32_t, std::span<const Vec3>, std::span<double>, std::span<Vec3>) const override {
    no_values();
  }
  void survey(std::span<const Vec3>, const SurveyReach&, std::span<double>, std::span<Surroundings>,
              std::span<ValueRange>) const override {
    no_values();
  }
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const override {
    return builder.mesh(mesh_, overlaps_, map);
  }
  double support(const Vec3& n) const override {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += n[k] * (n[k] > 0 ? box_.upper[k] : box_.lower[k]);
    return sum;
  }
  double hollow_support(const Vec3&) const override { return kUnbounded; }

 private:
  [[noreturn]] static void no_values() { throw std::logic_error("a face leaf has no values"); }
  std::shared_ptr<const TriangleMesh> mesh_;
  bool overlaps_;
  Box3 box_;
};

Solid placed(const Solid& a, const Similarity& map) {
  if (!(map.scale > 0) || !std::isfinite(map.scale) || !is_finite(map.translation))
    throw ArgumentError("solids cannot be moved or scaled by lengths that are too large or small for numbers");
  // Nested transformations are merged.
  if (const auto* inner = dynamic_cast<const PlacedNode*>(a.node().get())) {
    const Similarity both = map * inner->map();
    return placed(Solid(inner->child()), both);
  }
  return Solid(std::make_shared<PlacedNode>(a.node(), map));
}

/// Quarter turns are exact, so that boxes stay boxes.
double exact(double sine_or_cosine) {
  const double nearest = std::round(sine_or_cosine);
  return std::abs(sine_or_cosine - nearest) < 1e-15 ? nearest : sine_or_cosine;
}

}  // namespace

namespace csg {

Solid leaf(std::shared_ptr<const ScalarField> field, std::shared_ptr<const FieldKnowledge> known) {
  if (!field) throw ArgumentError("leaf: there is no field");
  const Box3 bounds = field->bounds();
  Solid result(std::make_shared<LeafNode>(std::move(field), std::move(known)));
  if (is_finite(bounds.lower) && is_finite(bounds.upper)) {
    if (bounds.empty()) throw ArgumentError("leaf: the field has an empty domain");
    return intersect(result, box(bounds.lower, bounds.upper));
  }
  for (std::size_t k = 0; k < 6; ++k) {  // cut off in bounded directions
    Vec3 n;
    n[k / 2] = k % 2 ? 1 : -1;
    const double end = k % 2 ? bounds.upper[k / 2] : -bounds.lower[k / 2];
    if (std::isfinite(end)) result = intersect(result, half_space(n, end));
  }
  return result;
}

Solid distance_leaf(std::shared_ptr<const ScalarField> field) {
  if (!field) throw ArgumentError("leaf: there is no field");
  const Box3 bounds = field->bounds();
  if (bounds.empty() || !is_finite(bounds.lower) || !is_finite(bounds.upper))
    throw ArgumentError("leaf: a distance needs finite bounds");
  return Solid(std::make_shared<LeafNode>(std::move(field), std::shared_ptr<const FieldKnowledge>(), bounds));
}

Solid face_leaf(std::shared_ptr<const TriangleMesh> mesh, bool overlaps) {
  if (!mesh || mesh->triangles.empty()) throw ArgumentError("leaf: the mesh has no triangles");
  return Solid(std::make_shared<FaceLeafNode>(std::move(mesh), overlaps));
}

Solid translate(const Solid& a, const Vec3& by) {
  require_finite("translate", "vector", by);
  Similarity map;
  map.translation = by;
  return placed(a, map);
}

Solid rotate(const Solid& a, const Vec3& axis, double degrees, const Vec3& center) {
  const Vec3 u = require_direction("rotate", "axis", axis);
  require_finite("rotate", "angle", degrees);
  require_finite("rotate", "center", center);
  const double angle = std::remainder(degrees, 360.0) * (std::numbers::pi / 180);
  const double c = exact(std::cos(angle)), s = exact(std::sin(angle));
  Similarity map;
  for (Vec3& e : map.columns) e = c * e + s * cross(u, e) + (1 - c) * dot(u, e) * u;
  map.translation = center - map.rotate(center);
  return placed(a, map);
}

Solid scale(const Solid& a, double factor, const Vec3& center) {
  require_positive("scale", "factor", factor);
  require_finite("scale", "center", center);
  Similarity map;
  map.scale = factor;
  map.translation = center - factor * center;
  return placed(a, map);
}

Solid mirror(const Solid& a, const Vec3& normal, double offset) {
  const Vec3 n = require_direction("mirror", "normal", normal);
  require_finite("mirror", "offset", offset);
  Similarity map;
  for (Vec3& e : map.columns) e -= 2 * dot(n, e) * n;
  map.translation = 2 * offset * n;
  return placed(a, map);
}

Solid place(const Solid& a, const LocalFrame& placement) {
  require_finite("place", "origin", placement.origin);
  require_positive("place", "unit", placement.unit);
  return placed(a, similarity_of(placement));
}

}  // namespace csg
}  // namespace sansmesh::inline v1
