// Maps of space given by formulas.
#pragma once

#include <cmath>
#include <limits>

#include "sansmesh/space_map.h"

namespace sansmesh::test {

/// T(x) = by[0] x + by[1] y + by[2] z + to.
class AffineSpaceMap final : public SpaceMap {
 public:
  AffineSpaceMap(const Jacobian& by, const Vec3& to) : by_(by), to_(to) {}
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!wanted.positions.empty()) wanted.positions[i] = by_[0] * x[i].x + by_[1] * x[i].y + by_[2] * x[i].z + to_;
      if (!wanted.jacobians.empty()) wanted.jacobians[i] = by_;
      if (!wanted.gaps.empty()) wanted.gaps[i] = -std::numeric_limits<double>::infinity();
      if (!wanted.gap_gradients.empty()) wanted.gap_gradients[i] = {};
    }
  }
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override {
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      found[b] = {};
      for (int c = 0; c < 8; ++c) {
        const Vec3 p{(c & 1 ? boxes[b].upper : boxes[b].lower).x, (c & 2 ? boxes[b].upper : boxes[b].lower).y,
                     (c & 4 ? boxes[b].upper : boxes[b].lower).z};
        found[b].extend(by_[0] * p.x + by_[1] * p.y + by_[2] * p.z + to_);
      }
    }
  }

 private:
  Jacobian by_;
  Vec3 to_;
};

inline AffineSpaceMap identity_map() { return {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {}}; }

/// Rotation about the z axis by `rate` · z: preserves volumes.
class TwistMap final : public SpaceMap {
 public:
  explicit TwistMap(double rate) : rate_(rate) {}
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double c = std::cos(rate_ * x[i].z), s = std::sin(rate_ * x[i].z);
      const Vec3 u{c * x[i].x - s * x[i].y, s * x[i].x + c * x[i].y, x[i].z};
      if (!wanted.positions.empty()) wanted.positions[i] = u;
      if (!wanted.jacobians.empty())
        wanted.jacobians[i] = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{-rate_ * u.y, rate_ * u.x, 1}};
      if (!wanted.gaps.empty()) wanted.gaps[i] = -std::numeric_limits<double>::infinity();
      if (!wanted.gap_gradients.empty()) wanted.gap_gradients[i] = {};
    }
  }

 private:
  double rate_;
};

/// Moves both sides of x = 0 away from it by `half`, with a gap in between. `near`: distance up to which the gap is
/// known.
class SplitMap final : public SpaceMap {
 public:
  explicit SplitMap(double half, double near = std::numeric_limits<double>::infinity()) : half_(half), near_(near) {}
  bool has_gaps() const override { return true; }
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double side = x[i].x < 0 ? -1 : 1, gap = half_ - std::abs(x[i].x);
      const bool known = gap > -near_;
      if (!wanted.positions.empty()) wanted.positions[i] = x[i] - Vec3{side * half_, 0, 0};
      if (!wanted.jacobians.empty()) wanted.jacobians[i] = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
      if (!wanted.gaps.empty()) wanted.gaps[i] = known ? gap : -std::numeric_limits<double>::infinity();
      if (!wanted.gap_gradients.empty()) wanted.gap_gradients[i] = known ? Vec3{-side, 0, 0} : Vec3{};
    }
  }

 private:
  double half_, near_;
};

}  // namespace sansmesh::test
