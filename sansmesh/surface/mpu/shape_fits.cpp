#include "sansmesh/surface/mpu/shape_fits.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

/// Ridge on the diagonal of a matrix with entries about 1, which sets undetermined coefficients to 0.
constexpr double kRidge = 1e-9;
/// Eigenvalues below this share of the largest one are treated as zero.
constexpr double kNothing = 1e-10;

template <int n>
using Square = Eigen::Matrix<double, n, n>;
template <int n>
using Column = Eigen::Matrix<double, n, 1>;

Column<10> general_basis(const Vec3& y) {
  Column<10> b;
  b << y.x * y.x, y.x * y.y, y.x * y.z, y.y * y.y, y.y * y.z, y.z * y.z, y.x, y.y, y.z, 1;
  return b;
}

}  // namespace

QuadricPiece height_quadric(const BallSamples& samples, const Vec3& up, int degree) {
  Vec3 across, along, middle;
  tangent_frame(up, across, along);
  double weight = 0;
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    weight += samples.weights[i];
    middle += samples.positions[i] * samples.weights[i];
  }
  middle = middle / weight;
  double spread = 0;
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    const Vec3 d = samples.positions[i] - middle;
    const double u = dot(d, across), v = dot(d, along);
    spread += samples.weights[i] * (u * u + v * v);
  }
  const double scale = std::sqrt(spread / weight);
  QuadricPiece q;
  q.b = up, q.c = -dot(up, middle);
  if (!(scale > 0)) return q;

  // 1, u, v, then u², 2uv, v², in units where the samples are about 1 from their mean.
  const int terms = degree < 1 ? 1 : degree < 2 ? 3 : 6;
  Square<6> matrix = Square<6>::Zero();
  Column<6> right = Column<6>::Zero();
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    const Vec3 d = (samples.positions[i] - middle) / scale;
    const double u = dot(d, across), v = dot(d, along), w = samples.weights[i] / weight;
    const double basis[6] = {1, u, v, u * u, 2 * u * v, v * v};
    for (int k = 0; k < terms; ++k) {
      right[k] += w * basis[k] * dot(d, up);
      for (int l = 0; l <= k; ++l) matrix(k, l) += w * basis[k] * basis[l];
    }
  }
  for (int k = terms; k < 6; ++k) matrix(k, k) = 1;
  for (int k = 1; k < terms; ++k) matrix(k, k) += kRidge;
  const Column<6> g = Eigen::LDLT<Square<6>, Eigen::Lower>(matrix).solve(right);
  if (!g.allFinite()) return q;
  // Heights and positions are in units of `scale`: w − g(u, v) times `scale` is a length.
  QuadricPiece local;
  local.b = up - across * g[1] - along * g[2];
  local.c = -scale * g[0];
  local.add_square(across, -g[3] / scale);
  local.add_product(across, along, -g[4] / scale);
  local.add_square(along, -g[5] / scale);
  return local.seen_from(-middle);
}

QuadricPiece general_quadric(const BallSamples& samples, std::span<const DistanceConstraint> constraints,
                             double radius) {
  double weight = 0;
  for (const double w : samples.weights) weight += w;
  Square<10> matrix = Square<10>::Zero();
  Column<10> right = Column<10>::Zero();
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    const Column<10> b = general_basis(samples.positions[i] / radius);
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(b, samples.weights[i] / weight);
  }
  const double share = 1 / static_cast<double>(std::max<std::size_t>(constraints.size(), 1));
  for (const DistanceConstraint& p : constraints) {
    const Column<10> b = general_basis(p.x / radius);
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(b, share);
    right += b * (share * p.distance / radius);
  }
  const Eigen::SelfAdjointEigenSolver<Square<10>> axes(matrix);
  const double least = kNothing * axes.eigenvalues()[9];
  Column<10> along = axes.eigenvectors().transpose() * right;
  for (int k = 0; k < 10; ++k) along[k] = axes.eigenvalues()[k] > least ? along[k] / axes.eigenvalues()[k] : 0;
  const Column<10> a = axes.eigenvectors() * along;
  QuadricPiece q;
  q.xx = a[0] / radius, q.yy = a[3] / radius, q.zz = a[5] / radius;
  q.xy = a[1] / (2 * radius), q.xz = a[2] / (2 * radius), q.yz = a[4] / (2 * radius);
  q.b = {a[6], a[7], a[8]};
  q.c = a[9] * radius;
  return q;
}

}  // namespace sansmesh::inline v1
