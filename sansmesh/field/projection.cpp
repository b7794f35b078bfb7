#include "sansmesh/field/projection.h"

#include <vector>

namespace sansmesh::inline v1 {

void project_to_fixed_point(const Projection& projection, std::span<const Vec3> x, double tolerance, int steps,
                            std::span<FootPoint> feet) {
  std::vector<Vec3> from(x.begin(), x.end()), moving;
  std::vector<std::uint32_t> open(x.size()), next;
  for (std::size_t i = 0; i < x.size(); ++i) open[i] = static_cast<std::uint32_t>(i);
  std::vector<FootPoint> found;
  for (int step = 0; step < steps && !open.empty(); ++step) {
    moving.clear();
    for (const std::uint32_t i : open) moving.push_back(from[i]);
    found.resize(moving.size());
    projection.project(moving, found);
    next.clear();
    for (std::size_t k = 0; k < open.size(); ++k) {
      const std::uint32_t i = open[k];
      feet[i] = found[k];
      if (!found[k].defined) {
        feet[i].position = x[i];
        continue;
      }
      if (squared_norm(found[k].position - from[i]) > tolerance * tolerance) next.push_back(i);
      from[i] = found[k].position;
    }
    open.swap(next);
  }
}

void ProjectionField::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  evaluate_in_domain(x, values, gradients, {});
}

void ProjectionField::evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                         std::span<std::uint8_t> inside) const {
  std::vector<FootPoint> feet(x.size());
  projection_.project(x, feet);
  const double far = bounds().diagonal();
  std::vector<std::uint8_t> own;
  if (inside.empty() && beyond_ != nullptr) {
    own.resize(x.size());
    inside = own;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const FootPoint& f = feet[i];
    values[i] = f.defined ? dot(x[i] - f.position, f.normal) : far;
    if (!gradients.empty()) gradients[i] = f.normal;
    if (!inside.empty()) inside[i] = f.defined;
  }
  if (beyond_ != nullptr) detail::fill_undefined(*beyond_, x, inside, values, gradients);
}

}  // namespace sansmesh::inline v1
