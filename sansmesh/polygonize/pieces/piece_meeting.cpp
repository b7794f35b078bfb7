#include "sansmesh/polygonize/pieces/piece_meeting.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostSteps = 12;
constexpr double kConverged = 1e-10;  // last step over the reach
constexpr double kResidual = 1e-4;    // distance from each piece over the reach; tolerates noisy fields
constexpr double kOffSurface = 1e-3;  // |F| over the reach above which another piece has cut the crease away
constexpr double kStep = 0.01;        // distance at which surroundings are probed, over the reach

/// The shortest d with g[i] · d = r[i] for i < n; false if the g are not independent.
bool shortest_step(const std::array<Vec3, 3>& g, const std::array<double, 3>& r, std::uint32_t n, Vec3& d) {
  if (n == 1) {
    const double s = squared_norm(g[0]);
    if (!(s > 1e-8)) return false;
    d = g[0] * (r[0] / s);
    return true;
  }
  if (n == 2) {
    const double aa = squared_norm(g[0]), bb = squared_norm(g[1]), ab = dot(g[0], g[1]), det = aa * bb - ab * ab;
    if (!(det > 1e-6 * aa * bb) || !(aa * bb > 1e-16)) return false;
    d = g[0] * ((r[0] * bb - r[1] * ab) / det) + g[1] * ((r[1] * aa - r[0] * ab) / det);
    return true;
  }
  const Matrix3 m{g[0], g[1], g[2]};
  const double det = m.determinant();
  if (!(std::abs(det) > 1e-4 * norm(g[0]) * norm(g[1]) * norm(g[2])) || det == 0) return false;
  d = m.solve_transposed({r[0], r[1], r[2]});
  return true;
}

bool independent(const std::array<Vec3, 3>& n, std::uint32_t count) {
  if (count == 2) return squared_norm(cross(n[0], n[1])) > kTangentSine * kTangentSine;
  if (count == 3) return std::abs(Matrix3{n[0], n[1], n[2]}.determinant()) > kFlatCorner;
  return true;
}

/// Whether the result is part of the zero set. The field must vanish there; near a crease also slightly farther along
/// each of its two pieces, on one side; near a corner also along creases of all three pieces. This fails where another
/// piece cuts the crease away, or where a piece that takes no part happens to vanish.
void check_surface(const PiecewiseField& field, std::span<Meeting> all) {
  std::vector<Vec3> x;
  std::vector<double> step;
  const auto ask = [&](const Vec3& p, double s) {
    x.push_back(p);
    step.push_back(s);
  };
  for (const Meeting& m : all) {
    if (!m.found) continue;
    ask(m.x, 0);
    const double s = kStep * m.reach;
    const auto both_ways = [&](const Vec3& d) {
      ask(m.x + normalized(d) * s, s);
      ask(m.x - normalized(d) * s, s);
    };
    if (m.count == 2) {
      const Vec3 along = cross(m.normal[0], m.normal[1]);
      both_ways(cross(m.normal[0], along));
      both_ways(cross(m.normal[1], along));
    } else if (m.count == 3) {
      for (std::size_t k = 0; k < 3; ++k) both_ways(cross(m.normal[k], m.normal[(k + 1) % 3]));
    }
  }
  std::vector<double> f(x.size());
  field.evaluate(x, f);
  std::size_t q = 0;
  for (Meeting& m : all) {
    if (!m.found) continue;
    m.found = std::abs(f[q++]) <= kOffSurface * m.reach;
    if (m.count == 1) continue;
    std::array<bool, 3> there{};
    for (std::size_t k = 0; k < (m.count == 2 ? 2u : 3u); ++k, q += 2) {
      // A piece that leaves the surface diverges at least at the angle between the pieces.
      const double angle = norm(cross(m.normal[k], m.normal[m.count == 2 ? 1 - k : (k + 1) % 3]));
      const double most = (m.count == 2 ? 0.3 * angle : 0.02) * step[q];
      there[k] = std::min(std::abs(f[q]), std::abs(f[q + 1])) <= most;
    }
    m.found = m.found && (m.count == 2 ? there[0] && there[1] : there[0] + there[1] + there[2] >= 2);
  }
}

}  // namespace

