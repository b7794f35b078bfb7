#include "sansmesh/volume/methods/linear_share.h"

#include <algorithm>
#include <array>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/cell_finder.h"

namespace sansmesh::inline v1 {
namespace {

// Variance of a correction, in squares of its difference to the correction by the next samples.
constexpr double kOuterDisagreement = 2.5;

// Shares below a hundredth are skipped to save time.
double worth(double share) { return share < 0.01 ? 0 : share; }

// Cells with partial faces, at borders of levels and blocks: linear interpolation is not continuous there.
std::vector<std::uint8_t> border_cells(const SampledVolume& volume) {
  std::vector<std::uint8_t> border(volume.cells.size(), 0);
  for_each_partial_neighbour(
      FaceNeighbours(volume.cells, volume.corners),
      [&](std::uint32_t cell, std::uint32_t, std::uint32_t other) { border[cell] = border[other] = 1; });
  return border;
}

// Cells of samples at corners whose box meets that of another block's cell.
std::vector<std::uint8_t> overlapping_cells(const SampledVolume& volume) {
  std::vector<std::uint8_t> border(volume.cells.size(), 0);
  if (volume.block.empty()) return border;
  const auto box_of = [&](std::size_t cell) {
    Box3 box;
    for (const std::uint32_t k : volume.cells[cell]) box.extend(volume.positions[k]);
    return box;
  };
  const BoxTree tree(border.size(), box_of);
  parallel_ranges(0, border.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (std::size_t cell = begin; cell < end; ++cell) {
      const std::uint16_t own = volume.block[volume.cells[cell][0]];
      const auto foreign = [&](std::uint32_t other) {
        const auto corners = volume.cells[other];
        return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t k) { return volume.block[k] != own; });
      };
      tree.overlapping(box_of(cell), near);
      border[cell] = std::any_of(near.begin(), near.end(), foreign) ? 1 : 0;
    }
  });
  return border;
}

}  // namespace

LinearShare::LinearShare(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& polynomials,
                         bool only_outside)
    : volume_(volume), any_(volume.cells.size(), 0) {
  const std::size_t n = volume.size(), c = values.components;
  joint_.components = c + 1;
  joint_.values.resize(n * (c + 1));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t m = 0; m < c; ++m) joint_.values[i * (c + 1) + m] = values.values[i * c + m];
    const double doubt = 1 - static_cast<double>(polynomials.trust[i]);
    share_of(i) = worth(volume.cell_sample.empty() ? doubt : doubt * doubt);
  }
  volume.cell_sample.empty() ? share_at_corners() : share_in_cells(polynomials, only_outside);
}

void LinearShare::share_at_corners() {
  const std::vector<std::uint8_t> border = overlapping_cells(volume_);
  for (std::size_t cell = 0; cell < border.size(); ++cell)
    if (border[cell] != 0)
      for (const std::uint32_t k : volume_.cells[cell]) share_of(k) = 0;
  for (std::size_t cell = 0; cell < any_.size(); ++cell)
    for (const std::uint32_t k : volume_.cells[cell])
      if (share_of(k) > 0) any_[cell] = 1;
}

void LinearShare::share_in_cells(const LocalPolynomials& polynomials, bool only_outside) {
  const std::size_t c = joint_.components - 1;
  const std::vector<std::uint8_t> border = border_cells(volume_);
  for (std::size_t cell = 0; cell < border.size(); ++cell)
    if (border[cell] != 0) share_of(volume_.cell_sample[cell]) = 0;
  interpolant_.emplace(volume_, joint_);
  const Adjacency around = cells_of_points(volume_.cells, volume_.corners.size());
  parallel_ranges(0, volume_.corners.size(), 512, [&](std::size_t begin, std::size_t end) {
    Near near;
    for (std::size_t k = begin; k < end; ++k) {
      const auto cells = around[k];
      double share = 0;
      if ((interpolant_->is_outer(k) || !only_outside) &&
          std::none_of(cells.begin(), cells.end(), [&](std::uint32_t cell) { return border[cell] != 0; })) {
        for (const std::uint32_t cell : cells)
          share += share_of(volume_.cell_sample[cell]) / static_cast<double>(cells.size());
        if (interpolant_->is_outer(k)) share = std::max(share, worth(outer_share(polynomials, k, cells, near)));
      }
      interpolant_->set_at_corner(k, c, share);
    }
  });
  for (std::size_t i = 0; only_outside && i < volume_.size(); ++i) share_of(i) = 0;
  parallel_for(0, any_.size(), 4096, [&](std::size_t cell) {
    bool any = share_of(volume_.cell_sample[cell]) > 0;
    for (const std::uint32_t k : volume_.cells[cell]) any = any || interpolant_->at_corner(k, c) > 0;
    any_[cell] = any ? 1 : 0;
  });
}

// The share at a corner on the surface of the volume, from the cells around it.
double LinearShare::outer_share(const LocalPolynomials& polynomials, std::size_t corner,
                                std::span<const std::uint32_t> cells, Near& near) const {
  near.own.clear(), near.next.clear();
  for (const std::uint32_t cell : cells) near.own.push_back(volume_.cell_sample[cell]);
  for (const std::uint32_t i : near.own)
    for (const std::uint32_t j : volume_.stars[i])
      if (std::find(near.own.begin(), near.own.end(), j) == near.own.end()) near.next.push_back(j);
  double gain = 0, doubt = 0;
  for (std::size_t m = 0; m < polynomials.components; ++m) {
    const double flat = interpolant_->at_corner(corner, m);
    const auto correction = [&](std::span<const std::uint32_t> samples) {
      double sum = 0;
      for (const std::uint32_t i : samples) {
        const Vec3 u = polynomials.metric(volume_, i)(volume_.corners[corner] - volume_.positions[i]);
        sum += polynomials.constants[i * polynomials.components + m] + polynomials.full_rise(i, m, u) - flat;
      }
      return samples.empty() ? 0.0 : sum / static_cast<double>(samples.size());
    };
    const double a = correction(near.own), b = correction(near.next);
    gain += a * a, doubt += kOuterDisagreement * (a - b) * (a - b);
  }
  return doubt > 0 ? doubt / (gain + doubt) : 0;
}

void LinearShare::evaluate(const CellLocation& location, const Vec3& x, std::span<double> values,
                           std::span<Vec3> gradients) const {
  if (interpolant_) return interpolant_->evaluate(location, x, values, gradients);
  std::array<Vec3, 8> slopes{};
  if (!gradients.empty()) shape_gradients(volume_, location, x, slopes);
  std::fill(values.begin(), values.end(), 0.0);
  std::fill(gradients.begin(), gradients.end(), Vec3{});
  for (std::size_t v = 0; v < location.corner_count; ++v) {
    const auto of = joint_.of(location.corners[v]);
    for (std::size_t m = 0; m < joint_.components; ++m) {
      values[m] += of[m] * location.weights[v];
      if (!gradients.empty()) gradients[m] += slopes[v] * of[m];
    }
  }
}

}  // namespace sansmesh::inline v1
