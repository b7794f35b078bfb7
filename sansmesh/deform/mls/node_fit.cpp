#include "sansmesh/deform/mls/node_fit.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "sansmesh/deform/mls/rotation_fit.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kDropped = 1e-20;  // squared relative norm below which a dependent polynomial is dropped

/// Weighted means relative to the heaviest node, which avoids cancellation if it is much heavier than the rest.
struct NodeMeans {
  Vec3 origin_q, origin_p;
  Vec3 q, p;  ///< relative to the origins
  double weight = 0;
  std::array<Vec3, 3> q_rate{}, p_rate{};  ///< derivative [k] with respect to x_k

  Vec3 hat_q(const WeightedNode& n) const { return n.q - origin_q - q; }
  Vec3 hat_p(const WeightedNode& n) const { return n.p - origin_p - p; }
};

NodeMeans means_of(const NodesFrom& from) {
  NodeMeans m;
  m.origin_q = from.nodes[from.heaviest].q, m.origin_p = from.nodes[from.heaviest].p;
  for (const WeightedNode& n : from.nodes) {
    m.weight += n.weight;
    m.q += (n.q - m.origin_q) * n.weight, m.p += (n.p - m.origin_p) * n.weight;
  }
  m.q = m.q / m.weight, m.p = m.p / m.weight;
  for (const WeightedNode& n : from.nodes) {
    const Vec3 q = m.hat_q(n), p = m.hat_p(n), slope = n.slope / m.weight;
    for (std::size_t k = 0; k < 3; ++k) m.q_rate[k] += q * slope[k], m.p_rate[k] += p * slope[k];
  }
  return m;
}

/// Polynomials orthonormal in the weighted inner product of the nodes, and orthogonal to constants. Columns hold the
/// values at the nodes, then at x, then the slopes at x.
FittedPosition fit_polynomials(const DeformSetup& setup, const NodesFrom& from, const NodeMeans& m, const Vec3& x,
                               bool jacobian, std::vector<double>& columns) {
  const std::size_t n = from.nodes.size(), terms = setup.terms.count, stride = n + 4;
  const double unit = 1 / setup.extent;
  columns.assign(stride * terms, 0);
  std::array<double, kMostMonomials> values{};
  std::array<Vec3, kMostMonomials> slopes{};
  for (std::size_t i = 0; i < n; ++i) {
    evaluate_terms(setup.terms, m.hat_q(from.nodes[i]) * unit, values.data(), nullptr);
    for (std::size_t j = 0; j < terms; ++j) columns[j * stride + i] = values[j];
  }
  evaluate_terms(setup.terms, (x - m.origin_q - m.q) * unit, values.data(), slopes.data());
  for (std::size_t j = 0; j < terms; ++j) {
    columns[j * stride + n] = values[j];
    for (std::size_t k = 0; k < 3; ++k) columns[j * stride + n + 1 + k] = slopes[j][k] * unit;
  }

  FittedPosition fit;
  Vec3 value;
  std::vector<Vec3> rest(n);
  for (std::size_t i = 0; i < n; ++i) rest[i] = m.hat_p(from.nodes[i]);
  for (std::size_t j = 0; j < terms; ++j) {
    double* const c = columns.data() + j * stride;
    const auto square = [&] {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += from.nodes[i].weight * c[i] * c[i];
      return sum;
    };
    const double before = square();
    for (int twice = 0; twice < 2; ++twice) {
      double mean = 0;
      for (std::size_t i = 0; i < n; ++i) mean += from.nodes[i].weight * c[i];
      mean /= m.weight;
      for (std::size_t i = 0; i <= n; ++i) c[i] -= mean;
      for (std::size_t l = 0; l < j; ++l) {
        const double* const other = columns.data() + l * stride;
        double share = 0;
        for (std::size_t i = 0; i < n; ++i) share += from.nodes[i].weight * c[i] * other[i];
        for (std::size_t i = 0; i < stride; ++i) c[i] -= share * other[i];
      }
    }
    const double left = square();
    const double scale = left > kDropped * before ? 1 / std::sqrt(left) : 0;
    for (std::size_t i = 0; i < stride; ++i) c[i] *= scale;
    Vec3 a;
    for (std::size_t i = 0; i < n; ++i) a += rest[i] * (from.nodes[i].weight * c[i]);
    for (std::size_t i = 0; i < n; ++i) rest[i] -= a * c[i];
    value += a * c[n];
    for (std::size_t k = 0; k < 3; ++k) fit.jacobian[k] += a * c[n + 1 + k];
  }
  fit.position = m.origin_p + (m.p + value);
  if (!jacobian) return fit;
  // Derivative with respect to the weights: Σ ∂w_i K(x, q_i) (p_i − P(q_i)), K the kernel of the orthonormal
  // polynomials.
  for (std::size_t i = 0; i < n; ++i) {
    double kernel = 1 / m.weight;
    for (std::size_t j = 0; j < terms; ++j) kernel += columns[j * stride + n] * columns[j * stride + i];
    for (std::size_t k = 0; k < 3; ++k) fit.jacobian[k] += rest[i] * (kernel * from.nodes[i].slope[k]);
  }
  return fit;
}

