#include "sansmesh/volume/cells/cell_inverse.h"

namespace sansmesh::inline v1 {
namespace {

/// Deviation from the linear part below which one correction by it suffices: each correction reduces errors by this
/// factor.
constexpr double kNearlyLinear = 1e-9;
/// Deviation below which no correction is needed, unless edges are so oblique (length over the component perpendicular
/// to the others) that it would gain digits.
constexpr double kLinear = 1e-15, kUpright = 10;

CellMap map_about_first(CellShape shape, std::span<const Vec3> corners) {
  std::array<Vec3, 8> relative;
  for (std::size_t k = 0; k < corners.size(); ++k) relative[k] = corners[k] - corners[0];
  return {shape, std::span<const Vec3>(relative).first(corners.size())};
}

}  // namespace

CellInverse::CellInverse(CellShape shape, std::span<const Vec3> corners)
    : shape_(shape), map_(map_about_first(shape, corners)) {
  if (shape != CellShape::tetrahedron) middle_ = {0.5, 0.5, 0.5};
  center_ = map_.at(middle_);
  const auto d = map_.derivatives(middle_);
  const Vec3 st = cross(d[1], d[2]);
  const double size = dot(d[0], st);
  solvable_ = size != 0;
  rows_ = {st / size, cross(d[2], d[0]) / size, cross(d[0], d[1]) / size};
  const CellMap::Curvature c = map_.curvature();
  const Vec3 half = c.rst * 0.5, rs = c.rs + half, tt = c.st + half, rt = c.rt + half;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& row = rows_[k];
    // X(v + 1/2) = centre + J v + nonlinear part, |v_k| <= 1/2.
    curved_[k] =
        0.25 * (std::abs(dot(row, rs)) + std::abs(dot(row, tt)) + std::abs(dot(row, rt)) + std::abs(dot(row, half)));
    reach_[k] = norm(row);
  }
  const double curved = std::max({curved_[0], curved_[1], curved_[2]});
  nearly_linear_ = shape == CellShape::tetrahedron || curved < kNearlyLinear;
  const bool upright = std::max({reach_[0] * norm(d[0]), reach_[1] * norm(d[1]), reach_[2] * norm(d[2])}) < kUpright;
  linear_ = shape == CellShape::tetrahedron || (curved < kLinear && upright);
}

bool CellInverse::may_reach(const Vec3& x, double distance) const {
  if (shape_ == CellShape::tetrahedron || !solvable_) return true;  // invert() is as fast
  const Vec3 u = by_rows(x - center_);
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(u[k]) > 0.5 + 1e-9 + curved_[k] + distance * reach_[k]) return false;
  return true;
}

}  // namespace sansmesh::inline v1
