// Principal axes of a handful of samples.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Symmetric 3×3 matrix.
template <class T>
struct Symmetric3T {
  T xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
  void add(const VecT<T>& d, T w = T(1)) {
    const T wx = w * d.x, wy = w * d.y, wz = w * d.z;
    xx += wx * d.x, xy += wx * d.y, xz += wx * d.z, yy += wy * d.y, yz += wy * d.z, zz += wz * d.z;
  }
};
using Symmetric3 = Symmetric3T<double>;

struct PrincipalAxes {
  Vec3 values;   ///< ascending eigenvalues, x smallest
  Vec3 axes[3];  ///< orthonormal eigenvectors to them
};

/// Eigenvalues and vectors (cyclic Jacobi: accurate for any matrix, degenerate ones included).
PrincipalAxes principal_axes(const Symmetric3& m);

/// Unit eigenvector to the smallest eigenvalue in closed form; zero where the matrix is zero. For matrices whose two
/// smallest eigenvalues (nearly) coincide the answer is some unit vector orthogonal to the largest one's.
Vec3 smallest_axis(const Symmetric3& m);

/// Covariance of offsets about their mean, divided by their number, and that mean.
struct Moments {
  Vec3 mean;
  Symmetric3 covariance;
};
Moments moments(std::span<const Vec3f> offsets);

}  // namespace sansmesh::inline v1
