// Conjugate gradients for implicit integration, with vertices constrained in all or some directions (baraff1998).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/dynamics/elastic_model.h"

namespace sansmesh::inline v1 {

/// Constraint of a vertex.
struct VertexConstraint {
  enum class Kind : std::uint8_t { free, plane, held };
  Kind kind = Kind::free;
  Vec3 normal;  ///< plane: unit; the velocity along it is prescribed

  /// The unconstrained part of v.
  Vec3 filter(const Vec3& v) const {
    return kind == Kind::free ? v : kind == Kind::held ? Vec3{} : v - normal * dot(normal, v);
  }
};

struct SolverReport {
  int iterations = 0;
  bool converged = false;
  bool finite = true;  ///< false: overflow, convergence is undecidable
  double first = 0;    ///< squared norm of the first residual
};

/// The system (diag(d) + B) w = b with the matrix B of an elastic model, and workspace for its solution.
class BlockSolver {
 public:
  /// Uses the model's current matrix. `diagonal` has a positive number for each vertex. Both are kept by reference.
  void prepare(const ElasticModel& model, std::span<const double> diagonal);

  /// Computes (diag(d) + B) w.
  void multiply(std::span<const Vec3> w, std::span<Vec3> product) const;

  /// Squared norm of r over the unconstrained directions, in the norm of the preconditioner (inverse diagonal blocks).
  double squared_size(std::span<const VertexConstraint> constraints, std::span<const Vec3> r) const;

  /// Solves for the unconstrained parts of w; the others keep their values. Ends when the squared norm of the residual
  /// falls below `least`, or below `tolerance` squared times the larger of `size` and the first squared norm.
  SolverReport solve(std::span<const VertexConstraint> constraints, std::span<const Vec3> b, double size, double least,
                     double tolerance, int iterations, std::span<Vec3> w);

 private:
  void multiply_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const;

  const ElasticModel* model_ = nullptr;
  std::span<const double> diagonal_;
  std::vector<SymmetricBlock> inverses_;
  std::vector<Vec3> residual_, conditioned_, direction_, product_;
};

}  // namespace sansmesh::inline v1
