// Least-squares fits of one quadric (ohtake2003, section 4).
#pragma once

#include <span>

#include "sansmesh/surface/mpu/local_shape.h"

namespace sansmesh::inline v1 {

/// Samples of a ball; arrays of equal length, not empty. Positions relative to its centre.
struct BallSamples {
  std::span<const Vec3> positions, normals;
  std::span<const double> weights;  ///< > 0
};

/// A point off the surface, relative to the centre, and its approximate distance from the surface (length).
struct DistanceConstraint {
  Vec3 x;
  double distance;
};

/// Case (b): w − g(u, v), with w along the unit vector `up` and g a polynomial of degree 0, 1 or 2 fitted to the
/// heights. Coefficients that the samples do not determine, for example along a line, are 0.
QuadricPiece height_quadric(const BallSamples& samples, const Vec3& up, int degree);

/// Case (a): a general quadric, 0 at the samples and approximately the distance at the given points, both with equal
/// total weight. The smallest one if they do not determine it. `radius`: radius of the ball (length).
QuadricPiece general_quadric(const BallSamples& samples, std::span<const DistanceConstraint> constraints,
                             double radius);

}  // namespace sansmesh::inline v1
