// Least squares of one quadric ([ohtake2003], section 4).
#pragma once

#include <optional>
#include <span>

#include "sansmesh/surface/mpu/local_shape.h"

namespace sansmesh::inline v1 {

/// The samples of a ball; arrays of equal length, not empty. Positions relative to its centre.
struct BallSamples {
  std::span<const Vec3> positions, normals;
  std::span<const double> weights;  ///< > 0
};

/// A place off the surface, relative to the centre, and about its distance from the surface there (length).
struct DistancePlace {
  Vec3 x;
  double distance;
};

/// (b): w − g(u, v), with w along the unit vector `up` and g a polynomial of degree 0, 1 or 2 that fits the heights.
/// Where the samples do not tell all of it, as along a line, what they do not tell is 0.
QuadricPiece height_quadric(const BallSamples& samples, const Vec3& up, int degree);

/// (a): any quadric, 0 at the samples and about a distance at the places, both with the same share. Where they do not
/// tell all of it, the smallest one. `radius`: of the ball (length).
QuadricPiece general_quadric(const BallSamples& samples, std::span<const DistancePlace> places, double radius);

}  // namespace sansmesh::inline v1
