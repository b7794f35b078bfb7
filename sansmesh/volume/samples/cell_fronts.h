// Fronts inside cells: smooth surfaces that divide the cells of means of two values.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// The front at a sample: low + (high − low) ½ (1 + tanh(g / width)), with g(u) = constant + Σ g_m monomial_m(u) the
/// approximate signed distance from the front (length), u = M (x − x_i) in the local metric.
struct CellFront {
  float constant = 0;
  std::array<float, 9> g{};  ///< monomials of degree 1 and 2, in the order of PolynomialOrder<3>
  double low = 0, high = 0;  ///< values on both sides
  float width = 0;           ///< length
  float size = 0;            ///< extent of the cell across the front (length)
  float trust = 0;           ///< 0..1
};

/// The fronts of a volume. Only samples near a front have one.
struct CellFronts {
  std::vector<CellFront> fronts;
  std::vector<std::uint32_t> of;  ///< per sample: number of its front, or kNone; empty without fronts
  static constexpr std::uint32_t kNone = 0xffffffffu;
};

/// Finds the fronts of cell means (volume of fluid: the share of a cell behind the front is its mean between the values
/// of both sides). About each sample whose polynomial has little trust the two values, position, normal, curvatures and
/// width of a front are fitted to the means of a stencil by least squares, with the exact shares of cells behind
/// planes. The trust falls to 0 as the deviation of the means from the fit grows to a twelfth of the difference of the
/// values, and as the front leaves the cell of the sample and its next neighbours. One component; with `logarithm` the
/// values are logarithms of means. Runs in parallel.
CellFronts find_cell_fronts(const SampledVolume& volume, const VolumeValues& values,
                            const LocalPolynomials& polynomials, bool logarithm);

}  // namespace sansmesh::inline v1
