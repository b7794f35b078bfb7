#include "sansmesh/approximation/moving_least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

template <int D>
struct MovingLeastSquares<D>::Scratch {
  explicit Scratch(double rank_tolerance) : fit({rank_tolerance}) {}
  OrthogonalFit<D> fit;
  std::vector<typename SampleIndex<D>::Hit> hits;
  std::vector<std::uint32_t> samples;
  std::array<std::vector<double>, D> positions;
  std::vector<double> values, weights, slopes, basis, shape;
};

template <int D>
MovingLeastSquares<D>::MovingLeastSquares(std::span<const Position<D>> positions, std::span<const double> values,
                                          const MovingLeastSquaresOptions& options)
    : options_(options), values_(values.begin(), values.end()) {
  if (options.degree < 0 || options.degree > OrthogonalFit<D>::kMaxDegree)
    throw ArgumentError("approximation: the degree of moving least squares must be 0 to " +
                        std::to_string(OrthogonalFit<D>::kMaxDegree) + ", not " + std::to_string(options.degree));
  if (options.radius && !(*options.radius > 0 && std::isfinite(*options.radius)))
    throw ArgumentError("approximation: the radius of the weights must be positive");
  if (options.neighbours && *options.neighbours == 0)
    throw ArgumentError("approximation: the weights must reach at least one neighbour");
  if (values.size() != positions.size()) throw ArgumentError("approximation: as many values as positions are needed");
  const OrthogonalFit<D> checked({options.rank_tolerance});
  require_finite(values);
  index_ = SampleIndex<D>(positions);

  const std::size_t n = positions.size();
  if (options.radius) {
    radii_.assign(n, *options.radius);
  } else {
    const std::size_t k =
        options.neighbours ? *options.neighbours : 3 * static_cast<std::size_t>(monomial_count(D, options.degree)) + 5;
    const double least = 0.5 * index_.spacing();  // for samples that coincide with all their neighbours
    radii_.resize(n);
    parallel_ranges(0, n, 256, [&](std::size_t first, std::size_t last) {
      std::vector<typename SampleIndex<D>::Hit> hits;
      for (std::size_t s = first; s < last; ++s) {
        const std::size_t i = index_.order()[s];
        index_.nearest(positions[i], k + 1, hits);
        double r2 = 0;
        for (const auto& hit : hits) r2 = std::max(r2, hit.squared_distance);
        // With fewer samples than neighbours the radius exceeds the distance of the farthest.
        const double reach = hits.size() < k + 1 ? 2 : 1;
        radii_[i] = r2 > 0 ? reach * std::sqrt(r2) : least;
      }
    });
  }
  // Each layer spans half an octave of radii.
  std::map<int, std::vector<std::uint32_t>> by_radius;
  for (std::size_t i = 0; i < n; ++i) {
    int octave = 0;
    const double part = std::frexp(radii_[i], &octave);
    by_radius[2 * octave + (part >= 0.70710678118654752 ? 1 : 0)].push_back(static_cast<std::uint32_t>(i));
  }
  for (auto& [key, samples] : by_radius) {
    Layer layer;
    std::vector<Position<D>> own;
    for (const std::uint32_t i : samples) {
      own.push_back(positions[i]);
      layer.radius = std::max(layer.radius, radii_[i]);
    }
    layer.index = SampleIndex<D>(own);
    layer.sample = std::move(samples);
    layers_.push_back(std::move(layer));
  }
}

