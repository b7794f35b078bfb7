// What holds a body together: forces between its vertices, and how they change with positions and velocities.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A symmetric 3×3 matrix.
struct SymmetricBlock {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  Vec3 operator*(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// Spans have an entry for each vertex, in the model's own order. Sums are taken in a fixed order: results do not
/// depend on threads.
class ElasticModel {
 public:
  /// Where the stretch of what lies between vertices is beyond this, the body has exploded.
  static constexpr double kMostStretch = 1000;

  virtual ~ElasticModel() = default;

  /// f = elastic forces at x and damping at v, where v is not empty. False where something is stretched beyond
  /// kMostStretch, or not finite.
  virtual bool forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> f) = 0;

  /// The same without damping, and the matrix h² K + h D of the derivatives K = −∂f/∂x (without what could make it
  /// indefinite) and D = −∂f/∂v there, kept until the next call.
  virtual bool linearize(std::span<const Vec3> x, double h, std::span<Vec3> f) = 0;

  /// Rows first .. last − 1 of that matrix times p, added to q.
  virtual void add_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const = 0;
  /// The block of vertex i with itself.
  virtual SymmetricBlock diagonal(std::size_t i) const = 0;

  /// Joules.
  virtual double energy(std::span<const Vec3> x) const = 0;

  /// Where forces() or linearize() found the worst at these positions: "edge 17–23 is 2e5 times its length".
  /// `names` are the numbers that a user knows the vertices by.
  virtual std::string worst(std::span<const Vec3> x, std::span<const std::uint32_t> names) const = 0;
};

}  // namespace sansmesh::inline v1
