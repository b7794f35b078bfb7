#include "sansmesh/volume/support_index.h"

#include <algorithm>
#include <cmath>

namespace sansmesh {
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
    : volume_(&volume) {
  tree_ = BoxTree(radii.size(), [&](std::size_t i) {
    const Vec3 x = volume.position(i);
    const StarMetric metric = volume.lattice ? lattice_metric(*volume.lattice, i) : metrics[i];
    const Vec3 e = ellipsoid_extent(metric, static_cast<double>(radii[i]));
    return Box3{x - e, x + e};
  });
}

Vec3 SupportIndex::of_cell(const VolumePlace& cell, Memory& memory) const {
  Box3 box;
  for (std::size_t v = 0; v < cell.corner_count; ++v)
    box.extend(volume_->lattice ? volume_->lattice->position(cell.corners[v]) : volume_->corner(cell.corners[v]));
  // Cells at the ends of lattices of samples in cells go on for half a cell.
  if (volume_->lattice && volume_->in_cells) box = {box.lower - box.size() * 0.5, box.upper + box.size() * 0.5};
  tree_.overlapping(box, memory.supports);
  std::sort(memory.supports.begin(), memory.supports.end());
  if (volume_->cell_sample.empty())
    memory.near.assign(cell.corners.begin(), cell.corners.begin() + cell.corner_count);
  else
    memory.near.assign(1, volume_->cell_sample[cell.cell]);
  memory.own = memory.near[0];
  leave_connected(memory);
  return box.center();
}

void SupportIndex::of_sample(std::uint32_t sample, Memory& memory) const {
  tree_.containing(volume_->position(sample), memory.supports);
  std::sort(memory.supports.begin(), memory.supports.end());
  memory.near.assign(1, sample);
  memory.own = sample;
  leave_connected(memory);
}

void SupportIndex::leave_connected(Memory& memory) const {
  if (volume_->lattice) return;
  memory.seen.clear();
  const auto seen = [&](std::uint32_t i) { return memory.seen.contains(i); };
  for (const std::uint32_t i : memory.near) memory.seen.insert(i);
  std::size_t first = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    // Most often all are found after a ring or two.
    if (std::all_of(memory.supports.begin(), memory.supports.end(), seen)) return;
    const std::size_t last = memory.near.size();
    for (std::size_t i = first; i < last; ++i)
      for (const std::uint32_t j : volume_->stars[memory.near[i]])
        if (memory.seen.insert(j)) memory.near.push_back(j);
    first = last;
  }
  std::erase_if(memory.supports, [&](std::uint32_t i) { return !seen(i); });
}

}  // namespace sansmesh
