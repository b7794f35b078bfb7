#include "sansmesh/volume/cells/higher_order_functions.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kStraight = 1e-9;  // deviation from an affine cell, in its size
constexpr double kBeyond = 1e-9;    // natural coordinates
constexpr int kMostNewton = 20;
constexpr double kConverged = 1e-7;  // last step in natural coordinates: the next one would be rounding
constexpr double kDiverged = 1;      // natural coordinates outside the cell where Newton's method has diverged
constexpr double kBulge = 0.25;      // curved cells beyond the box of their nodes, in its size

/// Derivatives of the position by natural coordinates.
Matrix3 jacobian(const SampledVolume& volume, std::span<const std::uint32_t> nodes, std::span<const Vec3> slopes) {
  Matrix3 j{{}, {}, {}};
  const Vec3 base = volume.positions[nodes[0]];
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Vec3 x = volume.positions[nodes[n]] - base;
    j.a += x * slopes[n].x, j.b += x * slopes[n].y, j.c += x * slopes[n].z;
  }
  return j;
}

/// Replaces derivatives by natural coordinates by gradients; by zero where the cell is singular.
void to_gradients(const Matrix3& j, std::span<Vec3> slopes) {
  const double size = j.determinant();
  const Vec3 r = cross(j.b, j.c) / size, s = cross(j.c, j.a) / size, t = cross(j.a, j.b) / size;
  const bool regular = is_finite(r) && is_finite(s) && is_finite(t);
  for (Vec3& d : slopes) d = regular ? r * d.x + s * d.y + t * d.z : Vec3{};
}

}  // namespace

double NodeWeights::value(const VolumeValues& values, std::size_t component) const {
  const std::size_t c = values.components;
  const double base = values.values[nodes[0] * c + component];
  double sum = 0;
  for (std::size_t n = 1; n < nodes.size(); ++n) sum += weights[n] * (values.values[nodes[n] * c + component] - base);
  return base + sum;
}

Vec3 NodeWeights::gradient(const VolumeValues& values, std::size_t component) const {
  const std::size_t c = values.components;
  const double base = values.values[nodes[0] * c + component];
  Vec3 sum;
  for (std::size_t n = 1; n < nodes.size(); ++n) sum += slopes[n] * (values.values[nodes[n] * c + component] - base);
  return sum;
}

HigherOrderFunctions::HigherOrderFunctions(const SampledVolume& volume) : volume_(volume) {
  if (empty()) return;
  const HigherOrderCells& higher = volume.higher;
  basis_.resize(higher.size());
  for (std::size_t c = 0; c < higher.size(); ++c) {
    std::size_t b = 0;
    while (b < bases_.size() && !(bases_[b].kind() == higher.kinds[c])) ++b;
    if (b == bases_.size()) bases_.emplace_back(higher.kinds[c]);
    basis_[c] = static_cast<std::uint16_t>(b);
  }
  number_corners();
  classify();
}

void HigherOrderFunctions::number_corners() {
  local_.resize(volume_.cells.corners.size());
  parallel_for(0, volume_.cells.size(), 1024, [&](std::size_t cell) {
    const std::uint32_t whole = volume_.higher.of_piece[cell];
    if (whole == HigherOrderCells::kNone) return;
    const auto nodes = volume_.higher[whole];
    for (std::uint64_t k = volume_.cells.first[cell]; k < volume_.cells.first[cell + 1]; ++k)
      local_[k] =
          static_cast<std::uint16_t>(std::find(nodes.begin(), nodes.end(), volume_.cells.corners[k]) - nodes.begin());
  });
}

/// Finds the curved cells, and what the search for the cell of a point near their faces needs.
void HigherOrderFunctions::classify() {
  const HigherOrderCells& higher = volume_.higher;
  curved_.resize(higher.size());
  parallel_ranges(0, higher.size(), 256, [&](std::size_t first, std::size_t last) {
    NodeWeights at;
    for (std::size_t c = first; c < last; ++c) {
      const auto nodes = higher[c];
      const NodalBasis& basis = basis_of(static_cast<std::uint32_t>(c));
      at.weights.resize(nodes.size()), at.slopes.resize(nodes.size());
      const Vec3 middle = basis.middle();
      basis.evaluate(middle, at.weights, at.slopes);
      const Matrix3 j = jacobian(volume_, nodes, at.slopes);
      Box3 box;
      for (const std::uint32_t n : nodes) box.extend(volume_.positions[n]);
      const double most = kStraight * box.diagonal();
      Vec3 center;
      const Vec3 base = volume_.positions[nodes[0]];
      for (std::size_t n = 0; n < nodes.size(); ++n) center += (volume_.positions[nodes[n]] - base) * at.weights[n];
      for (std::size_t n = 0; n < nodes.size() && curved_[c] == 0; ++n) {
        const Vec3 d = basis.nodes()[n] - middle;
        const Vec3 straight = center + j.a * d.x + j.b * d.y + j.c * d.z;
        curved_[c] = !(norm(volume_.positions[nodes[n]] - base - straight) <= most);
      }
    }
  });
  if (std::find(curved_.begin(), curved_.end(), 1) == curved_.end()) return;
  around_.first.assign(volume_.positions.size() + 1, 0);
  for (const std::uint32_t n : higher.nodes) ++around_.first[n + 1];
  for (std::size_t i = 1; i < around_.first.size(); ++i) around_.first[i] += around_.first[i - 1];
  around_.entries.resize(higher.nodes.size());
  std::vector<std::uint64_t> next(around_.first.begin(), around_.first.end() - 1);
  boxes_.resize(higher.size());
  for (std::size_t c = 0; c < higher.size(); ++c) {
    for (const std::uint32_t n : higher[c]) {
      around_.entries[next[n]++] = static_cast<std::uint32_t>(c);
      boxes_[c].extend(volume_.positions[n]);
    }
    const Vec3 slack = (boxes_[c].upper - boxes_[c].lower) * kBulge;
    boxes_[c] = {boxes_[c].lower - slack, boxes_[c].upper + slack};
  }
}

