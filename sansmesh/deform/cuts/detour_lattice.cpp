#include "sansmesh/deform/cuts/detour_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kUnreachable = 1e6;  // in lengths of the lattice
constexpr double kSight = 0.5;        // cells from the border within which nodes behind it become visible gradually
constexpr double kAside = 1e-3;       // distance of bends from the sheet, in cells
constexpr double kBetter = 1e-4;      // least reduction of length for which a path is replaced, in cells
constexpr int kBends = 4;             // between neighbours
constexpr std::size_t kNodesAtATime = 4096;

/// The point on the segment from p to q that minimises the path from a over it to b.
Vec3 best_bend(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const double length = norm(q - p);
  const Vec3 along = (q - p) / length;
  const double t0 = dot(a - p, along), t1 = dot(b - p, along);
  const double r0 = norm(a - p - along * t0), r1 = norm(b - p - along * t1), sum = r0 + r1;
  return p + along * std::clamp(sum > 0 ? t0 + (t1 - t0) * (r0 / sum) : t0, 0.0, length);
}

}  // namespace

DetourLattice::DetourLattice(const TriangleSheet& sheet, const Box3& box, int cells) : sheet_(sheet) {
  const Vec3 size = box.size();
  spacing_ = std::max({size.x, size.y, size.z}) / cells;
  const Vec3 center = box.center();
  Vec3 half;
  for (std::size_t k = 0; k < 3; ++k) {
    lattice_.sizes[k] =
        index_in<std::size_t>(std::ceil(size[k] / spacing_ - 1e-9), 1, static_cast<std::size_t>(cells)) + 1;
    half[k] = 0.5 * spacing_ * static_cast<double>(lattice_.sizes[k] - 1);
  }
  lattice_.box = {center - half, center + half};
  lattice_.spacing = {spacing_, spacing_, spacing_};
  unreachable_ = kUnreachable * lattice_.box.diagonal();
  const std::size_t count = lattice_.size();
  closed_.assign(count, 0);
  cut_.assign(count, 0);

  // Cells that a triangle may touch: those of its box, in thin slabs along its plane.
  for (std::size_t i = 0; i < sheet_.size(); ++i) {
    const std::array<Vec3, 3> t = sheet_.corners(i);
    Box3 around;
    for (const Vec3& p : t) around.extend(p);
    const Vec3 normal = normalized(cross(t[1] - t[0], t[2] - t[0]));
    const double reach = 0.5 * spacing_ * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)) * (1 + 1e-9);
    std::array<std::size_t, 3> first{}, last{};
    bool outside = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = (around.lower[k] - lattice_.box.lower[k]) / spacing_ - 1e-9,
                   high = (around.upper[k] - lattice_.box.lower[k]) / spacing_ + 1e-9;
      const double most = static_cast<double>(lattice_.sizes[k] - 2);
      outside = outside || high < 0 || low > most + 1;
      first[k] = index_in<std::size_t>(std::floor(low), 0, lattice_.sizes[k] - 2);
      last[k] = index_in<std::size_t>(std::floor(high), 0, lattice_.sizes[k] - 2);
    }
    if (outside) continue;
    for (std::size_t z = first[2]; z <= last[2]; ++z)
      for (std::size_t y = first[1]; y <= last[1]; ++y)
        for (std::size_t x = first[0]; x <= last[0]; ++x) {
          const Vec3 middle = lattice_.position({x, y, z}) + Vec3{0.5, 0.5, 0.5} * spacing_;
          if (std::abs(dot(middle - t[0], normal)) <= reach) cut_[lattice_.point({x, y, z})] = 1;
        }
  }
  const BoxLattice::Index stride = lattice_.strides();
  parallel_ranges(0, count, kNodesAtATime, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BoxLattice::Index at = lattice_.index(i);
      for (std::size_t k = 0; k < 3; ++k) {
        if (at[k] + 1 == lattice_.sizes[k]) continue;
        // The link belongs to up to four cells; if none of them is touched, nothing crosses it.
        bool near = false;
        const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
        for (std::size_t corner = 0; corner < 4 && !near; ++corner) {
          std::array<std::size_t, 3> cell = at;
          if ((corner & 1) && cell[u]-- == 0) continue;
          if ((corner & 2) && cell[v]-- == 0) continue;
          near = cut_[lattice_.point(cell)] != 0;
        }
        if (near && sheet_.crosses(lattice_.position(i), lattice_.position(i + stride[k])))
          closed_[i] = static_cast<std::uint8_t>(closed_[i] | 1u << k);
      }
    }
  });
}

