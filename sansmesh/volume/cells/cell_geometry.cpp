#include "sansmesh/volume/cells/cell_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/matrix3.h"

namespace sansmesh::inline v1 {
namespace {

/// A cell as a hexahedron with coincident corners: the cell corner at each of the eight.
std::span<const std::uint8_t, 8> cube_corners(CellShape shape) {
  static constexpr std::uint8_t kCube[4][8] = {
      {0, 1, 2, 2, 3, 3, 3, 3}, {0, 1, 2, 3, 4, 4, 4, 4}, {0, 1, 2, 2, 3, 4, 5, 5}, {0, 1, 2, 3, 4, 5, 6, 7}};
  return kCube[static_cast<std::size_t>(shape)];
}

void cube_functions(const Vec3& u, std::span<double, 8> w) {
  const double r = u.x, s = u.y, t = u.z, p = 1 - r, q = 1 - s, o = 1 - t;
  w[0] = p * q * o, w[1] = r * q * o, w[2] = r * s * o, w[3] = p * s * o;
  w[4] = p * q * t, w[5] = r * q * t, w[6] = r * s * t, w[7] = p * s * t;
}

void cube_derivatives(const Vec3& u, std::span<Vec3, 8> d) {
  const double r = u.x, s = u.y, t = u.z, p = 1 - r, q = 1 - s, o = 1 - t;
  d[0] = {-q * o, -p * o, -p * q}, d[1] = {q * o, -r * o, -r * q};
  d[2] = {s * o, r * o, -r * s}, d[3] = {-s * o, p * o, -p * s};
  d[4] = {-q * t, -p * t, p * q}, d[5] = {q * t, -r * t, r * q};
  d[6] = {s * t, r * t, r * s}, d[7] = {-s * t, p * t, p * s};
}

/// Levenberg–Marquardt minimisation of the squared distance in the cube [0, 1]³; parameters at active bounds are fixed.
double descend(std::span<const Vec3, 8> x, Vec3& u) {
  std::array<double, 8> w;
  std::array<Vec3, 8> d;
  const auto point_at = [&](const Vec3& v) {
    cube_functions(v, w);
    Vec3 sum;
    for (std::size_t c = 0; c < 8; ++c) sum += x[c] * w[c];
    return sum;
  };
  Vec3 at = point_at(u);
  double best = squared_norm(at), damping = 1e-6;
  for (int step = 0; step < 40; ++step) {
    cube_derivatives(u, d);
    Vec3 j[3];
    for (std::size_t c = 0; c < 8; ++c)
      for (std::size_t k = 0; k < 3; ++k) j[k] += x[c] * d[c][k];
    bool free[3];
    double h[3][3], g[3], largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      g[k] = dot(j[k], at);
      free[k] = !((u[k] <= 0 && g[k] > 0) || (u[k] >= 1 && g[k] < 0));
      for (std::size_t l = 0; l < 3; ++l) h[k][l] = dot(j[k], j[l]);
      largest = std::max(largest, h[k][k]);
    }
    if (!(largest > 0)) break;
    bool better = false;
    for (int attempt = 0; attempt < 8 && !better; ++attempt) {
      Matrix3 m{{}, {}, {}};
      Vec3 right;
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3& column = k == 0 ? m.a : k == 1 ? m.b : m.c;
        for (std::size_t l = 0; l < 3; ++l) column[l] = free[k] && free[l] ? h[k][l] : 0;
        // Relative to the size of each parameter, so that thin cells are crossed as fast as traversed lengthwise.
        column[k] = free[k] ? h[k][k] * (1 + damping) + 1e-30 * largest : 1;
        right[k] = free[k] ? -g[k] : 0;
      }
      const Vec3 move = m.solve(right);
      if (!is_finite(move)) {
        damping = std::max(damping * 10, 1e-3);
        continue;
      }
      Vec3 next;
      for (std::size_t k = 0; k < 3; ++k) next[k] = std::clamp(u[k] + move[k], 0.0, 1.0);
      const Vec3 there = point_at(next);
      const double distance = squared_norm(there);
      if (distance < best) {
        better = best - distance > 1e-14 * best;
        u = next, at = there, best = distance, damping *= 0.1;
        if (!better) return best;
      } else {
        damping = std::max(damping * 10, 1e-3);
      }
    }
    if (!better) break;
  }
  return best;
}

