#include "sansmesh/dynamics/block_solver.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSolverRows = 1024;  ///< vertices per task and per partial sum

template <class Sum>
double sum_rows(std::size_t n, const Sum& sum) {
  return parallel_reduce(n, kSolverRows, 0.0, sum, [](double a, double b) { return a + b; });
}

SymmetricBlock inverse_of(const SymmetricBlock& m) {
  const double xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
  const double scale = 1 / (m.xx * xx + m.xy * xy + m.xz * xz);
  return {xx * scale,
          xy * scale,
          xz * scale,
          (m.xx * m.zz - m.xz * m.xz) * scale,
          (m.xy * m.xz - m.xx * m.yz) * scale,
          (m.xx * m.yy - m.xy * m.xy) * scale};
}

}  // namespace

void BlockSolver::prepare(const ElasticModel& model, std::span<const double> diagonal) {
  const std::size_t n = diagonal.size();
  model_ = &model, diagonal_ = diagonal;
  inverses_.resize(n), residual_.resize(n), conditioned_.resize(n), direction_.resize(n), product_.resize(n);
  parallel_for(0, n, kSolverRows, [&](std::size_t i) {
    SymmetricBlock block = model.diagonal(i);
    block.xx += diagonal[i], block.yy += diagonal[i], block.zz += diagonal[i];
    inverses_[i] = inverse_of(block);
  });
}

void BlockSolver::multiply_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const {
  for (std::size_t i = first; i < last; ++i) q[i] = p[i] * diagonal_[i];
  model_->add_rows(first, last, p, q);
}

void BlockSolver::multiply(std::span<const Vec3> w, std::span<Vec3> product) const {
  parallel_ranges(0, w.size(), kSolverRows,
                  [&](std::size_t first, std::size_t last) { multiply_rows(first, last, w, product); });
}

double BlockSolver::squared_size(std::span<const VertexConstraint> constraints, std::span<const Vec3> r) const {
  return sum_rows(r.size(), [&](std::size_t first, std::size_t last) {
    double sum = 0;
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 free = constraints[i].filter(r[i]);
      sum += dot(free, inverses_[i] * free);
    }
    return sum;
  });
}

SolverReport BlockSolver::solve(std::span<const VertexConstraint> constraints, std::span<const Vec3> b, double size,
                                double least, double tolerance, int iterations, std::span<Vec3> w) {
  const std::size_t n = w.size();
  const auto conditioned = [&](std::size_t i, const Vec3& r) {
    return constraints[i].filter(inverses_[i] * constraints[i].filter(r));
  };
  double rz = sum_rows(n, [&](std::size_t first, std::size_t last) {
    multiply_rows(first, last, w, product_);
    double sum = 0;
    for (std::size_t i = first; i < last; ++i) {
      residual_[i] = constraints[i].filter(b[i] - product_[i]);
      direction_[i] = conditioned_[i] = conditioned(i, residual_[i]);
      sum += dot(residual_[i], conditioned_[i]);
    }
    return sum;
  });
  const double enough = std::max(least, tolerance * tolerance * std::max(size, rz));
  SolverReport report;
  report.first = rz, report.finite = std::isfinite(rz) && std::isfinite(enough);
  if (!report.finite) return report;
  for (;;) {
    if (rz <= enough) {
      report.converged = true;
      return report;
    }
    if (report.iterations == iterations || !std::isfinite(rz)) return report;
    ++report.iterations;
    const double curvature = sum_rows(n, [&](std::size_t first, std::size_t last) {
      multiply_rows(first, last, direction_, product_);
      double sum = 0;
      for (std::size_t i = first; i < last; ++i) {
        product_[i] = constraints[i].filter(product_[i]);
        sum += dot(direction_[i], product_[i]);
      }
      return sum;
    });
    if (!(curvature > 0)) return report;
    const double length = rz / curvature;
    const double next = sum_rows(n, [&](std::size_t first, std::size_t last) {
      double sum = 0;
      for (std::size_t i = first; i < last; ++i) {
        w[i] += direction_[i] * length;
        residual_[i] -= product_[i] * length;
        conditioned_[i] = conditioned(i, residual_[i]);
        sum += dot(residual_[i], conditioned_[i]);
      }
      return sum;
    });
    const double turn = next / rz;
    rz = next;
    parallel_ranges(0, n, kSolverRows, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) direction_[i] = conditioned_[i] + direction_[i] * turn;
    });
  }
}

}  // namespace sansmesh::inline v1