struct DetourLattice::Bend {
  Vec3 point;
  double length = 0;  // length of the path to the bend
};

struct DetourLattice::March {
  using Entry = std::pair<double, std::uint32_t>;
  std::vector<double> lengths;
  std::vector<std::uint32_t> last;  // per node: its bend
  std::vector<Bend> bends;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  std::vector<TriangleSheet::Bend> edges;

  void set(std::size_t node, double length, std::uint32_t bend) {
    lengths[node] = length, last[node] = bend;
    next.emplace(length, static_cast<std::uint32_t>(node));
  }
};

/// Extends the path of a node to its neighbour, if that is shorter.
void DetourLattice::relax(March& march, std::size_t from, std::size_t to) const {
  const Vec3 y = lattice_.position(from), x = lattice_.position(to);
  const double enough = march.lengths[to] - kBetter * spacing_;
  Bend bend = march.bends[march.last[from]];
  if (!(bend.length + norm(x - bend.point) < enough)) return;
  if (!sheet_.crosses(bend.point, x)) return march.set(to, bend.length + norm(x - bend.point), march.last[from]);
  for (int i = 0; i < kBends; ++i) {
    march.edges.clear();
    sheet_.bends(bend.point, y, x, spacing_, march.edges);
    // Among all edges in between, the one farthest from the straight line.
    const Vec3 straight = normalized(x - bend.point);
    const Vec3 aside = normalized(y - bend.point - straight * dot(y - bend.point, straight));
    double most = 0;
    const TriangleSheet::Bend* best = nullptr;
    for (const TriangleSheet::Bend& edge : march.edges) {
      const Vec3 way = edge.point - bend.point;
      const double along = dot(way, straight), angle = std::atan2(dot(way, aside), along);
      if (along > 2 * kAside * spacing_ && angle > most) most = angle, best = &edge;
    }
    if (!best) break;
    Vec3 at = best_bend(bend.point, x, best->begin, best->end);
    if (norm(at - best->point) > spacing_) at = best->point + normalized(at - best->point) * spacing_;
    at += aside * (kAside * spacing_);
    bend.length += norm(at - bend.point);
    bend.point = at;
    if (!(bend.length + norm(x - at) < enough)) return;
    if (sheet_.crosses(at, x)) continue;
    march.bends.push_back(bend);
    return march.set(to, bend.length + norm(x - at), static_cast<std::uint32_t>(march.bends.size() - 1));
  }
  const double length = march.lengths[from];
  if (!(length + spacing_ < enough)) return;
  march.bends.push_back({y, length});
  march.set(to, length + spacing_, static_cast<std::uint32_t>(march.bends.size() - 1));
}

std::vector<float> DetourLattice::extra_lengths(const Vec3& from) const {
  const std::size_t count = closed_.size();
  March march;
  march.lengths.assign(count, kFar);
  march.last.assign(count, 0);
  march.bends.push_back({from, 0});
  std::vector<std::uint8_t> seen(count);
  parallel_ranges(0, count, kNodesAtATime, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 x = lattice_.position(i);
      if (sheet_.crosses(from, x)) continue;
      seen[i] = 1;
      march.lengths[i] = norm(x - from);
    }
  });
  const BoxLattice::Index stride = lattice_.strides();
  const auto around = [&](std::size_t node, const auto& use) {
    const BoxLattice::Index at = lattice_.index(node);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t s = stride[k];
      if (at[k] > 0 && !seen[node - s] && !(closed_[node - s] >> k & 1)) use(node - s);
      if (at[k] + 1 < lattice_.sizes[k] && !seen[node + s] && !(closed_[node] >> k & 1)) use(node + s);
    }
  };
  for (std::size_t i = 0; i < count; ++i)
    if (seen[i]) around(i, [&](std::size_t other) { relax(march, i, other); });
  while (!march.next.empty()) {
    const auto [length, node] = march.next.top();
    march.next.pop();
    if (length > march.lengths[node]) continue;
    around(node, [&, node = node](std::size_t other) { relax(march, node, other); });
  }
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i)
    if (!seen[i])
      result[i] = static_cast<float>(march.lengths[i] == kFar
                                         ? unreachable_
                                         : std::max(0.0, march.lengths[i] - norm(lattice_.position(i) - from)));
  return result;
}

