// Polynomials at the samples of a volume, which mls-detail blends (tejada2008, 6.2).
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
/// PolynomialOrder<3>, degree 0..4. Immutable arrays in memory or in a mapped file.
struct LocalPolynomials {
  static constexpr int kMaxDegree = 4;
  std::size_t components = 1;
  SharedArray<StarMetric> metrics;    ///< empty for a lattice
  SharedArray<double> constants;      ///< all components of each sample
  SharedArray<std::uint8_t> degrees;  ///< per sample, the same for all components
  SharedArray<std::uint64_t> first;   ///< begin of each sample in `coefficients`; one more entry than samples
  SharedArray<float> coefficients;    ///< without the constants; grouped by component

  SharedArray<float> trust;  ///< per sample, 0..1: reliability of the terms beyond linear interpolation

  std::size_t size() const { return degrees.size(); }
  /// p − constant at u; terms of degree 2 and more are multiplied by `trust`.
  double rise(std::size_t sample, std::size_t component, const Vec3& u) const;
  /// The same without `trust`.
  double full_rise(std::size_t sample, std::size_t component, const Vec3& u) const;
  /// M of a sample, also for lattices, which have no `metrics`.
  StarMetric metric(const SampledVolume& volume, std::size_t sample) const;
  std::span<const float> of(std::size_t sample, std::size_t component) const {
    return in(coefficients.view(), sample, component);
  }
  /// The same part of other coefficients.
  std::span<const float> in(std::span<const float> all, std::size_t sample, std::size_t component) const {
    const auto terms = static_cast<std::size_t>(monomial_count(3, degrees[sample]) - 1);
    return all.subspan(first[sample] + component * terms, terms);
  }
};

struct LocalPolynomialOptions {
  StencilFitOptions fit;
  /// Share of f_i − p_i(x_i) that is added to the constant: 1 interpolates.
  double share = 1;
  /// Whether the trust also compares polynomials at cell centres. Not for lattices.
  bool ask_in_cells = true;
};

/// Fits polynomials at all samples of a volume that is no lattice (docs/methods/volume-reconstruction.md). A stencil
/// consists of as many whole rings of the mesh as contain twice the number of polynomials of the highest degree. Runs
/// in parallel.
///
/// trust: polynomials of neighbours are compared half-way between the samples and at cell centres (CellAgreement). With
/// a = correction of linear interpolation by their mean and b = half their difference, trust is Σ a² / Σ (a² + 5/2 b² +
/// g a²), the best share of a correction of size a with an error of size b; 1 if both are rounding. g > 0 where the
/// samples do not resolve the second differences along an edge. Σ c² (8 Σ c² / Σ a²)² is added to the denominator, c
/// the changes of a by the terms of the highest degree and against the correction from slopes alone. So under-resolved
/// data fall back on linear interpolation.
LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, Progress& progress);
/// The same with given metrics.
LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, std::vector<StarMetric> metrics,
                                       Progress& progress);

/// Polynomials of one chunk of samples, written by one thread and concatenated in order.
struct PolynomialPart {
  std::vector<double> constants;
  std::vector<float> coefficients;
  std::vector<float>
      lower;  ///< coefficients without the highest degree, if that is 3 or more, padded by zeros; or none
  std::vector<std::uint8_t> degrees, split;

  /// Appends a component of a sample: the value, corrected by the share of the residual that is not added, and the
  /// coefficients of the polynomial's monomials.
  void append_component(std::span<const double> monomials, double value, double share) {
    constants.push_back(value + (1 - share) * monomials[0]);
    for (const double m : monomials.subspan(1)) coefficients.push_back(static_cast<float>(m));
  }
  /// Appends the monomials of the lower degree of the component appended last.
  void append_lower(std::span<const double> monomials) {
    for (const double m : monomials.subspan(1)) lower.push_back(static_cast<float>(m));
    lower.resize(coefficients.size(), 0.0f);
  }
  /// Appends the polynomials of a sample with the given values, and on request those of lower degree.
  void append(const StencilFit& fit, std::span<const double> values, double share, bool with_lower) {
    for (std::size_t m = 0; m < values.size(); ++m) {
      append_component(fit.monomials(m), values[m], share);
      if (with_lower) append_lower(fit.lower_monomials(m));
    }
    degrees.push_back(static_cast<std::uint8_t>(fit.degree()));
    split.push_back(fit.split());
  }
};

/// See fit_local_polynomials. `lower`: coefficients of lower degree (PolynomialPart), or none. `split` marks one-sided
/// polynomials at steps.
std::vector<float> polynomial_trust(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& p,
                                    std::span<const float> lower, std::span<const std::uint8_t> split, bool in_cells);

/// Fits the polynomials of all samples: `make` creates a fitter per thread, append(fitter, sample, part) adds one.
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
  all.coefficients.reserve(total), all.lower.reserve(total), all.constants.reserve(n * values.components),
      all.degrees.reserve(n);
  for (Part& part : parts) {
    all.constants.insert(all.constants.end(), part.constants.begin(), part.constants.end());
    all.coefficients.insert(all.coefficients.end(), part.coefficients.begin(), part.coefficients.end());
    all.lower.insert(all.lower.end(), part.lower.begin(), part.lower.end());
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
  result.trust = polynomial_trust(volume, values, result, all.lower, all.split, ask_in_cells);
  return result;
}

}  // namespace sansmesh::inline v1
