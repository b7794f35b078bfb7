#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sansmesh/approximation/radial_system.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {

template <int D>
void PolynomialTail<D>::basis(const Position<D>& x, double* values) const {
  const auto& order = PolynomialOrder<D>::get();
  for (int j = 0; j < size; ++j)
    values[j] = j == 0 ? 1
                       : values[order[j].predecessor] *
                             (x[static_cast<std::size_t>(order[j].variable)] -
                              center[static_cast<std::size_t>(order[j].variable)]) /
                             scale;
}

template <int D>
void PolynomialTail<D>::add(const Position<D>& x, double& value, Position<D>* gradient) const {
  if (size == 0) return;
  const auto& order = PolynomialOrder<D>::get();
  std::array<double, kMaxSize> m;
  basis(x, m.data());
  for (int j = 0; j < size; ++j) value += coefficient[static_cast<std::size_t>(j)] * m[static_cast<std::size_t>(j)];
  if (!gradient) return;
  std::array<Position<D>, kMaxSize> slope{};
  for (int j = 1; j < size; ++j) {
    const auto k = static_cast<std::size_t>(order[j].variable), p = static_cast<std::size_t>(order[j].predecessor);
    const double u = (x[k] - center[k]) / scale;
    auto& own = slope[static_cast<std::size_t>(j)];
    for (std::size_t c = 0; c < D; ++c) own[c] = u * slope[p][c];
    own[k] += m[p] / scale;
    for (std::size_t c = 0; c < D; ++c) (*gradient)[c] += coefficient[static_cast<std::size_t>(j)] * own[c];
  }
}

template <int D>
PolynomialTail<D> make_tail(std::span<const Position<D>> x, int degree) {
  PolynomialTail<D> tail;
  tail.size = tail_size<D>(degree);
  double extent = 0;
  for (std::size_t k = 0; k < D; ++k) {
    double low = x[0][k], high = low;
    for (const auto& p : x) low = std::min(low, p[k]), high = std::max(high, p[k]);
    tail.center[k] = low + (high - low) / 2;
    extent = std::max(extent, (high - low) / 2);
  }
  if (extent > 0 && std::isnormal(1 / extent)) tail.scale = extent;
  return tail;
}

namespace {

using Eigen::Index;

/// Solves (A + λ) c + P b = f, Pᵀ c = 0. Independent of the dimension, so that Eigen is compiled once. Overwrites a,
/// which includes λ, and rhs, which is f.
DenseResult solve_saddle(Eigen::MatrixXd& a, const Eigen::MatrixXd& p, Eigen::VectorXd& rhs, std::span<double> b,
                         std::span<double> c) {
  const Index n = a.rows();
  // P = Q R up to a permutation of its columns; dependent columns are omitted.
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  Index rank = 0;
  if (p.cols() > 0) {
    qr.setThreshold(1e-9);
    qr.compute(p);
    rank = qr.rank();
  }
  DenseResult result;
  result.dropped = static_cast<int>(p.cols() - rank);
  // With B = Qᵀ A Q and g = Qᵀ f the coefficients are c = Q (0, y), B₂₂ y = g₂, and R b = g₁ − B₁₂ y.
  if (rank > 0) {
    // Only the first `rank` reflections: Q's leading columns then span the columns kept.
    auto q = qr.householderQ();
    q.setLength(rank);
    a.applyOnTheLeft(q.adjoint());
    a.applyOnTheRight(q);
    rhs.applyOnTheLeft(q.adjoint());
  }
  const Index free = n - rank;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
  if (free > 0) {
    Eigen::MatrixXd free_part = a.bottomRightCorner(free, free);
    const double unit = std::max(free_part.diagonal().cwiseAbs().maxCoeff(), 1e-300);
    double added = 0;
    for (double step = 1e-15 * unit;; step *= 100) {
      Eigen::LLT<Eigen::MatrixXd> llt(free_part);
      // A factor whose diagonal spans 1e-8 belongs to a matrix of condition 1e16.
      if (llt.info() == Eigen::Success && llt.matrixLLT().diagonal().minCoeff() > 3e-8 * std::sqrt(unit)) {
        y.tail(free) = llt.solve(rhs.tail(free));
        // One step of refinement; the remaining residual is due to the condition.
        y.tail(free) += llt.solve(rhs.tail(free) - free_part * y.tail(free));
        break;
      }
      if (step > unit) throw DataError("approximation: the system of the radial basis functions cannot be solved");
      free_part.diagonal().array() += step;
      added += step;
    }
    result.added_ridge = added;
  }
  std::fill(b.begin(), b.end(), 0.0);
  if (rank > 0) {
    Eigen::VectorXd kept = rhs.head(rank) - a.topRightCorner(rank, free) * y.tail(free);
    qr.matrixR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solveInPlace(kept);
    for (Index j = 0; j < rank; ++j) b[static_cast<std::size_t>(qr.colsPermutation().indices()[j])] = kept[j];
    auto q = qr.householderQ();
    q.setLength(rank);
    y.applyOnTheLeft(q);
  }
  for (Index i = 0; i < n; ++i) c[static_cast<std::size_t>(i)] = y[i];
  return result;
}

}  // namespace

template <int D>
DenseResult solve_dense(const RadialKernel& kernel, double ridge, std::span<const Position<D>> x,
                        std::span<const double> f, PolynomialTail<D>& tail, std::span<double> c) {
  const auto n = static_cast<Index>(x.size());
  const auto at = [&](Index i) -> const Position<D>& { return x[static_cast<std::size_t>(i)]; };
  Eigen::MatrixXd a(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i) a(i, j) = a(j, i) = kernel(squared_distance<D>(at(i), at(j)));
  a.diagonal().array() += ridge;
  Eigen::VectorXd rhs = Eigen::Map<const Eigen::VectorXd>(f.data(), n);
  Eigen::MatrixXd p(n, tail.size);
  std::array<double, PolynomialTail<D>::kMaxSize> m;
  for (Index i = 0; i < n; ++i) {
    tail.basis(at(i), m.data());
    for (Index j = 0; j < tail.size; ++j) p(i, j) = m[static_cast<std::size_t>(j)];
  }
  return solve_saddle(a, p, rhs, tail.coefficient, c);
}

#define SANSMESH_INSTANTIATE(D)                                                                  \
  template struct PolynomialTail<D>;                                                             \
  template PolynomialTail<D> make_tail<D>(std::span<const Position<D>>, int);                    \
  template DenseResult solve_dense<D>(const RadialKernel&, double, std::span<const Position<D>>, \
                                      std::span<const double>, PolynomialTail<D>&, std::span<double>);
SANSMESH_INSTANTIATE(1)
SANSMESH_INSTANTIATE(2)
SANSMESH_INSTANTIATE(3)
#undef SANSMESH_INSTANTIATE

}  // namespace sansmesh::inline v1::detail
