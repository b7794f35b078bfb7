// Conjugate gradients for steps of implicit integration, with vertices that may not move, or not in all directions
// [baraff1998].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/dynamics/elastic_model.h"

namespace sansmesh::inline v1 {

/// What a vertex may do.
struct VertexConstraint {
  enum class Kind : std::uint8_t { free, plane, held };
  Kind kind = Kind::free;
  Vec3 normal;  ///< plane: unit; the velocity along it is given

  /// The part of v that is not given.
  Vec3 filter(const Vec3& v) const {
    return kind == Kind::free ? v : kind == Kind::held ? Vec3{} : v - normal * dot(normal, v);
  }
};

struct SolverReport {
  int iterations = 0;
  bool converged = false;
  bool finite = true;  ///< false: numbers became too large to tell whether it converged
  double first = 0;    ///< squared norm of the first residual
};

/// The system (diag(d) + B) w = b with the matrix B of an elastic model, and the memory that solving it takes.
class BlockSolver {
 public:
  /// Takes the model's matrix as it is now. `diagonal` has a positive number for each vertex. Both are kept by
  /// reference.
  void prepare(const ElasticModel& model, std::span<const double> diagonal);

  /// (diag(d) + B) w.
  void multiply(std::span<const Vec3> w, std::span<Vec3> product) const;

  /// The squared norm of r where constraints leave vertices free: that of the preconditioner, the inverse blocks of the
  /// diagonal.
  double squared_size(std::span<const VertexConstraint> constraints, std::span<const Vec3> r) const;

  /// Solves for the parts of w that constraints leave free; the others stay as they come. Ends when the squared norm of
  /// the residual is squared `tolerance` times the larger of that of the first one and of `size`, or `least`.
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
