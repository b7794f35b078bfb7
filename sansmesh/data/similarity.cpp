#include "sansmesh/data/similarity.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {

std::vector<Vec3> Similarity::back(std::span<const Vec3> x) const {
  std::vector<Vec3> y(x.size());
  const double inverse = 1 / scale;
  const bool turned = rotates();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 d = x[i] - translation;
    y[i] = (turned ? rotate_back(d) : d) * inverse;
  }
  return y;
}

void Similarity::carry(std::span<double> values, std::span<Vec3> gradients) const {
  if (scale != 1)
    for (double& v : values) v *= scale;
  if (rotates())
    for (Vec3& g : gradients) g = rotate(g);
}

Similarity Similarity::inverse() const {
  Similarity s;
  for (std::size_t k = 0; k < 3; ++k) s.columns[k] = {columns[0][k], columns[1][k], columns[2][k]};
  s.scale = 1 / scale;
  s.translation = rotate_back(translation) * (-1 / scale);
  return s;
}

Similarity Similarity::moved(const Vec3& center, const Vec3& rotation, double factor, const Vec3& shift) const {
  Similarity s = rotation_by(rotation);
  const Vec3 to = s.rotate(translation - center) * factor + center + shift;
  return {{s.rotate(columns[0]), s.rotate(columns[1]), s.rotate(columns[2])}, scale * factor, to};
}

Similarity operator*(const Similarity& outer, const Similarity& inner) {
  Similarity s;
  for (std::size_t k = 0; k < 3; ++k) s.columns[k] = outer.rotate(inner.columns[k]);
  s.scale = outer.scale * inner.scale;
  s.translation = outer(inner.translation);
  return s;
}

Similarity rotation_by(const Vec3& vector) {
  const double angle = norm(vector);
  const Vec3 axis = angle > 0 ? vector / angle : Vec3{0, 0, 1};
  Similarity s;
  for (Vec3& e : s.columns)
    e = e * std::cos(angle) + cross(axis, e) * std::sin(angle) + axis * (dot(axis, e) * (1 - std::cos(angle)));
  return s;
}

double angle_between(const Similarity& a, const Similarity& b) {
  double trace = 0;
  for (std::size_t k = 0; k < 3; ++k) trace += dot(a.columns[k], b.columns[k]);
  return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
}

Similarity similarity_of(const LocalFrame& frame) {
  Similarity s;
  s.scale = frame.unit;
  s.translation = frame.origin;
  return s;
}

}  // namespace sansmesh::inline v1