Vec3 HigherOrderFunctions::start_of(const CellLocation& location) const {
  const auto nodes = basis_of(volume_.higher.of_piece[location.cell]).nodes();
  const std::uint16_t* const local = local_.data() + volume_.cells.first[location.cell];
  Vec3 u;
  for (std::size_t v = 0; v < location.corner_count; ++v) u += nodes[local[v]] * location.weights[v];
  return u;
}

/// Solves Σ N_n(u) x_n = x by Newton's method from u; false if it does not converge near the cell.
bool HigherOrderFunctions::invert(std::uint32_t cell, const Vec3& x, Vec3& u, NodeWeights& out) const {
  const auto nodes = volume_.higher[cell];
  const NodalBasis& basis = basis_of(cell);
  out.weights.resize(nodes.size()), out.slopes.resize(nodes.size());
  const Vec3 base = volume_.positions[nodes[0]], goal = x - base;
  Vec3 at = u;
  for (int step = 0; step < kMostNewton; ++step) {
    basis.evaluate(at, out.weights, out.slopes);
    Vec3 left = goal;
    for (std::size_t n = 1; n < nodes.size(); ++n) left -= (volume_.positions[nodes[n]] - base) * out.weights[n];
    const Vec3 d = jacobian(volume_, nodes, out.slopes).solve(left);
    if (!is_finite(d)) return false;
    at += d;
    if (!basis.within(at, kDiverged)) return false;
    if (squared_norm(d) > kConverged * kConverged) continue;
    u = at;
    return true;
  }
  return false;
}

/// The first other cell that contains x, of those around the located piece; `cell` and `u` change only if there is one.
bool HigherOrderFunctions::find_beyond(const CellLocation& location, const Vec3& x, std::uint32_t& cell, Vec3& u,
                                       NodeWeights& out) const {
  std::uint32_t best = HigherOrderCells::kNone;
  for (std::size_t v = 0; v < location.corner_count; ++v)
    for (const std::uint32_t other : around_[location.corners[v]]) {
      if (other == cell || other >= best || !boxes_[other].contains(x)) continue;
      Vec3 there = basis_of(other).middle();
      if (!invert(other, x, there, out) || !basis_of(other).within(there, kBeyond)) continue;
      best = other, u = there;
    }
  if (best == HigherOrderCells::kNone) return false;
  cell = best;
  return true;
}

bool HigherOrderFunctions::find(const CellLocation& location, const Vec3& x, bool slopes, NodeWeights& out) const {
  if (!has(location.cell)) return false;
  std::uint32_t cell = volume_.higher.of_piece[location.cell];
  Vec3 u = start_of(location);
  if (curved_[cell] != 0 && invert(cell, x, u, out) && !basis_of(cell).within(u, kBeyond))
    find_beyond(location, x, cell, u, out);
  out.nodes = volume_.higher[cell];
  out.weights.resize(out.nodes.size()), out.slopes.resize(slopes ? out.nodes.size() : 0);
  basis_of(cell).evaluate(u, out.weights, out.slopes);
  if (slopes) to_gradients(jacobian(volume_, out.nodes, out.slopes), out.slopes);
  return true;
}

bool HigherOrderFunctions::at_middle(std::uint32_t cell, NodeWeights& out) const {
  if (!has(cell)) return false;
  CellLocation location;
  const auto corners = volume_.cells[cell];
  location.cell = cell, location.inside = true, location.corner_count = static_cast<std::uint8_t>(corners.size());
  std::copy(corners.begin(), corners.end(), location.corners.begin());
  Vec3 x;
  for (std::size_t v = 0; v < corners.size(); ++v) {
    location.weights[v] = 1 / static_cast<double>(corners.size());
    x += volume_.positions[corners[v]] * location.weights[v];
  }
  return find(location, x, false, out);
}

bool HigherOrderFunctions::at_edge(std::span<const std::uint32_t> cells, std::uint32_t from, std::uint32_t to,
                                   NodeWeights& out) const {
  for (const std::uint32_t cell : cells) {
    if (!has(cell)) continue;
    const auto corners = volume_.cells[cell];
    if (std::find(corners.begin(), corners.end(), to) == corners.end()) continue;
    CellLocation location;
    location.cell = cell, location.inside = true, location.corner_count = static_cast<std::uint8_t>(corners.size());
    std::copy(corners.begin(), corners.end(), location.corners.begin());
    for (std::size_t v = 0; v < corners.size(); ++v)
      if (corners[v] == from || corners[v] == to) location.weights[v] = 0.5;
    return find(location, (volume_.positions[from] + volume_.positions[to]) * 0.5, false, out);
  }
  return false;
}

}  // namespace sansmesh::inline v1
