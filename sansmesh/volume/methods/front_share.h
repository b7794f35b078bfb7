// Fronts inside cells as a part of a field.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/kernels/support_kernels.h"
#include "sansmesh/volume/samples/cell_fronts.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// The fronts of samples with the supports of their polynomials: G = Σ w τ g / Σ w τ, likewise the values of both sides
/// and the width; the field is the front A + (B − A) ½ (1 + tanh(G / W)) with the share T = s(min(1, 10 Σ w τ / Σ w))
/// and the blend of the polynomials with 1 − T, where τ is the trust of a front and s(t) = t² (3 − 2t).
class FrontShare {
 public:
  /// All but `fronts` must outlive it.
  FrontShare(const SampledVolume& volume, const LocalPolynomials& polynomials, const SharedArray<float>& radii,
             CellFronts fronts)
      : volume_(volume), polynomials_(polynomials), radii_(radii), fronts_(std::move(fronts)) {}

  /// Per-thread buffers.
  struct Memory {
    std::vector<std::uint32_t> with;  ///< supports with fronts
    std::vector<detail::SupportTerm> terms;
    detail::SupportTile tile;
    std::vector<float> sums;  ///< sums of each quantity and their gradients, point by point
  };

  /// Whether one of the supports has a front.
  bool any(std::span<const std::uint32_t> supports) const;
  struct Request {
    Vec3 origin;                    ///< origin of the tile
    double base = 0;                ///< subtracted from values
    const double* level = nullptr;  ///< a function for this level set is wanted (LevelField)
    std::size_t n = 0;              ///< points
    bool gradient = false;
  };
  /// Replaces the blend at the points of the tile, whose weights are set, by the field: values and their gradients.
  void apply(std::span<const std::uint32_t> supports, const Request& request, const detail::SupportTile& all,
             std::span<double> values, std::span<Vec3> gradients, Memory& memory) const;

 private:
  const SampledVolume& volume_;
  const LocalPolynomials& polynomials_;
  const SharedArray<float>& radii_;
  CellFronts fronts_;
};

}  // namespace sansmesh::inline v1
