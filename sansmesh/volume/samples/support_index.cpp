#include "sansmesh/volume/samples/support_index.h"
#include "sansmesh/volume/cells/cell_corners.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

// Half the edges of the box of an ellipsoid ‖M d‖ <= radius: the lengths of the rows of radius M⁻¹, M = diag(s) E.
Vec3 ellipsoid_extent(const StarMetric& metric, double radius) {
  Vec3 squared;
  for (const Vec3f& row : metric.rows) {
    const Vec3 r(row);
    const double length2 = squared_norm(r);  // s²: the axis is r / s, its extent 1 / s
    for (std::size_t k = 0; k < 3; ++k) squared[k] += r[k] * r[k] / (length2 * length2);
  }
  return Vec3{std::sqrt(squared.x), std::sqrt(squared.y), std::sqrt(squared.z)} * (radius * (1 + 1e-5));
}

}  // namespace

SupportIndex::SupportIndex(const SampledVolume& volume, std::span<const StarMetric> metrics,
                           std::span<const float> radii)
    : volume_(&volume), metrics_(metrics), radii_(radii) {
  tree_ = BoxTree(radii.size(), [&](std::size_t i) {
    const Vec3 x = volume.position(i);
    const StarMetric metric = metric_of(volume, metrics, i);
    const Vec3 e = ellipsoid_extent(metric, static_cast<double>(radii[i]));
    return Box3{x - e, x + e};
  });
}

std::size_t SupportIndex::hull_of(const CellLocation& cell, std::array<Vec3, 8>& hull) const {
  const std::size_t count = cell.corner_count;
  for (std::size_t v = 0; v < count; ++v) hull[v] = corner_position(*volume_, cell.corners[v]);
  if (!volume_->lattice || !volume_->in_cells) return count;
  // The outermost cells of cell-data lattices extend by half a cell.
  const Vec3 middle = (hull[0] + hull[6]) * 0.5;
  for (Vec3& x : hull) x = middle + (x - middle) * 2.0;
  return count;
}

Vec3 SupportIndex::of_cell(const CellLocation& cell, Memory& memory) const {
  std::array<Vec3, 8> corners;
  const auto hull = std::span<const Vec3>(corners).first(hull_of(cell, corners));
  Box3 box;
  for (const Vec3& x : hull) box.extend(x);
  tree_.overlapping(box, memory.supports);
  leave_near(hull, memory);
  if (volume_->cell_sample.empty())
    memory.near.assign(cell.corners.begin(), cell.corners.begin() + cell.corner_count);
  else
    memory.near.assign(1, volume_->cell_sample[cell.cell]);
  memory.own = memory.near[0];
  leave_connected(kRings, memory);
  return box.center();
}

void SupportIndex::of_sample(std::uint32_t sample, Memory& memory) const {
  const Vec3 x = volume_->position(sample);
  tree_.containing(x, memory.supports);
  leave_near(std::span(&x, 1), memory);
  memory.near.assign(1, sample);
  memory.own = sample;
  leave_connected(kRings, memory);
}

void SupportIndex::of_point(const Vec3& x, std::span<const std::uint32_t> star, Memory& memory) const {
  tree_.containing(x, memory.supports);
  leave_near(std::span(&x, 1), memory);
  memory.near.assign(star.begin(), star.end());
  memory.own = star.empty() ? 0 : star[0];
  leave_connected(kRings - 1, memory);
}

// Keeps supports that may reach the convex hull of some points: their box in local coordinates is within the radius.
void SupportIndex::leave_near(std::span<const Vec3> hull, Memory& memory) const {
  Vec3 middle;
  for (const Vec3& x : hull) middle += x;
  middle = middle / static_cast<double>(hull.size());
  // Corners relative to their centre, one per vector lane; the centre fills unused lanes.
  constexpr std::size_t kMost = 8;
  float x[kMost] = {}, y[kMost] = {}, z[kMost] = {};
  for (std::size_t v = 0; v < hull.size(); ++v) {
    const Vec3f d(hull[v] - middle);
    x[v] = d.x, y[v] = d.y, z[v] = d.z;
  }
  std::erase_if(memory.supports, [&](std::uint32_t i) {
    const StarMetric metric = metric_of(*volume_, metrics_, i);
    const Vec3f to(middle - volume_->position(i));
    const float reach = radii_[i] * radii_[i] * 1.0001f;
    float u[3], squared = 0;
    for (std::size_t k = 0; k < 3; ++k) u[k] = std::abs(dot(metric.rows[k], to)), squared += u[k] * u[k];
    if (squared < reach) return false;
    if (hull.size() == 1) return true;
    squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& row = metric.rows[k];
      float extent[kMost];
      for (std::size_t v = 0; v < kMost; ++v) extent[v] = std::abs(row.x * x[v] + row.y * y[v] + row.z * z[v]);
      for (std::size_t half = kMost / 2; half > 0; half /= 2)
        for (std::size_t v = 0; v < half; ++v) extent[v] = std::max(extent[v], extent[v + half]);
      const float gap = std::max(u[k] - extent[0] * 1.0001f, 0.0f);
      squared += gap * gap;
    }
    return !(squared < reach);
  });
  std::sort(memory.supports.begin(), memory.supports.end());
}

void SupportIndex::leave_connected(int rings, Memory& memory) const {
  if (volume_->lattice) return;
  memory.seen.clear();
  const auto seen = [&](std::uint32_t i) { return memory.seen.contains(i); };
  for (const std::uint32_t i : memory.near) memory.seen.insert(i);
  std::size_t first = 0, met = 0;
  for (int ring = 0; ring < rings; ++ring) {
    // Usually all are found after a ring or two.
    while (met < memory.supports.size() && seen(memory.supports[met])) ++met;
    if (met == memory.supports.size()) return;
    const std::size_t last = memory.near.size();
    for (std::size_t i = first; i < last; ++i)
      for (const std::uint32_t j : volume_->stars[memory.near[i]])
        if (memory.seen.insert(j)) memory.near.push_back(j);
    first = last;
  }
  std::erase_if(memory.supports, [&](std::uint32_t i) { return !seen(i); });
}

}  // namespace sansmesh::inline v1
