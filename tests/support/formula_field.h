// Scalar fields given by formulas.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::test {

/// The cube [-half, half]³.
inline Box3 cube_around_origin(double half) { return {{-half, -half, -half}, {half, half, half}}; }

/// A field whose values and gradients are those of a formula.
class FormulaField : public ScalarField {
 public:
  using Value = std::function<double(const Vec3& x)>;
  using ValueAndGradient = std::function<double(const Vec3& x, Vec3& gradient)>;

  explicit FormulaField(ValueAndGradient formula, const Box3& bounds = cube_around_origin(2))
      : formula_(std::move(formula)), bounds_(bounds) {}
  /// Gradients are central differences.
  explicit FormulaField(Value value, const Box3& bounds = cube_around_origin(2))
      : FormulaField(with_differences(std::move(value)), bounds) {}

  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec3 gradient;
      values[i] = formula_(x[i], gradient);
      if (!gradients.empty()) gradients[i] = gradient;
    }
  }

 private:
  static ValueAndGradient with_differences(Value value) {
    return [value = std::move(value)](const Vec3& x, Vec3& gradient) {
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 ahead = x, behind = x;
        ahead[k] += 1e-5, behind[k] -= 1e-5;
        gradient[k] = (value(ahead) - value(behind)) / 2e-5;
      }
      return value(x);
    };
  }

  ValueAndGradient formula_;
  Box3 bounds_;
};

/// Distance to the circle with radius 1 around z, and its gradient.
inline double distance_to_ring(const Vec3& x, Vec3& gradient) {
  const double r = std::hypot(x.x, x.y), out = r - 1, d = std::hypot(out, x.z);
  gradient = Vec3{x.x / r * out, x.y / r * out, x.z} / d;
  return d;
}

}  // namespace sansmesh::test
