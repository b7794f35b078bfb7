#include "sansmesh/volume/methods/cell_agreement.h"

#include <algorithm>
#include <array>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/higher_order_functions.h"
#include "sansmesh/volume/methods/cell_interpolant.h"

namespace sansmesh::inline v1 {

CellAgreement::CellAgreement(const SampledVolume& volume, const VolumeValues& values, const Polynomials& p,
                             std::span<const std::uint8_t> split)
    : volume_(&volume) {
  if (volume.lattice) return;
  cells_ = cells_of_samples(volume);
  shares_.resize(volume.cells.corners.size());
  if (volume.cell_sample.empty())
    ask_middles(values, p, split);
  else
    ask_corners(values, p, split);
}

void CellAgreement::ask_middles(const VolumeValues& values, const Polynomials& p, std::span<const std::uint8_t> split) {
  const std::size_t c = values.components;
  const HigherOrderFunctions higher(*volume_);
  parallel_for(0, volume_->cells.size(), 256, [&](std::size_t cell) {
    static thread_local NodeWeights nodes;
    const auto corners = volume_->cells[cell];
    const auto n = static_cast<double>(corners.size());
    Vec3 middle;
    for (const std::uint32_t k : corners) {
      if (split[k] != 0) return;
      middle += volume_->positions[k] / n;
    }
    Share* shares = shares_.data() + volume_->cells.first[cell];
    const bool own = higher.at_middle(static_cast<std::uint32_t>(cell), nodes);
    for (std::size_t m = 0; m < c; ++m) {
      const double base = values.values[corners[0] * c + m];
      std::array<double, 8> at;
      double mean = 0, flat = 0;
      for (std::size_t v = 0; v < corners.size(); ++v) {
        const std::size_t k = corners[v];
        at[v] = p(k, m, middle) - base;
        mean += at[v] / n, flat += (values.values[k * c + m] - base) / n;
      }
      if (own) flat = nodes.value(values, m) - base;
      for (std::size_t v = 0; v < corners.size(); ++v) {
        const double doubt = (at[v] - mean) * (at[v] - mean);
        const double alone = at[v] - flat, others = mean + (mean - at[v]) / (n - 1) - flat;
        shares[v].doubt += own ? std::min(doubt, alone * alone) : doubt;
        shares[v].gain += own ? agreed_square(alone, others) : (mean - flat) * (mean - flat);
      }
    }
  });
}

void CellAgreement::ask_corners(const VolumeValues& values, const Polynomials& p, std::span<const std::uint8_t> split) {
  const std::size_t c = values.components;
  const CellInterpolant flat(*volume_, values);
  const Adjacency around = cells_of_points(volume_->cells, volume_->corners.size());
  parallel_ranges(0, volume_->corners.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> samples;
    std::vector<double> at;
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 x = volume_->corners[k];
      samples.clear();
      for (const std::uint32_t cell : around[k]) samples.push_back(volume_->cell_sample[cell]);
      const std::size_t own = samples.size();
      if (own == 0) continue;
      if (flat.is_outer(k))
        for (std::size_t s = 0; s < own; ++s)
          for (const std::uint32_t j : volume_->stars[samples[s]])
            if (std::find(samples.begin(), samples.end(), j) == samples.end()) samples.push_back(j);
      if (std::any_of(samples.begin(), samples.end(), [&](std::uint32_t i) { return split[i] != 0; })) continue;
      at.resize(samples.size());
      for (std::size_t m = 0; m < c; ++m) {
        const double base = values.values[samples[0] * c + m];
        double near = 0, all = 0;
        for (std::size_t s = 0; s < samples.size(); ++s) {
          const std::size_t i = samples[s];
          at[s] = p(i, m, x) - base;
          all += at[s];
          if (s < own) near += at[s];
        }
        near /= static_cast<double>(own), all /= static_cast<double>(samples.size());
        const double more = near - (flat.at_corner(k, m) - base);
        for (std::size_t s = 0; s < own; ++s) {
          const std::size_t cell = around[k][s];
          const auto corners = volume_->cells[cell];
          const auto slot = std::find(corners.begin(), corners.end(), static_cast<std::uint32_t>(k)) - corners.begin();
          Share& share = shares_[volume_->cells.first[cell] + static_cast<std::size_t>(slot)];
          share.gain += more * more, share.doubt += (at[s] - all) * (at[s] - all);
        }
      }
    }
  });
}

CellAgreement::Share CellAgreement::of(std::size_t sample) const {
  Share sum;
  if (shares_.empty() || cells_[sample].empty()) return sum;
  double count = 0;
  for (const std::uint32_t cell : cells_[sample]) {
    const auto corners = volume_->cells[cell];
    const Share* shares = shares_.data() + volume_->cells.first[cell];
    for (std::size_t v = 0; v < corners.size(); ++v) {
      if (volume_->cell_sample.empty() && corners[v] != sample) continue;
      sum.gain += shares[v].gain, sum.doubt += shares[v].doubt, count += 1;
    }
  }
  return {sum.gain / count, sum.doubt / count};
}

}  // namespace sansmesh::inline v1
