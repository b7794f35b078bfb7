#include "sansmesh/volume/cells/nodal_basis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMostAlong = HigherOrderKind::kMostOrder + 1;

/// Values and derivatives of functions of one coordinate.
struct LineFunctions {
  std::array<double, kMostAlong> value{}, slope{};
};

/// Polynomials of degree n that are 1 at one of the n + 1 nodes i / n.
LineFunctions between_nodes(std::size_t n, double t) {
  LineFunctions f;
  const auto order = static_cast<double>(n);
  for (std::size_t i = 0; i <= n; ++i) {
    double v = 1, d = 0;
    for (std::size_t m = 0; m <= n; ++m) {
      if (m == i) continue;
      const double part = 1 / (static_cast<double>(i) - static_cast<double>(m));
      const double factor = (order * t - static_cast<double>(m)) * part;
      d = d * factor + v * order * part;
      v *= factor;
    }
    f.value[i] = v, f.slope[i] = d;
  }
  return f;
}

/// Polynomials of degree i that are 0 at the nodes before i / n and 1 there.
LineFunctions up_to_node(std::size_t n, double t) {
  LineFunctions f;
  const auto order = static_cast<double>(n);
  f.value[0] = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const double part = 1 / static_cast<double>(i + 1), factor = (order * t - static_cast<double>(i)) * part;
    f.value[i + 1] = f.value[i] * factor;
    f.slope[i + 1] = f.slope[i] * factor + f.value[i] * order * part;
  }
  return f;
}

void evaluate_tetrahedron(std::size_t n, const Vec3& u, std::span<double> values, std::span<Vec3> slopes) {
  const LineFunctions r = up_to_node(n, u.x), s = up_to_node(n, u.y), t = up_to_node(n, u.z),
                      rest = up_to_node(n, 1 - u.x - u.y - u.z);
  std::size_t at = 0;
  for (std::size_t k = 0; k <= n; ++k)
    for (std::size_t j = 0; j + k <= n; ++j)
      for (std::size_t i = 0; i + j + k <= n; ++i, ++at) {
        const std::size_t l = n - i - j - k;
        const double st = s.value[j] * t.value[k], last = rest.value[l];
        values[at] = r.value[i] * st * last;
        if (slopes.empty()) continue;
        const double back = r.value[i] * st * rest.slope[l];
        slopes[at] = {r.slope[i] * st * last - back, r.value[i] * s.slope[j] * t.value[k] * last - back,
                      r.value[i] * s.value[j] * t.slope[k] * last - back};
      }
}

void evaluate_wedge(std::size_t n, std::size_t layers, const Vec3& u, std::span<double> values,
                    std::span<Vec3> slopes) {
  const LineFunctions r = up_to_node(n, u.x), s = up_to_node(n, u.y), rest = up_to_node(n, 1 - u.x - u.y),
                      t = between_nodes(layers, u.z);
  std::size_t at = 0;
  for (std::size_t k = 0; k <= layers; ++k)
    for (std::size_t j = 0; j <= n; ++j)
      for (std::size_t i = 0; i + j <= n; ++i, ++at) {
        const std::size_t l = n - i - j;
        const double flat = r.value[i] * s.value[j] * rest.value[l];
        values[at] = flat * t.value[k];
        if (slopes.empty()) continue;
        const double back = r.value[i] * s.value[j] * rest.slope[l];
        slopes[at] = {(r.slope[i] * s.value[j] * rest.value[l] - back) * t.value[k],
                      (r.value[i] * s.slope[j] * rest.value[l] - back) * t.value[k], flat * t.slope[k]};
      }
}

void evaluate_hexahedron(const std::array<std::uint8_t, 3>& n, const Vec3& u, std::span<double> values,
                         std::span<Vec3> slopes) {
  const LineFunctions r = between_nodes(n[0], u.x), s = between_nodes(n[1], u.y), t = between_nodes(n[2], u.z);
  std::size_t at = 0;
  for (std::size_t k = 0; k <= n[2]; ++k)
    for (std::size_t j = 0; j <= n[1]; ++j)
      for (std::size_t i = 0; i <= n[0]; ++i, ++at) {
        values[at] = r.value[i] * s.value[j] * t.value[k];
        if (slopes.empty()) continue;
        slopes[at] = {r.slope[i] * s.value[j] * t.value[k], r.value[i] * s.slope[j] * t.value[k],
                      r.value[i] * s.value[j] * t.slope[k]};
      }
}

