// A field in other coordinates.
#pragma once

#include <vector>

#include "sansmesh/field/scalar_field.h"

namespace sansmesh {

/// A field of its own coordinates seen from the input's: its position x lies at origin + unit · x, its values are
/// lengths and grow with the unit. The field must outlive it.
class PlacedField : public ScalarField {
 public:
  PlacedField(const ScalarField& field, const Vec3& origin, double unit)
      : field_(field), origin_(origin), unit_(unit) {}

  Box3 bounds() const override {
    const Box3 box = field_.bounds();
    return {origin_ + box.lower * unit_, origin_ + box.upper * unit_};
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    field_.evaluate(moved(x), values, gradients);
    for (double& v : values) v *= unit_;
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    field_.evaluate_in_domain(moved(x), values, gradients, inside);
    for (double& v : values) v *= unit_;
  }

 private:
  std::vector<Vec3> moved(std::span<const Vec3> x) const {
    std::vector<Vec3> result(x.begin(), x.end());
    for (Vec3& p : result) p = (p - origin_) * (1 / unit_);
    return result;
  }

  const ScalarField& field_;
  Vec3 origin_;
  double unit_;
};

}  // namespace sansmesh