double DetourLattice::in_cut_cell(const std::vector<float>& values, const std::array<std::size_t, 3>& cell,
                                  const Vec3& x) const {
  const Vec3 f = (x - lattice_.position(cell)) / spacing_;
  const double sight = kSight * spacing_;
  double sum = 0, weights = 0, least = std::numeric_limits<double>::infinity();
  std::vector<TriangleSheet::Crossing> crossings;
  for (std::size_t c = 0; c < 8; ++c) {
    const std::array<std::size_t, 3> at = {cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)};
    double weight = 1;
    for (std::size_t k = 0; k < 3; ++k) weight *= at[k] == cell[k] ? 1 - f[k] : f[k];
    const auto value = static_cast<double>(values[lattice_.point(at)]);
    least = std::min(least, value);
    if (!(weight > 0)) continue;
    crossings.clear();
    sheet_.crossings(x, lattice_.position(at), crossings);
    for (const TriangleSheet::Crossing& crossing : crossings) {
      const double from_border = sheet_.nearest_border(crossing.point, sight).distance;
      weight *= std::max(0.0, 1 - from_border / sight);
    }
    sum += weight * value, weights += weight;
  }
  return weights > 1e-9 ? sum / weights : least;
}

Detour DetourLattice::interpolate(const std::vector<float>& values, const Vec3& x) const {
  if (!is_finite(x)) return {};
  std::array<std::size_t, 3> cell{};
  Vec3 f, p = x;
  std::array<bool, 3> beyond{};
  for (std::size_t k = 0; k < 3; ++k) {
    beyond[k] = p[k] < lattice_.box.lower[k] || p[k] > lattice_.box.upper[k];
    p[k] = std::clamp(p[k], lattice_.box.lower[k], lattice_.box.upper[k]);
    const double t = (p[k] - lattice_.box.lower[k]) / spacing_;
    cell[k] = std::min(static_cast<std::size_t>(t), lattice_.sizes[k] - 2);
    f[k] = t - static_cast<double>(cell[k]);
  }
  const std::size_t node = lattice_.point(cell);
  Detour result;
  std::array<double, 8> v;
  bool any = false;
  for (std::size_t c = 0; c < 8; ++c) {
    const BoxLattice::Index at{cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)};
    v[c] = static_cast<double>(values[lattice_.point(at)]);
    any = any || v[c] > 0;
  }
  if (!any) return result;
  if (!cut_[node]) {
    const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
    const double y0 = mix(v[0], v[1], f.x), y1 = mix(v[2], v[3], f.x), y2 = mix(v[4], v[5], f.x),
                 y3 = mix(v[6], v[7], f.x);
    const double z0 = mix(y0, y1, f.y), z1 = mix(y2, y3, f.y);
    result.extra = mix(z0, z1, f.z);
    result.gradient = Vec3{mix(mix(v[1] - v[0], v[3] - v[2], f.y), mix(v[5] - v[4], v[7] - v[6], f.y), f.z),
                           mix(y1 - y0, y3 - y2, f.z), z1 - z0} /
                      spacing_;
  } else {
    result.extra = in_cut_cell(values, cell, p);
    const double step = 1e-4 * spacing_;
    for (std::size_t k = 0; k < 3; ++k) {
      if (beyond[k]) continue;
      // A second point within the cell, on this side of the sheet.
      Vec3 q = p;
      double by = f[k] < 0.5 ? step : -step;
      q[k] += by;
      if (sheet_.crosses(p, q)) {
        by = -by, q[k] = p[k] + by;
        const double t = (q[k] - lattice_.box.lower[k]) / spacing_ - static_cast<double>(cell[k]);
        if (t < 0 || t > 1 || sheet_.crosses(p, q)) continue;
      }
      result.gradient[k] = (in_cut_cell(values, cell, q) - result.extra) / by;
    }
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (beyond[k]) result.gradient[k] = 0;
  return result;
}

}  // namespace sansmesh::inline v1
