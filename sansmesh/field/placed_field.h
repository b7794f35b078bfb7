// Field in other coordinates.
#pragma once

#include <memory>
#include <utility>

#include "sansmesh/data/similarity.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// Field given in local coordinates, evaluated in input coordinates: values are lengths and scale with the unit.
class PlacedField : public ScalarField {
 public:
  /// The field must outlive this object.
  PlacedField(const ScalarField& field, const LocalFrame& frame) : PlacedField(nullptr, field, frame) {}
  /// Keeps `owner`, which owns the field.
  PlacedField(std::shared_ptr<const void> owner, const ScalarField& field, const LocalFrame& frame)
      : owner_(std::move(owner)), field_(field), frame_(similarity_of(frame)) {}

  Box3 bounds() const override {
    const Box3 box = field_.bounds();
    return {frame_(box.lower), frame_(box.upper)};
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
  std::shared_ptr<const void> owner_;  ///< null if the field is owned elsewhere
  const ScalarField& field_;
  Similarity frame_;
};

}  // namespace sansmesh::inline v1