/// The general evaluation takes four times as long, in the most frequent of these cells.
void evaluate_hexahedron_20(std::span<const Vec3> nodes, const Vec3& u, std::span<double> values,
                            std::span<Vec3> slopes) {
  const Vec3 x = u * 2.0 - Vec3{1, 1, 1};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vec3 side = nodes[i] * 2.0 - Vec3{1, 1, 1};  // −1 or 1; 0 along the edge of a node
    const Vec3 f{1 + x.x * side.x, 1 + x.y * side.y, 1 + x.z * side.z};
    if (i < 8) {
      const double rest = f.x + f.y + f.z - 5;
      values[i] = 0.125 * f.x * f.y * f.z * rest;
      if (!slopes.empty())
        slopes[i] = {0.25 * side.x * f.y * f.z * (rest + f.x), 0.25 * side.y * f.x * f.z * (rest + f.y),
                     0.25 * side.z * f.x * f.y * (rest + f.z)};
      continue;
    }
    const std::size_t along = side.x == 0 ? 0 : side.y == 0 ? 1 : 2, a = (along + 1) % 3, b = (along + 2) % 3;
    const double bubble = 1 - x[along] * x[along];
    values[i] = 0.25 * bubble * f[a] * f[b];
    if (slopes.empty()) continue;
    slopes[i][along] = -x[along] * f[a] * f[b];
    slopes[i][a] = 0.5 * bubble * side[a] * f[b], slopes[i][b] = 0.5 * bubble * side[b] * f[a];
  }
}

std::vector<Vec3> corners_of_family(HigherOrderFamily family) {
  if (family == HigherOrderFamily::pyramid_13)
    return {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}, {0, 0, 1}};
  if (family == HigherOrderFamily::wedge_15) return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
}

CellShape shape_of_family(HigherOrderFamily family) {
  if (family == HigherOrderFamily::pyramid_13) return CellShape::pyramid;
  return family == HigherOrderFamily::wedge_15 ? CellShape::wedge : CellShape::hexahedron;
}

}  // namespace

NodalBasis::NodalBasis(const HigherOrderKind& kind) : kind_(kind) {
  if (node_count(kind) == 0) throw DataError("a cell of higher order has an impossible order");
  place_nodes();
  terms_ = terms_of(kind.family);
  if (!terms_.empty()) solve();
}

void NodalBasis::place_nodes() {
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
    nodes_.push_back({static_cast<double>(i) / kind_.orders[0], static_cast<double>(j) / kind_.orders[1],
                      static_cast<double>(k) / kind_.orders[2]});
  };
  const std::size_t n = kind_.orders[0];
  switch (kind_.family) {
    case HigherOrderFamily::tetrahedron:
      for (std::size_t k = 0; k <= n; ++k)
        for (std::size_t j = 0; j + k <= n; ++j)
          for (std::size_t i = 0; i + j + k <= n; ++i)
            nodes_.push_back(Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} /
                             static_cast<double>(n));
      return;
    case HigherOrderFamily::wedge:
      for (std::size_t k = 0; k <= kind_.orders[2]; ++k)
        for (std::size_t j = 0; j <= n; ++j)
          for (std::size_t i = 0; i + j <= n; ++i)
            nodes_.push_back({static_cast<double>(i) / static_cast<double>(n),
                              static_cast<double>(j) / static_cast<double>(n),
                              static_cast<double>(k) / static_cast<double>(kind_.orders[2])});
      return;
    case HigherOrderFamily::hexahedron:
      for (std::size_t k = 0; k <= kind_.orders[2]; ++k)
        for (std::size_t j = 0; j <= kind_.orders[1]; ++j)
          for (std::size_t i = 0; i <= n; ++i) at(i, j, k);
      return;
    default:
      break;
  }
  nodes_ = corners_of_family(kind_.family);
  for (const auto& edge : cell_edges(shape_of_family(kind_.family)))
    nodes_.push_back((nodes_[edge[0]] + nodes_[edge[1]]) / 2);
  if (kind_.family == HigherOrderFamily::hexahedron_24)
    nodes_.insert(nodes_.end(), {{0, 0.5, 0.5}, {1, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 1, 0.5}});
}

std::vector<NodalBasis::Term> NodalBasis::terms_of(HigherOrderFamily family) {
  std::vector<Term> terms;
  switch (family) {
    case HigherOrderFamily::hexahedron_24:
      // At most one of r and s is squared; times any power of t.
      for (int c = 0; c < 3; ++c)
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a)
            if (a + b < 4) terms.push_back({a, b, c, false});
      break;
    case HigherOrderFamily::wedge_15:
      for (int c = 0; c < 3; ++c)
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a + b < (c < 2 ? 3 : 2); ++a) terms.push_back({a, b, c, false});
      break;
    case HigherOrderFamily::pyramid_13:
      for (int c = 0; c < 3; ++c)
        for (int b = 0; b + c < 3; ++b)
          for (int a = 0; a + b + c < 3; ++a) terms.push_back({a, b, c, false});
      terms.push_back({2, 1, 0, true}), terms.push_back({1, 2, 0, true}), terms.push_back({1, 1, 0, true});
      break;
    default:
      break;
  }
  return terms;
}