/// Newton's method from u: it follows the curved valleys of thin, warped cells, where descent takes small steps. Moves
/// u to a point of the cube that maps to the origin, if found.
void polish(std::span<const Vec3, 8> x, Vec3& u, double& distance) {
  std::array<double, 8> w;
  std::array<Vec3, 8> d;
  Vec3 v = u;
  for (int step = 0; step < 12; ++step) {
    cube_functions(v, w);
    cube_derivatives(v, d);
    Vec3 at, j[3];
    for (std::size_t c = 0; c < 8; ++c) {
      at += x[c] * w[c];
      for (std::size_t k = 0; k < 3; ++k) j[k] += x[c] * d[c][k];
    }
    if (squared_norm(at) < distance && parameters_within(CellShape::hexahedron, v, 0))
      u = v, distance = squared_norm(at);
    v -= Matrix3{j[0], j[1], j[2]}.solve(at);
    if (!is_finite(v) || !parameters_within(CellShape::hexahedron, v, -1)) return;
  }
}

double tetrahedron_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(cross(b - a, c - a), d - a) / 6;
}

}  // namespace

CellMap::CellMap(CellShape shape, std::span<const Vec3> x) : shape_(shape) {
  a_[0] = x[0], a_[1] = x[1] - x[0];
  switch (shape) {
    case CellShape::tetrahedron:
      a_[2] = x[2] - x[0], a_[3] = x[3] - x[0];
      break;
    case CellShape::wedge:
      a_[2] = x[2] - x[0], a_[3] = x[3] - x[0];
      a_[5] = x[0] - x[2] - x[3] + x[5], a_[6] = x[0] - x[1] - x[3] + x[4];
      break;
    case CellShape::pyramid:
      a_[2] = x[3] - x[0], a_[3] = x[4] - x[0];
      a_[4] = x[0] - x[1] + x[2] - x[3], a_[5] = x[0] - x[3], a_[6] = x[0] - x[1], a_[7] = -a_[4];
      break;
    case CellShape::hexahedron:
      a_[2] = x[3] - x[0], a_[3] = x[4] - x[0];
      a_[4] = x[0] - x[1] + x[2] - x[3], a_[5] = x[0] - x[3] - x[4] + x[7], a_[6] = x[0] - x[1] - x[4] + x[5];
      a_[7] = (x[4] - x[5] + x[6] - x[7]) - a_[4];
      break;
  }
}

std::array<Vec3, 3> CellMap::derivatives(const Vec3& u) const {
  if (shape_ == CellShape::tetrahedron) return {a_[1], a_[2], a_[3]};
  const Vec3 rt = a_[6] + a_[7] * u.y;
  return {a_[1] + a_[4] * u.y + rt * u.z, a_[2] + a_[4] * u.x + (a_[5] + a_[7] * u.x) * u.z,
          a_[3] + a_[5] * u.y + rt * u.x};
}

bool CellMap::invert(Vec3& u) const {
  if (shape_ == CellShape::tetrahedron) {
    u = Matrix3{a_[1], a_[2], a_[3]}.solve(-a_[0]);
    return is_finite(u);
  }
  u = shape_ == CellShape::wedge ? Vec3{1.0 / 3, 1.0 / 3, 0.5} : Vec3{0.5, 0.5, 0.5};
  return newton({}, u);
}

bool CellMap::newton(const Vec3& x, Vec3& u) const {
  constexpr double kFar = 1;  // beyond the cube: convergence into the cell is excluded
  int far = 0;
  if (!is_finite(u)) return false;
  for (int step = 0; step < 16; ++step) {
    bool out = false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (u[k] < -kFar || u[k] > 1 + kFar) out = true;
      u[k] = std::clamp(u[k], -kFar, 1 + kFar);
    }
    if (out && ++far == 3) return false;
    const auto d = derivatives(u);
    const Vec3 move = Matrix3{d[0], d[1], d[2]}.solve(at(u) - x);
    if (!is_finite(move)) return false;
    u -= move;
    if (std::max({std::abs(move.x), std::abs(move.y), std::abs(move.z)}) < 1e-7) return true;  // errors are squared
  }
  return false;
}

