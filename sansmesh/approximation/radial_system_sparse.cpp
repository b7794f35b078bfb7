#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "sansmesh/approximation/radial_system.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::size_t kMaxEntries = std::size_t{1} << 30;
constexpr std::size_t kBlock = 512;            ///< rows; fixed, so that sums do not depend on the number of threads
constexpr std::size_t kFactorNeighbours = 24;  ///< entries per row of the preconditioner

struct Rows {
  std::vector<std::size_t> start;
  std::vector<std::uint32_t> column;
  std::vector<double> value;

  // y = M x for c interleaved right-hand sides.
  void multiply(std::size_t c, std::span<const double> x, std::span<double> y) const {
    switch (c) {
      case 1:
        return multiply_by<1>(1, x, y);
      case 2:
        return multiply_by<2>(2, x, y);
      case 3:
        return multiply_by<3>(3, x, y);
      case 4:
        return multiply_by<4>(4, x, y);
      case 5:
        return multiply_by<5>(5, x, y);
      default:
        return multiply_by<0>(c, x, y);
    }
  }
  // C right-hand sides at compile time; C = 0: c of them at run time, up to 11.
  template <std::size_t C>
  void multiply_by(std::size_t c, std::span<const double> x, std::span<double> y) const {
    const std::size_t count = C > 0 ? C : c;
    parallel_for(0, start.size() - 1, kBlock, [&](std::size_t i) {
      std::array<double, C != 0 ? C : 11> sum{};
      for (std::size_t e = start[i]; e < start[i + 1]; ++e) {
        const double a = value[e];
        const double* other = x.data() + column[e] * count;
        for (std::size_t m = 0; m < count; ++m) sum[m] += a * other[m];
      }
      std::copy_n(sum.begin(), count, y.begin() + static_cast<std::ptrdiff_t>(i * count));
    });
  }
  Rows transposed() const {
    Rows t;
    const std::size_t n = start.size() - 1;
    t.start.assign(n + 1, 0);
    for (const std::uint32_t j : column) ++t.start[j + 1];
    for (std::size_t j = 0; j < n; ++j) t.start[j + 1] += t.start[j];
    t.column.resize(column.size());
    t.value.resize(value.size());
    std::vector<std::size_t> next(t.start.begin(), t.start.end() - 1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t e = start[i]; e < start[i + 1]; ++e) {
        const std::size_t to = next[column[e]]++;
        t.column[to] = static_cast<std::uint32_t>(i);
        t.value[to] = value[e];
      }
    return t;
  }
};

// Builds rows in blocks with `fill(i, columns, values)`.
template <class Fill>
Rows build_rows(std::size_t n, Fill&& fill) {
  Rows rows;
  rows.start.assign(n + 1, 0);
  std::vector<Rows> blocks((n + kBlock - 1) / kBlock);
  parallel_for(0, blocks.size(), 1, [&](std::size_t b) {
    Rows& block = blocks[b];
    for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
      const std::size_t before = block.column.size();
      fill(i, block.column, block.value);
      rows.start[i + 1] = block.column.size() - before;
    }
  });
  for (std::size_t i = 0; i < n; ++i) rows.start[i + 1] += rows.start[i];
  rows.column.resize(rows.start[n]);
  rows.value.resize(rows.start[n]);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto at = static_cast<std::ptrdiff_t>(rows.start[b * kBlock]);
    std::copy(blocks[b].column.begin(), blocks[b].column.end(), rows.column.begin() + at);
    std::copy(blocks[b].value.begin(), blocks[b].value.end(), rows.value.begin() + at);
    blocks[b] = {};
  }
  return rows;
}

// Eigen code is independent of the dimension and slow to compile, so outside the templates.

using Local = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kFactorNeighbours + 1, kFactorNeighbours + 1>;
using LocalRow = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kFactorNeighbours + 1, 1>;

/// Last row of the inverse of a symmetric matrix, which is overwritten; of the identity if it is singular.
LocalRow last_of_inverse(Local& matrix) {
  const Eigen::Index last = matrix.rows() - 1;
  LocalRow y(matrix.rows());
  y.setZero();
  y[last] = 1;
  Eigen::LLT<Eigen::Ref<Local>> llt(matrix);
  if (llt.info() == Eigen::Success) llt.solveInPlace(y);
  if (llt.info() != Eigen::Success || !(y[last] > 0) || !y.allFinite()) {  // nearly coincident samples: Jacobi
    y.setZero();
    y[last] = 1;
  }
  return y;
}