void NodalBasis::evaluate_term(const Term& term, const Vec3& u, double& value, Vec3& slope) {
  const auto power = [](double x, int p) { return p == 0 ? 1.0 : p == 1 ? x : x * x; };
  const auto rise = [](double x, int p) { return p == 0 ? 0.0 : p == 1 ? 1.0 : 2 * x; };
  const double r = power(u.x, term.r), s = power(u.y, term.s), t = power(u.z, term.t);
  value = r * s * t;
  slope = {rise(u.x, term.r) * s * t, r * rise(u.y, term.s) * t, r * s * rise(u.z, term.t)};
  if (!term.over) return;
  // Bounded in the pyramid, also at its tip.
  const double under = 1 - u.z, inverse = 1 / (std::abs(under) > 1e-9 ? under : 1e-9);
  value *= inverse;
  slope *= inverse;
  slope.z += value * inverse;
}

void NodalBasis::solve() {
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  Eigen::MatrixXd at(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k) {
      Vec3 slope;
      evaluate_term(terms_[static_cast<std::size_t>(k)], nodes_[static_cast<std::size_t>(i)], at(i, k), slope);
    }
  const Eigen::MatrixXd inverse = at.fullPivLu().inverse();  // row: term, column: node
  coefficients_.resize(nodes_.size() * nodes_.size());
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index i = 0; i < n; ++i) {
      // Coefficients are whole multiples of 1/16: rounding errors vanish.
      const double c = std::round(inverse(k, i) * 4096) / 4096;
      coefficients_[static_cast<std::size_t>(k * n + i)] = std::abs(c - inverse(k, i)) < 1e-9 ? c : inverse(k, i);
    }
}

void NodalBasis::evaluate(const Vec3& u, std::span<double> values, std::span<Vec3> slopes) const {
  switch (kind_.family) {
    case HigherOrderFamily::tetrahedron:
      return evaluate_tetrahedron(kind_.orders[0], u, values, slopes);
    case HigherOrderFamily::wedge:
      return evaluate_wedge(kind_.orders[0], kind_.orders[2], u, values, slopes);
    case HigherOrderFamily::hexahedron:
      return evaluate_hexahedron(kind_.orders, u, values, slopes);
    case HigherOrderFamily::hexahedron_20:
      return evaluate_hexahedron_20(nodes_, u, values, slopes);
    default:
      break;
  }
  const std::size_t n = nodes_.size();
  std::fill_n(values.begin(), n, 0.0);
  if (!slopes.empty()) std::fill_n(slopes.begin(), n, Vec3{});
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    double value = 0;
    Vec3 slope;
    evaluate_term(terms_[k], u, value, slope);
    const double* const row = coefficients_.data() + k * n;
    for (std::size_t i = 0; i < n; ++i) values[i] += row[i] * value;
    if (slopes.empty()) continue;
    for (std::size_t i = 0; i < n; ++i) slopes[i] += slope * row[i];
  }
}

bool NodalBasis::within(const Vec3& u, double margin) const {
  const auto between = [&](double x) { return x >= -margin && x <= 1 + margin; };
  switch (kind_.family) {
    case HigherOrderFamily::tetrahedron:
      return u.x >= -margin && u.y >= -margin && u.z >= -margin && u.x + u.y + u.z <= 1 + margin;
    case HigherOrderFamily::wedge:
    case HigherOrderFamily::wedge_15:
      return u.x >= -margin && u.y >= -margin && u.x + u.y <= 1 + margin && between(u.z);
    case HigherOrderFamily::pyramid_13:
      return between(u.z) && std::max(std::abs(u.x), std::abs(u.y)) <= (1 - u.z) / 2 + margin;
    default:
      return between(u.x) && between(u.y) && between(u.z);
  }
}

Vec3 NodalBasis::middle() const {
  switch (kind_.family) {
    case HigherOrderFamily::tetrahedron:
      return {0.25, 0.25, 0.25};
    case HigherOrderFamily::wedge:
    case HigherOrderFamily::wedge_15:
      return {1.0 / 3, 1.0 / 3, 0.5};
    case HigherOrderFamily::pyramid_13:
      return {0, 0, 0.25};
    default:
      return {0.5, 0.5, 0.5};
  }
}

}  // namespace sansmesh::inline v1