bool is_folded(CellShape shape, std::span<const Vec3> corners) {
  if (shape == CellShape::tetrahedron) return false;
  const CellMap map(shape, corners);
  for (int c = 0; c < 8; ++c) {
    Vec3 u{static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1), static_cast<double>(c >> 2)};
    if (shape == CellShape::wedge && c % 4 == 3) continue;
    if (shape == CellShape::pyramid) u.z *= 0.5;  // the tip has no volume
    const auto d = map.derivatives(u);
    // VTK's wedges are left-handed.
    const double volume = dot(d[0], cross(d[1], d[2])) * (shape == CellShape::wedge ? -1 : 1);
    if (!(volume > 0)) return true;
  }
  return false;
}

Vec3 clamped_parameters(CellShape shape, const Vec3& u) {
  const auto unit = [](double v) { return std::clamp(v, 0.0, 1.0); };
  if (shape == CellShape::hexahedron || shape == CellShape::pyramid) return {unit(u.x), unit(u.y), unit(u.z)};
  if (shape == CellShape::wedge) {
    double r = std::max(u.x, 0.0), s = std::max(u.y, 0.0);
    if (r + s > 1) {
      r = unit((u.x - u.y + 1) / 2);
      s = 1 - r;
    }
    return {r, s, unit(u.z)};
  }
  Vec3 v{std::max(u.x, 0.0), std::max(u.y, 0.0), std::max(u.z, 0.0)};
  const double sum = v.x + v.y + v.z;
  return sum > 1 ? v / sum : v;
}

bool parameters_within(CellShape shape, const Vec3& u, double margin) {
  if (!(u.x >= margin && u.y >= margin && u.z >= margin)) return false;
  switch (shape) {
    case CellShape::tetrahedron:
      return u.x + u.y + u.z <= 1 - margin;
    case CellShape::wedge:
      return u.x + u.y <= 1 - margin && u.z <= 1 - margin;
    case CellShape::pyramid:
    case CellShape::hexahedron:
      break;
  }
  return u.x <= 1 - margin && u.y <= 1 - margin && u.z <= 1 - margin;
}

void shape_functions(CellShape shape, const Vec3& u, std::span<double> w) {
  const double r = u.x, s = u.y, t = u.z;
  switch (shape) {
    case CellShape::tetrahedron:
      w[0] = 1 - r - s - t, w[1] = r, w[2] = s, w[3] = t;
      return;
    case CellShape::pyramid:
      w[0] = (1 - r) * (1 - s) * (1 - t), w[1] = r * (1 - s) * (1 - t), w[2] = r * s * (1 - t);
      w[3] = (1 - r) * s * (1 - t), w[4] = t;
      return;
    case CellShape::wedge:
      w[0] = (1 - r - s) * (1 - t), w[1] = r * (1 - t), w[2] = s * (1 - t);
      w[3] = (1 - r - s) * t, w[4] = r * t, w[5] = s * t;
      return;
    case CellShape::hexahedron:
      cube_functions(u, w.first<8>());
  }
}

void shape_derivatives(CellShape shape, const Vec3& u, std::span<Vec3> d) {
  const double r = u.x, s = u.y, t = u.z;
  switch (shape) {
    case CellShape::tetrahedron:
      d[0] = {-1, -1, -1}, d[1] = {1, 0, 0}, d[2] = {0, 1, 0}, d[3] = {0, 0, 1};
      return;
    case CellShape::pyramid: {
      std::array<Vec3, 8> cube;
      cube_derivatives(u, cube);
      for (std::size_t c = 0; c < 4; ++c) d[c] = cube[c];
      d[4] = {0, 0, 1};
      return;
    }
    case CellShape::wedge:
      d[0] = {t - 1, t - 1, r + s - 1}, d[1] = {1 - t, 0, -r}, d[2] = {0, 1 - t, -s};
      d[3] = {-t, -t, 1 - r - s}, d[4] = {t, 0, r}, d[5] = {0, t, s};
      return;
    case CellShape::hexahedron:
      cube_derivatives(u, d.first<8>());
  }
}

Vec3 parameters_of(CellShape shape, std::span<const double> w) {
  switch (shape) {
    case CellShape::tetrahedron:
      return {w[1], w[2], w[3]};
    case CellShape::pyramid: {
      const double o = 1 - w[4];
      return o > 0 ? Vec3{(w[1] + w[2]) / o, (w[2] + w[3]) / o, w[4]} : Vec3{0.5, 0.5, 1};
    }
    case CellShape::wedge:
      return {w[1] + w[4], w[2] + w[5], w[3] + w[4] + w[5]};
    case CellShape::hexahedron:
      break;
  }
  return {w[1] + w[2] + w[5] + w[6], w[2] + w[3] + w[6] + w[7], w[4] + w[5] + w[6] + w[7]};
}