/// Solves (Pᵀ A⁻¹ P) b = Pᵀ A⁻¹ f, c = A⁻¹ f − A⁻¹ P b. `b` holds f and P, `solution` A⁻¹ of these, 1 + tail columns
/// each. Returns the number of dropped monomials.
int solve_tail(std::span<const double> b, std::span<const double> solution, std::span<double> tail,
               std::span<double> c) {
  const auto size = static_cast<Eigen::Index>(tail.size());
  const std::size_t n = c.size(), m = 1 + tail.size();
  int dropped = 0;
  Eigen::VectorXd beta;
  if (size > 0) {
    Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(size);
    for (std::size_t i = 0; i < n; ++i)
      for (Eigen::Index k = 0; k < size; ++k) {
        const double pk = b[i * m + 1 + static_cast<std::size_t>(k)];
        rhs[k] += pk * solution[i * m];
        for (Eigen::Index l = 0; l < size; ++l) schur(k, l) += pk * solution[i * m + 1 + static_cast<std::size_t>(l)];
      }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(size, size);
    qr.setThreshold(1e-9);
    qr.compute(schur);
    beta = qr.solve(rhs);
    dropped = static_cast<int>(size - qr.rank());
  }
  for (Eigen::Index k = 0; k < size; ++k) tail[static_cast<std::size_t>(k)] = beta[k];
  for (std::size_t i = 0; i < n; ++i) {
    c[i] = solution[i * m];
    for (Eigen::Index k = 0; k < size; ++k) c[i] -= beta[k] * solution[i * m + 1 + static_cast<std::size_t>(k)];
  }
  return dropped;
}

// Dot products of c interleaved vectors.
std::vector<double> dots(std::size_t c, std::span<const double> a, std::span<const double> b) {
  return parallel_reduce(
      a.size() / c, 4096, std::vector<double>(c, 0.0),
      [&](std::size_t first, std::size_t last) {
        std::vector<double> sum(c, 0.0);
        for (std::size_t i = first * c; i < last * c; i += c)
          for (std::size_t m = 0; m < c; ++m) sum[m] += a[i + m] * b[i + m];
        return sum;
      },
      [](std::vector<double> s, const std::vector<double>& t) {
        for (std::size_t m = 0; m < s.size(); ++m) s[m] += t[m];
        return s;
      });
}

/// Conjugate gradients for m interleaved right-hand sides b, preconditioned by Gᵀ G. Returns iterations and the largest
/// relative residual.
SparseResult conjugate_gradients(const Rows& a, const Rows& g, std::size_t m, std::span<const double> b,
                                 double tolerance, int max_iterations, std::vector<double>& solution) {
  const Rows gt = g.transposed();
  std::vector<double> r(b.begin(), b.end()), z(b.size()), ap(b.size()), t(b.size());
  solution.assign(b.size(), 0.0);
  const std::vector<double> norm = dots(m, b, b);
  const auto precondition = [&] {
    g.multiply(m, r, t);
    gt.multiply(m, t, z);
  };
  precondition();
  std::vector<double> p = z, rz = dots(m, r, z);
  SparseResult result;
  const auto worst = [&] {
    const std::vector<double> rr = dots(m, r, r);
    double w = 0;
    for (std::size_t k = 0; k < m; ++k)
      if (norm[k] > 0) w = std::max(w, rr[k] / norm[k]);
    return std::sqrt(w);
  };
  while ((result.residual = worst()) > tolerance && result.iterations < max_iterations) {
    a.multiply(m, p, ap);
    const std::vector<double> pap = dots(m, p, ap);
    std::vector<double> alpha(m, 0.0);
    for (std::size_t k = 0; k < m; ++k)
      if (pap[k] > 0) alpha[k] = rz[k] / pap[k];
    for (std::size_t i = 0; i < b.size(); i += m)
      for (std::size_t k = 0; k < m; ++k) {
        solution[i + k] += alpha[k] * p[i + k];
        r[i + k] -= alpha[k] * ap[i + k];
      }
    precondition();
    const std::vector<double> next = dots(m, r, z);
    for (std::size_t i = 0; i < b.size(); i += m)
      for (std::size_t k = 0; k < m; ++k) p[i + k] = z[i + k] + (rz[k] > 0 ? next[k] / rz[k] : 0) * p[i + k];
    rz = next;
    ++result.iterations;
  }
  return result;
}

/// Throws DataError if the matrix of this kernel would have more than kMaxEntries entries, estimated at some samples.
template <int D>
void check_entries(const RadialKernel& kernel, const SampleIndex<D>& samples) {
  const std::size_t n = samples.size(), probes = std::min<std::size_t>(n, 64);
  std::vector<typename SampleIndex<D>::Hit> hits;
  double expected = 0;
  for (std::size_t i = 0; i < probes; ++i) {
    samples.within(samples.positions()[samples.order()[i * n / probes]], kernel.support(), hits);
    expected += static_cast<double>(hits.size()) / static_cast<double>(probes);
  }
  if (expected * static_cast<double>(n) > static_cast<double>(kMaxEntries))
    throw DataError("approximation: the support holds about " + std::to_string(static_cast<long>(expected)) +
                    " samples: lower the scale");
}

