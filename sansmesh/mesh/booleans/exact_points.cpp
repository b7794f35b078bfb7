#include "sansmesh/mesh/booleans/exact_points.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

/// Shewchuk's bound for the rounding error of det3 over the sum of magnitudes of its products (shewchuk1997).
constexpr double kDeterminantError = 7.8e-16, kTurnError = 3.4e-16;
/// Below this, underflow could matter.
constexpr double kLeastBound = 1e-280;

constexpr std::size_t next(int axis) { return static_cast<std::size_t>((axis + 1) % 3); }
constexpr std::size_t after_next(int axis) { return static_cast<std::size_t>((axis + 2) % 3); }

/// Vectors of exact numbers are passed by reference: copies of Dyadic allocate.
template <class N>
using Triple = std::array<N, 3>;

template <class N>
Triple<N> difference(const Triple<N>& a, const Triple<N>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class N>
Triple<N> sum(const Triple<N>& a, const Triple<N>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

template <class N>
Triple<N> scaled(const Triple<N>& a, const N& s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}

template <class N>
N product(const Triple<N>& a, const Triple<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class N>
Triple<N> outer(const Triple<N>& a, const Triple<N>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class N>
N turn_of(const Triple<N>& a, const Triple<N>& b, const Triple<N>& c, int axis) {
  const std::size_t i = next(axis), j = after_next(axis);
  return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
}

template <class N>
N side_of(const Triple<N>& a, const Triple<N>& b, const Triple<N>& c, const Triple<N>& d) {
  return product(outer(difference(b, a), difference(c, a)), difference(d, a));
}

}  // namespace

/// base + num / den.
template <class N>
struct ExactSpace::Quotient {
  Triple<N> base, num;
  N den;
};

template <class N>
std::array<N, 3> ExactSpace::position(std::uint32_t v) const {
  const Vec3& x = corners_[v];
  return {N(x.x), N(x.y), N(x.z)};
}

template <class N>
std::array<N, 3> ExactSpace::normal(const FacePlane& plane) const {
  const Triple<N> a = position<N>(plane.corner[0]), along = difference(position<N>(plane.corner[1]), a);
  if (plane.axis < 0) return outer(along, difference(position<N>(plane.corner[2]), a));
  Triple<N> direction{N(0), N(0), N(0)};
  direction[static_cast<std::size_t>(plane.axis)] = N(1);
  return outer(along, direction);
}

template <class N>
ExactSpace::Quotient<N> ExactSpace::quotient(const ExactPoint& point) const {
  if (point.kind == ExactPoint::Kind::crossing) {
    const Triple<N> a = position<N>(point.edge[0]), d = difference(position<N>(point.edge[1]), a);
    const Triple<N> n = normal<N>(point.planes[0]);
    return {a, scaled(d, product(n, difference(position<N>(point.planes[0].corner[0]), a))), product(n, d)};
  }
  const Triple<N> o = position<N>(point.planes[0].corner[0]);
  const Triple<N> n0 = normal<N>(point.planes[0]), n1 = normal<N>(point.planes[1]), n2 = normal<N>(point.planes[2]);
  const N d1 = product(n1, difference(position<N>(point.planes[1].corner[0]), o));
  const N d2 = product(n2, difference(position<N>(point.planes[2].corner[0]), o));
  return {o, sum(scaled(outer(n2, n0), d1), scaled(outer(n0, n1), d2)), product(n0, outer(n1, n2))};
}

void ExactSpace::complete(ExactPoint& point) const {
  const auto bounded = quotient<Bounded>(point);
  const auto modular = quotient<Residue>(point);
  const Residue inverse = Residue(1) / modular.den;
  for (std::size_t k = 0; k < 3; ++k) {
    point.at[k] = bounded.base[k] + bounded.num[k] / bounded.den;
    point.residue[k] = modular.base[k] + modular.num[k] * inverse;
  }
}

ExactPoint ExactSpace::corner(std::uint32_t v) const {
  ExactPoint point;
  point.edge = {v, v};
  for (std::size_t k = 0; k < 3; ++k) {
    point.at[k] = corners_[v][k];
    point.residue[k] = corners_[v][k];
  }
  return point;
}

ExactPoint ExactSpace::crossing(std::uint32_t a, std::uint32_t b, const FacePlane& plane) const {
  ExactPoint point;
  point.kind = ExactPoint::Kind::crossing;
  point.edge = {std::min(a, b), std::max(a, b)};
  point.planes[0] = plane;
  complete(point);
  return point;
}

ExactPoint ExactSpace::meeting(const FacePlane& p, const FacePlane& q, const FacePlane& r) const {
  ExactPoint point;
  point.kind = ExactPoint::Kind::meeting;
  point.planes = {p, q, r};
  complete(point);
  return point;
}

ExactMean ExactSpace::mean(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) const {
  ExactMean m;
  m.of = {&a, &b, &c};
  const Residue third = Residue(1) / Residue(3);
  for (std::size_t k = 0; k < 3; ++k) {
    m.at[k] = (a.at[k] + b.at[k] + c.at[k]) / Bounded(3);
    m.residue[k] = (a.residue[k] + b.residue[k] + c.residue[k]) * third;
  }
  return m;
}

ExactSpace::Homogeneous ExactSpace::homogeneous(std::uint32_t corner) const { return {position<Dyadic>(corner), 1.0}; }

ExactSpace::Homogeneous ExactSpace::homogeneous(const ExactPoint& point) const {
  if (point.kind == ExactPoint::Kind::corner) return homogeneous(point.edge[0]);
  const Quotient<Dyadic> q = quotient<Dyadic>(point);
  return {sum(scaled(q.base, q.den), q.num), q.den};
}

ExactSpace::Homogeneous ExactSpace::homogeneous(const ExactMean& point) const {
  const Homogeneous a = homogeneous(*point.of[0]), b = homogeneous(*point.of[1]), c = homogeneous(*point.of[2]);
  return {sum(sum(scaled(a.x, b.w * c.w), scaled(b.x, a.w * c.w)), scaled(c.x, a.w * b.w)),
          Dyadic(3) * a.w * b.w * c.w};
}

Vec3 ExactSpace::rounded(const ExactPoint& point) const {
  if (point.kind == ExactPoint::Kind::corner) return corners_[point.edge[0]];
  constexpr double kPrecise = 1e-12;
  Vec3 x = point.approximate();
  const double size = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  if (std::all_of(point.at.begin(), point.at.end(), [&](const Bounded& b) { return b.error <= kPrecise * size; }))
    return x;
  const Homogeneous exact = homogeneous(point);
  for (std::size_t k = 0; k < 3; ++k) x[k] = Dyadic::ratio(exact.x[k], exact.w);
  return x;
}

int ExactSpace::side(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
  const Vec3 p = corners_[b] - corners_[a], q = corners_[c] - corners_[a], r = corners_[d] - corners_[a];
  const double xy = p.x * q.y, yx = p.y * q.x, yz = p.y * q.z, zy = p.z * q.y, zx = p.z * q.x, xz = p.x * q.z;
  const double value = (yz - zy) * r.x + (zx - xz) * r.y + (xy - yx) * r.z;
  const double bound = kDeterminantError *
                       ((std::abs(yz) + std::abs(zy)) * std::abs(r.x) + (std::abs(zx) + std::abs(xz)) * std::abs(r.y) +
                        (std::abs(xy) + std::abs(yx)) * std::abs(r.z));
  if (std::abs(value) > bound + kLeastBound) return value > 0 ? 1 : -1;
  if (side_of(position<Residue>(a), position<Residue>(b), position<Residue>(c), position<Residue>(d)).zero()) return 0;
  return side_of(position<Dyadic>(a), position<Dyadic>(b), position<Dyadic>(c), position<Dyadic>(d)).sign();
}

int ExactSpace::side(std::uint32_t a, std::uint32_t b, std::uint32_t c, const ExactMean& p) const {
  const int known = side_of(position<Bounded>(a), position<Bounded>(b), position<Bounded>(c), p.at).sign();
  if (known != 0) return known;
  if (side_of(position<Residue>(a), position<Residue>(b), position<Residue>(c), p.residue).zero()) return 0;
  const Homogeneous h = homogeneous(p);
  const Triple<Dyadic> from = position<Dyadic>(a);
  const Triple<Dyadic> n = outer(difference(position<Dyadic>(b), from), difference(position<Dyadic>(c), from));
  return product(n, difference(h.x, scaled(from, h.w))).sign() * h.w.sign();
}

int ExactSpace::exact_turn(const Homogeneous& a, const Homogeneous& b, const Homogeneous& c, int axis) {
  const std::size_t i = next(axis), j = after_next(axis);
  // det of the rows (x_i, x_j, w).
  const Dyadic det = a.x[i] * (b.x[j] * c.w - b.w * c.x[j]) - a.x[j] * (b.x[i] * c.w - b.w * c.x[i]) +
                     a.w * (b.x[i] * c.x[j] - b.x[j] * c.x[i]);
  return det.sign() * a.w.sign() * b.w.sign() * c.w.sign();
}

int ExactSpace::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c, int axis) const {
  const std::size_t i = next(axis), j = after_next(axis);
  const Vec3 p = corners_[b] - corners_[a], q = corners_[c] - corners_[a];
  const double left = p[i] * q[j], right = p[j] * q[i], value = left - right;
  if (std::abs(value) > kTurnError * (std::abs(left) + std::abs(right)) + kLeastBound) return value > 0 ? 1 : -1;
  if (turn_of(position<Residue>(a), position<Residue>(b), position<Residue>(c), axis).zero()) return 0;
  return exact_turn(homogeneous(a), homogeneous(b), homogeneous(c), axis);
}

int ExactSpace::turn(std::uint32_t a, std::uint32_t b, const ExactMean& p, int axis) const {
  const int known = turn_of(position<Bounded>(a), position<Bounded>(b), p.at, axis).sign();
  if (known != 0) return known;
  if (turn_of(position<Residue>(a), position<Residue>(b), p.residue, axis).zero()) return 0;
  return exact_turn(homogeneous(a), homogeneous(b), homogeneous(p), axis);
}

int ExactSpace::turn(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, int axis) const {
  const int known = turn_of(a.at, b.at, c.at, axis).sign();
  if (known != 0) return known;
  if (turn_of(a.residue, b.residue, c.residue, axis).zero()) return 0;
  return exact_turn(homogeneous(a), homogeneous(b), homogeneous(c), axis);
}

int ExactSpace::main_axis(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const Vec3 n = cross(corners_[b] - corners_[a], corners_[c] - corners_[a]);
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return std::abs(n[static_cast<std::size_t>(i)]) > std::abs(n[static_cast<std::size_t>(j)]);
  });
  for (const int axis : order)
    if (turn(a, b, c, axis) != 0) return axis;
  return -1;
}

}  // namespace sansmesh::inline v1