/// A rotation that depends on the weights, with its derivative.
struct NodeTurn {
  Rows3 b{};  ///< Σ w p qᵀ
  Rows3 r{};
  SmallestTurn line;
  double line_length = 0;  ///< length of the vector that defines one direction of the rotation
  HandleLine on = HandleLine::none;
  Vec3 line_direction;

  Vec3 turned(const Vec3& v) const {
    return on == HandleLine::none ? times(r, v) : on == HandleLine::point ? v : line(v);
  }
};

/// Σ w (component of one along the line) (the other).
Vec3 line_moment(const NodesFrom& from, const NodeMeans& m, const NodeTurn& t, int slope) {
  Vec3 sum;
  for (const WeightedNode& n : from.nodes) {
    const double w = slope < 0 ? n.weight : n.slope[static_cast<std::size_t>(slope)];
    const Vec3 q = m.hat_q(n), p = m.hat_p(n);
    sum += t.on == HandleLine::after ? p * (w * dot(q, t.line_direction)) : q * (w * dot(p, t.line_direction));
  }
  return sum;
}

NodeTurn turn_of(const DeformSetup& setup, const NodesFrom& from, const NodeMeans& m) {
  NodeTurn t;
  t.on = setup.line, t.line_direction = setup.line_direction;
  if (t.on == HandleLine::point) return t;
  if (t.on == HandleLine::none) {
    for (const WeightedNode& n : from.nodes) {
      const Vec3 q = m.hat_q(n) * n.weight, p = m.hat_p(n);
      for (std::size_t k = 0; k < 3; ++k) t.b[k] += q * p[k];
    }
    t.r = best_rotation(t.b);
    return t;
  }
  const Vec3 moment = line_moment(from, m, t, -1);
  t.line_length = norm(moment);
  const Vec3 other = t.line_length > 0 ? moment / t.line_length : t.line_direction;
  t.line = t.on == HandleLine::after ? SmallestTurn{t.line_direction, other} : SmallestTurn{other, t.line_direction};
  return t;
}

FittedPosition fit_turn(const DeformSetup& setup, const NodesFrom& from, const NodeMeans& m, const Vec3& x,
                        bool jacobian) {
  const NodeTurn turn = turn_of(setup, from, m);
  const Vec3 y = x - m.origin_q - m.q;
  const bool scaled = setup.options.kind == DeformationKind::similarity;
  double aligned = 0, spread = 0;
  if (scaled && turn.on != HandleLine::point) {
    for (const WeightedNode& n : from.nodes) {
      const Vec3 q = m.hat_q(n);
      aligned += n.weight * dot(m.hat_p(n), turn.turned(q)), spread += n.weight * squared_norm(q);
    }
  }
  const double scale = spread > 0 ? aligned / spread : 1;
  FittedPosition fit;
  const Vec3 turned = turn.turned(y);
  fit.position = m.origin_p + (m.p + turned * scale);
  if (!jacobian) return fit;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 unit;
    unit[k] = 1;
    Vec3 rate;
    if (turn.on == HandleLine::none) {
      Vec3 moment;
      for (const WeightedNode& n : from.nodes)
        moment += cross(m.hat_q(n), transposed_times(turn.r, m.hat_p(n))) * n.slope[k];
      rate = times(turn.r, cross(rotation_rate(turn.b, turn.r, moment), y));
    } else if (turn.on != HandleLine::point && turn.line_length > 0) {
      const Vec3 change = line_moment(from, m, turn, static_cast<int>(k));
      const Vec3 end = turn.on == HandleLine::after ? turn.line.b : turn.line.a;
      const Vec3 end_rate = (change - end * dot(end, change)) / turn.line_length;
      rate = turn.on == HandleLine::after ? turn.line.rate(y, {}, end_rate) : turn.line.rate(y, end_rate, {});
    }
    double scale_rate = 0;
    if (spread > 0) {
      for (const WeightedNode& n : from.nodes) {
        const Vec3 q = m.hat_q(n);
        scale_rate += n.slope[k] * (dot(m.hat_p(n), turn.turned(q)) - scale * squared_norm(q));
      }
      scale_rate /= spread;
    }
    fit.jacobian[k] = m.p_rate[k] + (rate + turn.turned(unit - m.q_rate[k])) * scale + turned * scale_rate;
  }
  return fit;
}

}  // namespace

FittedPosition fit_nodes(const DeformSetup& setup, const NodesFrom& from, const Vec3& x, bool jacobian,
                         std::vector<double>& scratch) {
  const NodeMeans means = means_of(from);
  if (setup.terms.count > 0) return fit_polynomials(setup, from, means, x, jacobian, scratch);
  return fit_turn(setup, from, means, x, jacobian);
}

}  // namespace sansmesh::inline v1::detail