/// Rows of the matrix by index, nearest samples first.
template <int D>
Rows kernel_rows(const RadialKernel& kernel, double ridge, const SampleIndex<D>& samples) {
  return build_rows(samples.size(), [&](std::size_t i, std::vector<std::uint32_t>& column, std::vector<double>& value) {
    thread_local std::vector<typename SampleIndex<D>::Hit> hits;
    samples.within(samples.positions()[i], kernel.support(), hits);
    for (const auto& hit : hits) {
      column.push_back(hit.index);
      value.push_back(kernel(hit.squared_distance) + (hit.index == i ? ridge : 0));
    }
  });
}

/// Preconditioner from the nearest samples that precede in a random order: an approximate inverse G of the Cholesky
/// factor, G A Gᵀ ≈ 1, exact on the pattern (kolotilina1993).
template <int D>
Rows inverse_factor(const RadialKernel& kernel, double ridge, std::span<const Position<D>> x, const Rows& a) {
  const auto rank = [](std::size_t i) { return mixed_bits(i + 1); };
  return build_rows(x.size(), [&](std::size_t i, std::vector<std::uint32_t>& column, std::vector<double>& value) {
    std::array<std::uint32_t, kFactorNeighbours + 1> set;
    Eigen::Index count = 0;
    for (std::size_t e = a.start[i]; e < a.start[i + 1] && count < static_cast<Eigen::Index>(kFactorNeighbours); ++e)
      if (a.column[e] != i && rank(a.column[e]) < rank(i)) set[static_cast<std::size_t>(count++)] = a.column[e];
    set[static_cast<std::size_t>(count++)] = static_cast<std::uint32_t>(i);
    Local local(count, count);
    for (Eigen::Index p = 0; p < count; ++p)
      for (Eigen::Index q = 0; q <= p; ++q)
        local(p, q) = local(q, p) =
            kernel(squared_distance<D>(x[set[static_cast<std::size_t>(p)]], x[set[static_cast<std::size_t>(q)]])) +
            (p == q ? ridge : 0);
    const LocalRow y = last_of_inverse(local);
    const double root = std::sqrt(y[count - 1]);
    for (Eigen::Index p = 0; p < count; ++p) {
      column.push_back(set[static_cast<std::size_t>(p)]);
      value.push_back(y[p] / root);
    }
  });
}

}  // namespace

template <int D>
SparseResult solve_sparse(const RadialKernel& kernel, double ridge, const SampleIndex<D>& samples,
                          std::span<const double> f, double tolerance, int max_iterations, PolynomialTail<D>& tail,
                          std::span<double> c) {
  check_entries(kernel, samples);
  const std::size_t n = samples.size();
  const std::span<const Position<D>> x = samples.positions();
  const Rows a = kernel_rows(kernel, ridge, samples), g = inverse_factor<D>(kernel, ridge, x, a);
  // The right-hand sides are the values, then the monomials: one pass over A serves all in each step.
  const std::size_t m = 1 + static_cast<std::size_t>(tail.size);
  std::vector<double> b(n * m), solution;
  for (std::size_t i = 0; i < n; ++i) {
    b[i * m] = f[i];
    tail.basis(x[i], b.data() + i * m + 1);
  }
  SparseResult result = conjugate_gradients(a, g, m, b, tolerance, max_iterations, solution);
  if (!(result.residual <= tolerance))
    throw DataError("approximation: conjugate gradients reach a residual of " + std::to_string(result.residual) +
                    " only: lower the scale, add a ridge or raise the tolerance");
  tail.coefficient.fill(0);
  const std::span<double> coefficients = std::span(tail.coefficient).first(static_cast<std::size_t>(tail.size));
  result.dropped = solve_tail(b, solution, coefficients, c.first(n));
  return result;
}

#define SANSMESH_INSTANTIATE(D)                                                                                      \
  template SparseResult solve_sparse<D>(const RadialKernel&, double, const SampleIndex<D>&, std::span<const double>, \
                                        double, int, PolynomialTail<D>&, std::span<double>);
SANSMESH_INSTANTIATE(1)
SANSMESH_INSTANTIATE(2)
SANSMESH_INSTANTIATE(3)
#undef SANSMESH_INSTANTIATE

}  // namespace sansmesh::inline v1::detail
