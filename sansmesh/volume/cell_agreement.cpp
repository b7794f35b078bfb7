#include "sansmesh/volume/cell_agreement.h"

#include <algorithm>
#include <array>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cell_adjacency.h"

namespace sansmesh {

CellAgreement::CellAgreement(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& p,
                             std::span<const std::uint8_t> split)
    : volume_(&volume) {
  if (volume.lattice || !volume.cell_sample.empty()) return;
  cells_ = cells_of_samples(volume);
  shares_.resize(volume.cells.corners.size());
  const std::size_t c = values.components;
  parallel_for(0, volume.cells.size(), 256, [&](std::size_t cell) {
    const auto corners = volume.cells[cell];
    const auto n = static_cast<double>(corners.size());
    Vec3 middle;
    for (const std::uint32_t k : corners) {
      if (split[k] != 0) return;
      middle += volume.positions[k] / n;
    }
    Share* shares = shares_.data() + volume.cells.first[cell];
    for (std::size_t m = 0; m < c; ++m) {
      const double base = values.values[corners[0] * c + m];
      std::array<double, 8> at;
      double mean = 0, flat = 0;
      for (std::size_t v = 0; v < corners.size(); ++v) {
        const std::size_t k = corners[v];
        at[v] = p.constants[k * c + m] - base + p.full_rise(k, m, p.metric(volume, k)(middle - volume.positions[k]));
        mean += at[v] / n, flat += (values.values[k * c + m] - base) / n;
      }
      for (std::size_t v = 0; v < corners.size(); ++v) {
        shares[v].gain += (mean - flat) * (mean - flat);
        shares[v].doubt += (at[v] - mean) * (at[v] - mean);
      }
    }
  });
}

CellAgreement::Share CellAgreement::of(std::size_t sample) const {
  Share sum;
  if (shares_.empty() || cells_[sample].empty()) return sum;
  for (const std::uint32_t cell : cells_[sample]) {
    const auto corners = volume_->cells[cell];
    const auto own = std::find(corners.begin(), corners.end(), static_cast<std::uint32_t>(sample)) - corners.begin();
    const Share& share = shares_[volume_->cells.first[cell] + static_cast<std::size_t>(own)];
    sum.gain += share.gain, sum.doubt += share.doubt;
  }
  const auto count = static_cast<double>(cells_[sample].size());
  return {sum.gain / count, sum.doubt / count};
}

}  // namespace sansmesh
