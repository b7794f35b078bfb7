// Evaluation of a field: fits a function to oriented points and evaluates distances and normals.
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "sansmesh/functions.h"

using namespace sansmesh;

int main() {
  // Samples of the unit sphere along a spiral, with their normals.
  PointSet sphere;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, radius = std::sqrt(1 - z * z), angle = 2.399963 * i;
    sphere.positions.emplace_back(Vec3{radius * std::cos(angle), radius * std::sin(angle), z});
    sphere.normals.push_back(sphere.positions.back());
  }

  Progress progress;
  const std::shared_ptr<const ScalarField> field = fit_function(sphere, {}, progress).function.field();

  // One call evaluates a batch; gradients are optional. Negative values are inside.
  const std::array<Vec3, 3> x{Vec3{0.99, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1.01}};
  std::array<double, 3> values;
  std::array<Vec3, 3> gradients;
  field->evaluate(x, values, gradients);

  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::printf("F(%5.2f %5.2f %5.2f) = %8.5f, gradient (%5.2f %5.2f %5.2f)\n", x[i].x, x[i].y, x[i].z, values[i],
                gradients[i].x, gradients[i].y, gradients[i].z);
    worst = std::fmax(worst, std::abs(values[i] - (norm(x[i]) - 1)));
  }
  return worst < 1e-3 ? 0 : 1;
}
