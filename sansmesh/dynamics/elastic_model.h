// Elastic forces of a body and their derivatives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A symmetric 3×3 matrix.
struct SymmetricBlock {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  Vec3 operator*(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// Spans have an entry for each vertex, in the model's own order. Sums have a fixed order, so that results do not
/// depend on the number of threads.
class ElasticModel {
 public:
  /// Largest stretch of an edge or tetrahedron; beyond it, the body has exploded.
  static constexpr double kMostStretch = 1000;

  virtual ~ElasticModel() = default;

  /// f = elastic forces at x, plus damping at v if v is not empty. Returns false if something is stretched beyond
  /// kMostStretch, or not finite.
  virtual bool forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> f) = 0;

  /// Elastic forces, and the matrix h² K + h D of the derivatives K = −∂f/∂x (without indefinite parts) and D = −∂f/∂v,
  /// which is kept until the next call.
  virtual bool linearize(std::span<const Vec3> x, double h, std::span<Vec3> f) = 0;

  /// Adds rows first .. last − 1 of that matrix times p to q.
  virtual void add_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const = 0;
  /// Diagonal block of vertex i.
  virtual SymmetricBlock diagonal(std::size_t i) const = 0;

  /// Energy in joules.
  virtual double energy(std::span<const Vec3> x) const = 0;

  /// Description of the worst stretch that forces() or linearize() found: "edge 17–23 is 2e5 times its length". `names`
  /// are the original vertex indices.
  virtual std::string worst(std::span<const Vec3> x, std::span<const std::uint32_t> names) const = 0;
};

}  // namespace sansmesh::inline v1
