// A polynomial about every sample of a volume: what mls-detail blends (METHODS §6.1, §9).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/approximation/polynomial_order.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/shared_array.h"
#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/star_metric.h"
#include "sansmesh/volume/samples/stencil_fit.h"

namespace sansmesh::inline v1 {

/// p_i(x) = constant_i + Σ_{m >= 1} c_im monomial_m(u), u = M_i (x − x_i), monomials in the order of
/// PolynomialOrder<3>, degree 0..4. Plain arrays that are never changed, in memory or in a mapped file.
struct LocalPolynomials {
  static constexpr int kMaxDegree = 4;
  std::size_t components = 1;
  SharedArray<StarMetric> metrics;    ///< empty for a lattice
  SharedArray<double> constants;      ///< components a sample
  SharedArray<std::uint8_t> degrees;  ///< of a sample, the same for all components
  SharedArray<std::uint64_t> first;   ///< where in `coefficients` a sample begins; one more entry than samples
  SharedArray<float> coefficients;    ///< without the constants; component after component

  SharedArray<float> trust;  ///< of a sample, 0..1: how far it is more than linear interpolation

  std::size_t size() const { return degrees.size(); }
  /// p − constant at u; terms of degree 2 and more count by the factor `trust`.
  double rise(std::size_t sample, std::size_t component, const Vec3& u) const;
  /// The same whatever the trust.
  double full_rise(std::size_t sample, std::size_t component, const Vec3& u) const;
  /// M of a sample; lattices have no `metrics`.
  StarMetric metric(const SampledVolume& volume, std::size_t sample) const;
  std::span<const float> of(std::size_t sample, std::size_t component) const {
    const auto terms = static_cast<std::size_t>(monomial_count(3, degrees[sample]) - 1);
    return coefficients.view().subspan(first[sample] + component * terms, terms);
  }
};

struct LocalPolynomialOptions {
  StencilFitOptions fit;
  /// How much of f_i − p_i(x_i) is added to the constant: 1 interpolates.
  double share = 1;
  /// Whether polynomials are compared in the middles of cells, too, for the trust. Not of lattices.
  bool ask_in_cells = true;
};

/// Polynomials about all samples of a volume that is no lattice (docs/methods/volume-reconstruction.md): stencils are
/// as many whole rings of the mesh as hold twice the number of polynomials of the highest degree. Fits are about
/// samples and blended, not about each point as in `mls`: that is a thousand times fewer systems, the result is smooth,
/// and the degree is chosen where there is something to judge it by. Runs in parallel.
///
/// trust: half-way to each neighbour the polynomials of both are compared. With a = how far their mean is from linear
/// interpolation there and b = half their difference, summed over the star, trust is Σ a² / Σ (a² + 5/2 b² + g a²): a
/// correction of linear interpolation of size a whose error is of size b is best taken by such a share; where both are
/// rounding only, it is 1. The middles of the sample's cells count in both sums as much as its edges, b the difference
/// of the own polynomial to the mean of the corners' there (CellAgreement). Under-resolved data so end up at linear
/// interpolation. g > 0 where nothing but differences over much shorter edges tells of the second differences over an
/// edge, and a is large beside the differences of neighbours (docs/methods/volume-reconstruction.md): polynomials that
/// share their samples are wrong together there.
LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, Progress& progress);
/// The same in metrics that are known already.
LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, std::vector<StarMetric> metrics,
                                       Progress& progress);

/// A chunk of samples: what one thread appends, and what is put together in order.
struct PolynomialPart {
  std::vector<double> constants;
  std::vector<float> coefficients;
  std::vector<std::uint8_t> degrees, split;
};

/// See fit_local_polynomials. `split` tells which polynomials are of one side of a step.
std::vector<float> polynomial_trust(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& p,
                                    std::span<const std::uint8_t> split, bool in_cells);

/// The polynomials of all samples: `make` a fitter for a thread, append(fitter, sample, part) adds one.
template <class Part, class Make, class Append>
LocalPolynomials gather_polynomials(const SampledVolume& volume, const VolumeValues& values, Progress& progress,
                                    const Make& make, const Append& append, std::vector<StarMetric> metrics,
                                    bool ask_in_cells) {
  const std::size_t n = volume.size(), chunk = 2048, chunks = (n + chunk - 1) / chunk;
  std::vector<Part> parts(chunks);
  progress.begin("local polynomials", chunks);
  parallel_ranges(0, chunks, 8, [&](std::size_t begin, std::size_t end) {
    auto fitter = make();
    for (std::size_t p = begin; p < end; ++p) {
      for (std::size_t i = p * chunk; i < (p + 1 < chunks ? (p + 1) * chunk : n); ++i) append(fitter, i, parts[p]);
      progress.advance();
    }
  });
  Part all;
  std::vector<std::uint64_t> first;
  first.reserve(n + 1);
  first.push_back(0);
  std::size_t total = 0;
  for (const Part& part : parts) total += part.coefficients.size();
  all.coefficients.reserve(total), all.constants.reserve(n * values.components), all.degrees.reserve(n);
  for (Part& part : parts) {
    all.constants.insert(all.constants.end(), part.constants.begin(), part.constants.end());
    all.coefficients.insert(all.coefficients.end(), part.coefficients.begin(), part.coefficients.end());
    all.split.insert(all.split.end(), part.split.begin(), part.split.end());
    for (const std::uint8_t d : part.degrees) {
      all.degrees.push_back(d);
      first.push_back(first.back() + values.components * static_cast<std::uint64_t>(monomial_count(3, d) - 1));
    }
    part = {};
  }
  LocalPolynomials result;
  result.components = values.components;
  result.metrics = std::move(metrics);
  result.constants = std::move(all.constants);
  result.coefficients = std::move(all.coefficients);
  result.degrees = std::move(all.degrees);
  result.first = std::move(first);
  result.trust = polynomial_trust(volume, values, result, all.split, ask_in_cells);
  return result;
}

}  // namespace sansmesh::inline v1
