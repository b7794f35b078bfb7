// Principal axes of a small set of samples.
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
  Vec3 values;   ///< ascending eigenvalues, smallest in x
  Vec3 axes[3];  ///< corresponding orthonormal eigenvectors
};

/// Eigenvalues and eigenvectors (cyclic Jacobi: accurate for all matrices, including degenerate ones).
PrincipalAxes principal_axes(const Symmetric3& m);

/// Unit eigenvector of the smallest eigenvalue in closed form; zero for the zero matrix. If the two smallest
/// eigenvalues (nearly) coincide, some unit vector orthogonal to the eigenvector of the largest.
Vec3 smallest_axis(const Symmetric3& m);

/// Mean of offsets, and their covariance about it, divided by their number.
struct Moments {
  Vec3 mean;
  Symmetric3 covariance;
};
Moments moments(std::span<const Vec3f> offsets);

}  // namespace sansmesh::inline v1
