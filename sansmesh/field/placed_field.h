// A field in other coordinates.
#pragma once

#include <memory>
#include <utility>

#include "sansmesh/field/similarity.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// A field of its own coordinates seen from the input's: its values are lengths and grow with the unit.
class PlacedField : public ScalarField {
 public:
  /// The field must outlive it.
  PlacedField(const ScalarField& field, const LocalFrame& frame) : PlacedField(nullptr, field, frame) {}
  /// Keeps `owner`, which the field is part of.
  PlacedField(std::shared_ptr<const void> owner, const ScalarField& field, const LocalFrame& frame)
      : owner_(std::move(owner)), field_(field), frame_(similarity_of(frame)) {}

  Box3 bounds() const override {
    const Box3 box = field_.bounds();
    return {frame_.apply(box.lower), frame_.apply(box.upper)};
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    field_.evaluate(frame_.back(x), values, gradients);
    frame_.carry(values, gradients);
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    field_.evaluate_in_domain(frame_.back(x), values, gradients, inside);
    frame_.carry(values, gradients);
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    field_.ranges(frame_.back(x), radius / frame_.scale, found);
    for (ValueRange& r : found) r = {r.least * frame_.scale, r.most * frame_.scale};
  }

 private:
  std::shared_ptr<const void> owner_;  ///< null: somebody else keeps the field
  const ScalarField& field_;
  Similarity frame_;
};

}  // namespace sansmesh::inline v1