bool PieceSet::has(std::uint32_t p) const { return std::find(begin(), end(), p) != end(); }

bool PieceSet::add(std::uint32_t p) {
  const auto at = static_cast<std::size_t>(std::lower_bound(begin(), end(), p) - begin());
  if (at < count && piece[at] == p) return true;
  if (count == kMost) return false;
  std::copy_backward(piece.begin() + at, piece.begin() + count, piece.begin() + count + 1);
  piece[at] = p;
  ++count;
  return true;
}

PieceSet common(const PieceSet& a, const PieceSet& b) {
  PieceSet both;
  for (const std::uint32_t p : a)
    if (b.has(p)) both.piece[both.count++] = p;
  return both;
}

void evaluate_pieces(const PiecewiseField& field, std::span<PieceValue> all) {
  std::vector<std::uint64_t> order(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) order[i] = std::uint64_t{all[i].piece} << 32 | i;
  parallel_sort(order);
  std::vector<Vec3> x(all.size()), gradient(all.size());
  std::vector<double> value(all.size());
  const auto index = [&](std::size_t i) { return static_cast<std::size_t>(order[i] & 0xffffffffUL); };
  for (std::size_t i = 0; i < all.size(); ++i) x[i] = all[index(i)].x;
  for (std::size_t i = 0, j; i < all.size(); i = j) {
    const auto piece = static_cast<std::uint32_t>(order[i] >> 32);
    for (j = i; j < all.size() && order[j] >> 32 == piece; ++j) {
    }
    field.evaluate_piece(piece, std::span(x).subspan(i, j - i), std::span(value).subspan(i, j - i),
                         std::span(gradient).subspan(i, j - i));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[index(i)].value = value[i];
    all[index(i)].gradient = gradient[i];
  }
}

void find_meetings(const PiecewiseField& field, std::span<Meeting> all) {
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].x = all[i].start;
    all[i].found = false;
    open.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<PieceValue> queries;
  std::vector<std::uint8_t> last(all.size(), 0);  // the last step was tiny: only the normals are still needed
  for (int step = 0; step <= kMostSteps && !open.empty(); ++step) {
    queries.clear();
    for (const std::uint32_t i : open)
      for (std::uint32_t k = 0; k < all[i].count; ++k) queries.push_back({all[i].piece[k], all[i].x, 0, {}});
    evaluate_pieces(field, queries);
    std::size_t kept = 0, q = 0;
    for (const std::uint32_t i : open) {
      Meeting& m = all[i];
      std::array<Vec3, 3> g;
      std::array<double, 3> r{};
      double residual = 0;
      for (std::uint32_t k = 0; k < m.count; ++k, ++q) {
        g[k] = queries[q].gradient;
        r[k] = -queries[q].value;
        const double slope = norm(g[k]);
        m.normal[k] = normalized(g[k]);
        residual = std::max(residual, slope > 0 ? std::abs(r[k]) / slope : m.reach);
      }
      Vec3 d;
      if (!shortest_step(g, r, m.count, d) || !is_finite(d)) continue;
      const double length = norm(d);
      if (last[i] || length <= kConverged * m.reach || step == kMostSteps) {
        m.found = residual <= kResidual * m.reach && independent(m.normal, m.count);
        continue;
      }
      m.x += length > m.reach ? d * (m.reach / length) : d;
      if (norm(m.x - m.start) > 2 * m.reach) continue;  // intermediate points may exceed the reach
      last[i] = length <= 1e-6 * m.reach;               // quadratic convergence: the next step is negligible
      open[kept++] = i;
    }
    open.resize(kept);
  }
  for (Meeting& m : all) m.found = m.found && norm(m.x - m.start) <= m.reach;
  check_surface(field, all);
}

}  // namespace sansmesh::inline v1