double nearest_in_cell(CellShape shape, std::span<const Vec3> corners, std::span<double> weights) {
  const CellMap map(shape, corners);
  if (Vec3 in; map.invert(in) && parameters_within(shape, in, 0)) {
    shape_functions(shape, in, weights);
    return squared_norm(map.at(in));
  }
  const auto cube = cube_corners(shape);
  std::array<Vec3, 8> x;
  for (std::size_t c = 0; c < 8; ++c) x[c] = corners[cube[c]];
  // From 27 starting points in the cell: Newton's method from all, since some converge outside the cell, and descent
  // from the two best.
  struct Start {
    double distance = std::numeric_limits<double>::max();
    Vec3 u;
  } first, second;
  std::array<double, 8> w;
  Vec3 u;
  double best = std::numeric_limits<double>::max();
  for (int i = 0; i < 27; ++i) {
    const int r = i % 3, t = i / 9, row = i / 3 % 3;
    Vec3 start{0.1 + 0.4 * r, 0.1 + 0.4 * row, 0.1 + 0.4 * t};
    cube_functions(start, w);
    Vec3 at;
    for (std::size_t c = 0; c < 8; ++c) at += x[c] * w[c];
    double distance = squared_norm(at);
    if (distance < first.distance)
      second = first, first = {distance, start};
    else if (distance < second.distance)
      second = {distance, start};
    polish(x, start, distance);
    if (distance < best) best = distance, u = start;
  }
  for (Start* start : {&first, &second}) {
    double distance = descend(x, start->u);
    polish(x, start->u, distance);
    if (distance < best) best = distance, u = start->u;
  }
  cube_functions(u, w);
  std::fill(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(corner_count(shape)), 0.0);
  for (std::size_t c = 0; c < 8; ++c) weights[cube[c]] += w[c];
  return best;
}

double nearest_on_face(std::span<const Vec3> ring, std::span<double> weights) {
  const Vec3 &a = ring[0], &b = ring[1], &c = ring[2], &d = ring[ring.size() - 1];
  const std::array<Vec3, 8> x{a, b, c, d, a, b, c, d};  // flat: independent of t
  std::array<double, 8> w;
  double least = std::numeric_limits<double>::max();
  Vec3 u;
  for (int i = 0; i < 9; ++i) {
    const int r = i % 3, row = i / 3;
    const Vec3 start{0.1 + 0.4 * r, 0.1 + 0.4 * row, 0.5};
    cube_functions(start, w);
    Vec3 at;
    for (std::size_t k = 0; k < 8; ++k) at += x[k] * w[k];
    if (squared_norm(at) < least) least = squared_norm(at), u = start;
  }
  const double distance = descend(x, u);
  cube_functions(u, w);
  std::fill(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(ring.size()), 0.0);
  for (std::size_t k = 0; k < 4; ++k) weights[std::min(k, ring.size() - 1)] += w[k] + w[k + 4];
  return distance;
}

double cell_volume(CellShape shape, std::span<const Vec3> x) {
  if (shape == CellShape::tetrahedron) return tetrahedron_volume(x[0], x[1], x[2], x[3]);
  // Cones from corner 0 over the faces. Quadrilaterals use the mean of both subdivisions, which is exact for bilinear
  // faces.
  double sum = 0;
  for (const CellFace& face : cell_faces(shape)) {
    const Vec3 &a = x[face.corner[0]], &b = x[face.corner[1]], &c = x[face.corner[2]];
    const auto cone = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
      return dot(cross(q - p, r - p), p - x[0]) / 6;
    };
    if (face.count == 3) {
      sum += cone(a, b, c);
    } else {
      const Vec3& d = x[face.corner[3]];
      sum += (cone(a, b, c) + cone(a, c, d) + cone(b, c, d) + cone(b, d, a)) / 2;
    }
  }
  return sum;
}

EdgeRange squared_edges(CellShape shape, std::span<const Vec3> corners) {
  EdgeRange range{std::numeric_limits<double>::max(), 0};
  for (const auto& edge : cell_edges(shape)) {
    const double length = squared_norm(corners[edge[1]] - corners[edge[0]]);
    range.shortest = std::min(range.shortest, length);
    range.longest = std::max(range.longest, length);
  }
  return range;
}

}  // namespace sansmesh::inline v1
