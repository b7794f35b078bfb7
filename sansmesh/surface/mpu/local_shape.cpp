#include "sansmesh/surface/mpu/local_shape.h"

#include <algorithm>
#include <limits>

namespace sansmesh::inline v1 {

ValueRange shape_range(const QuadricPiece* pieces, PieceCombination how, const Vec3& x, double radius) {
  std::array<ValueRange, kMostPieces> r{};
  for (std::size_t k = 0; k < how.pieces; ++k) {
    const double value = pieces[k].value(x);
    const double most = (norm(pieces[k].gradient(x)) + pieces[k].hessian_norm() * radius) * radius;
    r[k] = {value - most, value + most};
  }
  return how.combine(r, [](bool larger, const ValueRange& a, const ValueRange& b) {
    return larger ? ValueRange{std::max(a.least, b.least), std::max(a.most, b.most)}
                  : ValueRange{std::min(a.least, b.least), std::min(a.most, b.most)};
  });
}

double shape_error(const LocalShape& shape, std::span<const Vec3> x) {
  double most = 0;
  for (const Vec3& p : x) {
    const ShapeValue v = shape_value(shape.pieces.data(), shape.combination, p);
    const double slope = norm(shape.pieces[v.piece].gradient(p)), size = std::abs(v.value);
    if (size > most * slope) most = slope > 0 ? size / slope : std::numeric_limits<double>::infinity();
  }
  return most;
}

}  // namespace sansmesh::inline v1
