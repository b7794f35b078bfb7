// Similarity transformations: rotation, reflection, scaling, translation.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// x ↦ translation + scale · R x; R is orthogonal and may mirror.
struct Similarity {
  std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< columns of R
  double scale = 1;                                                          ///< > 0
  Vec3 translation;

  /// Whether R is not the identity.
  bool rotates() const { return columns != Similarity{}.columns; }
  /// R d, for directions; exact, also for infinite components, if R is the identity.
  Vec3 rotate(const Vec3& d) const { return rotates() ? columns[0] * d.x + columns[1] * d.y + columns[2] * d.z : d; }
  /// Rᵀ d.
  Vec3 rotate_back(const Vec3& d) const {
    return rotates() ? Vec3{dot(columns[0], d), dot(columns[1], d), dot(columns[2], d)} : d;
  }
  Vec3 operator()(const Vec3& x) const { return translation + scale * rotate(x); }
  /// Inverse image of a position.
  Vec3 back(const Vec3& x) const { return rotate_back(x - translation) * (1 / scale); }

  /// Inverse images, for evaluating the original of a transformed field.
  std::vector<Vec3> back(std::span<const Vec3> x) const;
  /// Converts values and gradients of the original field to those of the transformed one; distances stay distances.
  void carry(std::span<double> values, std::span<Vec3> gradients) const;

  Similarity inverse() const;
  /// This map followed by a rotation about `center` by a rotation vector (radians), a scaling about `center` and a
  /// shift.
  Similarity moved(const Vec3& center, const Vec3& rotation, double factor, const Vec3& shift) const;
  /// Composition: first `inner`, then `outer`.
  friend Similarity operator*(const Similarity& outer, const Similarity& inner);
};

/// Rotation about the origin by a rotation vector (radians).
Similarity rotation_by(const Vec3& vector);

/// Angle between the rotations of two maps, 0..π.
double angle_between(const Similarity& a, const Similarity& b);

/// Map from local to input coordinates.
Similarity similarity_of(const LocalFrame& frame);

}  // namespace sansmesh::inline v1
