// Benchmark of five solvers for one local least-squares approximation by trivariate polynomials, on the same
// neighbourhoods, beside the times of tejada2008, table 6.1.
//
//   benchmark_approximation_solvers [NEIGHBOURS=100] [FITS=2000]
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "timing.h"

using namespace sansmesh;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Weighted samples around the origin, where the approximation is evaluated.
struct Neighbourhood {
  std::array<std::vector<double>, 3> x;
  std::vector<double> f, w;
};

Neighbourhood make_neighbourhood(std::size_t n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> in_box(-1, 1);
  Neighbourhood hood;
  while (hood.f.size() < n) {
    const std::array p{in_box(random), in_box(random), in_box(random)};
    const double r2 = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    if (r2 >= 1) continue;
    for (std::size_t k = 0; k < 3; ++k) hood.x[k].push_back(p[k]);
    hood.f.push_back(std::sin(2 * p[0] + p[1]) * std::exp(p[2]) + p[1] * p[2]);
    hood.w.push_back(std::pow(1 - r2, 4));
  }
  return hood;
}

// Rows √w_i (monomials of x_i), right-hand side √w_i f_i.
void design(const Neighbourhood& hood, int degree, MatrixXd& a, VectorXd& b) {
  const auto& order = PolynomialOrder<3>::get();
  const auto n = static_cast<Index>(hood.f.size());
  a.resize(n, monomial_count(3, degree));
  b.resize(n);
  for (Index i = 0; i < n; ++i) {
    const auto s = static_cast<std::size_t>(i);
    const double root = std::sqrt(hood.w[s]);
    a(i, 0) = root;
    for (Index j = 1; j < a.cols(); ++j) {
      const auto& step = order[static_cast<int>(j)];
      a(i, j) = a(i, step.predecessor) * hood.x[static_cast<std::size_t>(step.variable)][s];
    }
    b[i] = root * hood.f[s];
  }
}

double by_orthogonal_polynomials(const Neighbourhood& hood, int degree) {
  thread_local OrthogonalFit<3> fit;
  ApproximationSamples<3> samples;
  for (std::size_t k = 0; k < 3; ++k) samples.positions[k] = hood.x[k];
  samples.values = hood.f;
  samples.weights = hood.w;
  fit.reset(samples, ApproximationFrame<3>{});
  while (fit.degree() < degree) fit.raise();
  return fit.value({0, 0, 0});
}

struct Normal {
  MatrixXd a, n;
  VectorXd b, r;
};
Normal& normal_equations(const Neighbourhood& hood, int degree) {
  thread_local Normal s;
  design(hood, degree, s.a, s.b);
  s.n.noalias() = s.a.transpose() * s.a;
  s.r.noalias() = s.a.transpose() * s.b;
  return s;
}

double by_conjugate_gradients(const Neighbourhood& hood, int degree) {
  const Normal& s = normal_equations(hood, degree);
  VectorXd x = VectorXd::Zero(s.r.size()), r = s.r, p = r, ap;
  double rr = r.squaredNorm();
  const double end = 1e-24 * rr;
  for (Index step = 0; step < 10 * s.r.size() && rr > end; ++step) {
    ap.noalias() = s.n * p;
    const double alpha = rr / p.dot(ap);
    x += alpha * p;
    r -= alpha * ap;
    const double next = r.squaredNorm();
    p = r + (next / rr) * p;
    rr = next;
  }
  return x[0];
}

double by_gauss_jordan(const Neighbourhood& hood, int degree) {
  Normal& s = normal_equations(hood, degree);
  const Index n = s.r.size();
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i)
      if (std::abs(s.n(i, k)) > std::abs(s.n(pivot, k))) pivot = i;
    s.n.row(k).swap(s.n.row(pivot));
    std::swap(s.r[k], s.r[pivot]);
    const double inverse = 1 / s.n(k, k);
    s.n.row(k) *= inverse;
    s.r[k] *= inverse;
    for (Index i = 0; i < n; ++i) {
      const double factor = s.n(i, k);
      if (i == k || factor == 0) continue;
      s.n.row(i) -= factor * s.n.row(k);
      s.r[i] -= factor * s.r[k];
    }
  }
  return s.r[0];
}

double by_qr(const Neighbourhood& hood, int degree) {
  thread_local Normal s;
  design(hood, degree, s.a, s.b);
  return s.a.householderQr().solve(s.b)[0];
}

double by_svd(const Neighbourhood& hood, int degree) {
  thread_local Normal s;
  design(hood, degree, s.a, s.b);
  return s.a.bdcSvd(Eigen::ComputeThinU | Eigen::ComputeThinV).solve(s.b)[0];
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t neighbours = argc > 1 ? std::stoul(argv[1]) : 100;
  const std::size_t fits = argc > 2 ? std::stoul(argv[2]) : 2000;
  if (neighbours < 35 || fits == 0) {
    std::fprintf(stderr, "benchmark_approximation_solvers: at least 35 neighbours and one fit\n");
    return 2;
  }
  std::mt19937_64 random(1);
  std::vector<Neighbourhood> hoods;
  for (std::size_t i = 0; i < std::min<std::size_t>(fits, 200); ++i)
    hoods.push_back(make_neighbourhood(neighbours, random));

  struct Method {
    const char* name;
    double (*value)(const Neighbourhood&, int);
    double thesis[3];
  };
  const Method methods[] = {{"orthogonal polynomials", by_orthogonal_polynomials, {0.19, 0.47, 0.76}},
                            {"normal equations, conjugate gradients", by_conjugate_gradients, {0.43, 0.61, 0.82}},
                            {"normal equations, Gauss-Jordan", by_gauss_jordan, {0.76, 0.93, 1.83}},
                            {"QR", by_qr, {0.46, 1.15, 2.19}},
                            {"SVD", by_svd, {0.87, 2.84, 8.35}}};
  std::printf(
      "microseconds for one approximation of %zu samples in three variables, one thread; the thesis's in ms\n\n",
      neighbours);
  std::printf("| method | degree 2 | 3 | 4 | thesis: 2 | 3 | 4 | differs from QR by |\n");
  std::printf("|---|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const Method& method : methods) {
    double time[3], difference = 0;
    for (int degree = 2; degree <= 4; ++degree) {
      for (const Neighbourhood& hood : hoods)
        difference = std::max(difference, std::abs(method.value(hood, degree) - by_qr(hood, degree)));
      volatile double sink = 0;
      const double least = fastest_of(5, [&] {
                             for (std::size_t i = 0; i < fits; ++i)
                               sink = sink + method.value(hoods[i % hoods.size()], degree);
                           }).wall;
      time[degree - 2] = 1e6 * least / static_cast<double>(fits);
    }
    std::printf("| %s | %.1f | %.1f | %.1f | %.2f | %.2f | %.2f | %.0e |\n", method.name, time[0], time[1], time[2],
                method.thesis[0], method.thesis[1], method.thesis[2], difference);
    std::fflush(stdout);
  }
}