template <int D>
void MovingLeastSquares<D>::evaluate_one(const Position<D>& x, Scratch& s, double& value, Position<D>* gradient,
                                         int& degree) const {
  if (gradient) gradient->fill(0);
  degree = -1;
  s.samples.clear(), s.values.clear(), s.weights.clear(), s.slopes.clear();
  for (auto& p : s.positions) p.clear();
  double reach = 0;
  for (const Layer& layer : layers_) {
    layer.index.within(x, layer.radius, s.hits);
    for (const auto& hit : s.hits) {
      const std::uint32_t i = layer.sample[hit.index];
      const RadialValue w = weight(options_.weight, hit.squared_distance, radii_[i]);
      if (!(w.value > std::numeric_limits<double>::min())) continue;
      s.samples.push_back(i);
      for (std::size_t k = 0; k < D; ++k) s.positions[k].push_back(index_.positions()[i][k]);
      s.values.push_back(values_[i]);
      s.weights.push_back(w.value);
      s.slopes.push_back(w.slope / w.value);
      reach = std::max(reach, hit.squared_distance);
    }
  }
  const std::size_t n = s.samples.size();
  if (n == 0) {
    index_.nearest(x, 1, s.hits);
    value = s.hits.empty() ? std::numeric_limits<double>::quiet_NaN() : values_[s.hits[0].index];
    return;
  }

  ApproximationSamples<D> samples;
  for (std::size_t k = 0; k < D; ++k) samples.positions[k] = s.positions[k];
  samples.values = s.values;
  samples.weights = s.weights;
  // The weights decrease so fast that most of their mass is within this part of the radius. With this scale norms do
  // not shrink from one degree to the next, which would look like cancellation.
  s.fit.reset(samples, ApproximationFrame<D>{x, reach > 0 ? 0.35 * std::sqrt(reach) : 1});
  degree = 0;
  while (degree < options_.degree && static_cast<std::size_t>(monomial_count(D, degree + 1)) <= n) ++degree;
  while (s.fit.size() < monomial_count(D, degree)) s.fit.add_polynomial();
  if (!gradient) {
    value = s.fit.value(x);
    return;
  }
  // The derivative of the polynomial, plus that of the minimum with respect to the weights: with the residuals r_i, Σ_j
  // ψ_j(x) ⟨∂w/w · r, ψ_j⟩ / ⟨ψ_j, ψ_j⟩.
  const ValueAndGradient<D> p = s.fit.value_and_gradient(x);
  value = p.value;
  *gradient = p.gradient;
  s.basis.resize(static_cast<std::size_t>(s.fit.size()));
  s.fit.basis(x, s.basis);
  s.shape.assign(n, 0.0);
  for (int j = 0; j < s.fit.size(); ++j) {
    if (s.fit.is_dropped(j)) continue;
    const double factor = s.basis[static_cast<std::size_t>(j)] / s.fit.squared_norm(j);
    const std::span<const double> row = s.fit.weighted_basis(j);
    for (std::size_t i = 0; i < n; ++i) s.shape[i] += factor * row[i];
  }
  const std::span<const double> residuals = s.fit.weighted_residuals();
  for (std::size_t i = 0; i < n; ++i) {
    const double t = s.slopes[i] * residuals[i] * s.shape[i];
    for (std::size_t k = 0; k < D; ++k) (*gradient)[k] += t * (x[k] - s.positions[k][i]);
  }
}

template <int D>
void MovingLeastSquares<D>::evaluate(std::span<const Position<D>> x, std::span<double> values,
                                     std::span<Position<D>> gradients, std::span<std::int8_t> degrees) const {
  if (values.size() != x.size() || !(gradients.empty() || gradients.size() == x.size()) ||
      !(degrees.empty() || degrees.size() == x.size()))
    throw ArgumentError("approximation: the sizes of values, gradients and degrees must match the number of points");
  parallel_ranges(0, x.size(), 64, [&](std::size_t first, std::size_t last) {
    Scratch scratch(options_.rank_tolerance);
    for (std::size_t i = first; i < last; ++i) {
      int degree = -1;
      evaluate_one(x[i], scratch, values[i], gradients.empty() ? nullptr : &gradients[i], degree);
      if (!degrees.empty()) degrees[i] = static_cast<std::int8_t>(degree);
    }
  });
}

template class MovingLeastSquares<1>;
template class MovingLeastSquares<2>;
template class MovingLeastSquares<3>;

}  // namespace sansmesh::inline v1
