// Moving, turning, mirroring, scaling: a field as it is elsewhere.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// x ↦ translation + scale · rotation x; the rotation may mirror.
struct Similarity {
  std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  double scale = 1;
  Vec3 translation;
  bool turned = false;  ///< the rotation is not the identity

  Vec3 turn(const Vec3& d) const { return turned ? columns[0] * d.x + columns[1] * d.y + columns[2] * d.z : d; }
  Vec3 turn_back(const Vec3& d) const {
    return turned ? Vec3{dot(columns[0], d), dot(columns[1], d), dot(columns[2], d)} : d;
  }
  Vec3 apply(const Vec3& x) const { return translation + scale * turn(x); }

  Vec3 back(const Vec3& x) const { return turn_back(x - translation) * (1 / scale); }

  /// Places where a field that was moved so is asked, in the coordinates that it had before.
  std::vector<Vec3> back(std::span<const Vec3> x) const {
    std::vector<Vec3> y(x.size());
    const double inverse = 1 / scale;
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = turn_back(x[i] - translation) * inverse;
    return y;
  }
  /// What it says there, as values and gradients of the moved one: distances stay distances.
  void carry(std::span<double> values, std::span<Vec3> gradients) const {
    if (scale != 1)
      for (double& v : values) v *= scale;
    if (turned)
      for (Vec3& g : gradients) g = turn(g);
  }

  /// First `inner`, then `outer`.
  friend Similarity operator*(const Similarity& outer, const Similarity& inner) {
    Similarity s;
    for (std::size_t k = 0; k < 3; ++k) s.columns[k] = outer.turn(inner.columns[k]);
    s.scale = outer.scale * inner.scale;
    s.translation = outer.apply(inner.translation);
    s.turned = outer.turned || inner.turned;
    return s;
  }
};

/// From own coordinates to those of the input.
inline Similarity similarity_of(const LocalFrame& frame) {
  Similarity s;
  s.scale = frame.unit;
  s.translation = frame.origin;
  return s;
}

}  // namespace sansmesh::inline v1
