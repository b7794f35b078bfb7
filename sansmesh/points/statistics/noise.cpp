#include "sansmesh/points/statistics/noise.h"

#include <fmt/core.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/points/statistics/neighbourhood_sample.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kNeighbourhoods = 320;
constexpr std::array<std::size_t, 9> kScales{24, 34, 48, 68, 96, 136, 192, 272, 384};
constexpr std::size_t kCoefficients = 6;
/// d log(residual) / d log(size): about 0 for noise, 1.5 for the cubic terms of a smooth surface, at least 0.5 for
/// creases and details of all sizes. Below this value there is significant noise.
constexpr double kSlopeWithoutNoise = 0.6;
/// Up to this slope the residual is noise with hardly any shape.
constexpr double kSlopeOfNoise = 0.3;
/// Negligible deviation relative to the distance of the nearest samples, whatever its cause.
constexpr double kLittle = 0.1;
/// Coordinates are quantised if there are this many times fewer values than samples, and the nearest neighbours deviate
/// from the surface by less than this share of a step.
constexpr std::size_t kFewValues = 50, kMostValues = 100000;
constexpr double kSameStep = 0.1, kStepOfSpacing = 0.2;
/// Larger growth of the residual since the smallest scale is shape at any slope.
constexpr double kLargestGrowth = 4;

struct Quadric {
  std::vector<std::array<double, kCoefficients>> rows;
  std::vector<double> heights, weights, residuals, magnitudes;
};

// Robust deviation of the samples from their quadric: least squares, then reweighted without outliers. Median absolute
// deviation, unbiased for Gaussian noise and for the number of coefficients.
std::optional<double> residual_deviation(const Neighbourhood& neighbourhood, std::size_t size, Quadric& q) {
  const std::span<const Vec3f> offsets = std::span(neighbourhood.offsets).first(size);
  const double radius = neighbourhood.distances[size - 1];
  if (!(radius > 0)) return std::nullopt;
  const Moments m = moments(offsets);
  const PrincipalAxes frame = principal_axes(m.covariance);
  const Vec3 center = frame.axes[0] * dot(frame.axes[0], m.mean);
  q.rows.clear();
  q.heights.clear();
  for (const Vec3f& offset : offsets) {
    const Vec3 d = (Vec3(offset) - center) / radius;
    const double u = dot(d, frame.axes[2]), v = dot(d, frame.axes[1]);
    // The ball truncates the noise near its rim: a narrower disc has the full range of heights.
    if (u * u + v * v > 0.64) continue;
    q.rows.push_back({1, u, v, u * u, u * v, v * v});
    q.heights.push_back(dot(d, frame.axes[0]));
  }
  const std::size_t n = q.rows.size();
  if (n < 2 * kCoefficients) return std::nullopt;
  q.weights.assign(n, 1);
  q.residuals.resize(n);
  double deviation = 0;
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix<double, kCoefficients, kCoefficients> normal_matrix;
    Eigen::Matrix<double, kCoefficients, 1> right;
    normal_matrix.setZero();
    right.setZero();
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Map<const Eigen::Matrix<double, kCoefficients, 1>> row(q.rows[i].data());
      normal_matrix.noalias() += q.weights[i] * row * row.transpose();
      right += q.weights[i] * q.heights[i] * row;
    }
    // Samples on few scan lines do not determine a quadric: regularisation selects the smallest coefficients.
    normal_matrix.diagonal().array() += 1e-9 * static_cast<double>(n);
    const Eigen::Matrix<double, kCoefficients, 1> c = normal_matrix.ldlt().solve(right);
    q.magnitudes.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Map<const Eigen::Matrix<double, kCoefficients, 1>> row(q.rows[i].data());
      q.residuals[i] = q.heights[i] - row.dot(c);
      q.magnitudes[i] = std::abs(q.residuals[i]);
    }
    deviation = kDeviationOverMedian * median(q.magnitudes) *
                std::sqrt(static_cast<double>(n) / static_cast<double>(n - kCoefficients));
    for (std::size_t i = 0; i < n; ++i) q.weights[i] = tukey_weight(q.residuals[i] / (4.685 * deviation + 1e-12));
  }
  return deviation * radius;
}

/// Approximate edge of the square that a sample covers.
double nearest_spacing(const std::vector<Neighbourhood>& sample) {
  std::vector<double> spacings;
  for (const Neighbourhood& n : sample)
    if (n.distances.size() > kScales[0])
      spacings.push_back(static_cast<double>(n.distances[kScales[0]]) *
                         std::sqrt(std::numbers::pi / static_cast<double>(kScales[0])));
  return median(spacings);
}

/// Step of the coordinate with the fewest distinct values, if neighbours share it; else 0.
double step_of_coordinates(const PointSet& points, double residual, double spacing) {
  double largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float> values;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / kMostValues)
      if (std::isfinite(points.positions[i][k])) values.push_back(points.positions[i][k]);
    const std::size_t all = values.size();
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    if (values.size() < 3 || values.size() * kFewValues > all) continue;
    std::vector<float> steps;
    for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
    const auto step = static_cast<double>(median(steps));
    if (step > kStepOfSpacing * spacing && residual < kSameStep * step) largest = std::max(largest, step);
  }
  return largest;
}

}  // namespace

double estimate_noise(const PointSet& points) { return measure_noise(points).deviation; }

NoiseEstimate measure_noise(const PointSet& points) {
  const std::vector<Neighbourhood> sample = sample_neighbourhoods(points.positions, kNeighbourhoods, kScales.back());
  std::vector<std::array<std::optional<double>, kScales.size()>> residuals(sample.size());
  parallel_ranges(0, sample.size(), 16, [&](std::size_t first, std::size_t last) {
    Quadric scratch;
    for (std::size_t p = first; p < last; ++p)
      for (std::size_t s = 0; s < kScales.size(); ++s)
        if (sample[p].offsets.size() >= kScales[s])
          residuals[p][s] = residual_deviation(sample[p], kScales[s], scratch);
  });

  // Typical residual per scale, over the scales that most neighbourhoods reach.
  std::vector<double> scale, deviation;
  float largest_coordinate = 0;
  for (const Neighbourhood& n : sample)
    for (std::size_t k = 0; k < 3; ++k) largest_coordinate = std::max(largest_coordinate, std::abs(n.center[k]));
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * static_cast<double>(largest_coordinate);
  for (std::size_t s = 0; s < kScales.size(); ++s) {
    std::vector<double> values;
    for (const auto& residual : residuals)
      if (residual[s]) values.push_back(*residual[s]);
    if (values.empty() || values.size() * 2 < sample.size()) break;
    scale.push_back(std::log(static_cast<double>(kScales[s])));
    deviation.push_back(std::max(median(values), rounding));
  }
  NoiseEstimate result;
  if (deviation.empty()) return result;
  const double spacing = nearest_spacing(sample);
  result.step = step_of_coordinates(points, deviation[0], spacing);
  result.most = std::max(deviation[0], result.step / std::sqrt(12.0));
  const bool little = result.most < kLittle * spacing;
  result.known = little;
  if (deviation[0] <= rounding) return result;
  if (deviation.size() == 1) {  // too few samples to separate shape from noise
    result.deviation = deviation[0];
    return result;
  }

  double smallest_slope = kSlopeWithoutNoise, noise = 0;
  for (std::size_t s = 1; s < deviation.size() && deviation[s] <= kLargestGrowth * deviation[0]; ++s) {
    const double slope = std::max(0.0, std::log(deviation[s] / deviation[s - 1]) / (scale[s] - scale[s - 1]));
    if (slope >= smallest_slope) continue;
    smallest_slope = slope;
    // Remaining growth is due to shape: subtracts its share of the variance.
    noise = std::sqrt(deviation[s] * deviation[s - 1] * (1 - slope / kSlopeWithoutNoise));
  }
  result.deviation = noise;
  result.most = std::max(result.most, noise);
  result.known = little || (smallest_slope < kSlopeOfNoise && noise > 0.5 * result.step);
  return result;
}

std::string noise_words(const NoiseEstimate& noise, double spacing) {
  if (!noise.known && !(noise.most > 0)) return "unknown: too few samples";
  if (noise.step > 0 && !noise.known) return fmt::format("unknown: coordinates come in steps of {:.4g}", noise.step);
  if (!noise.known) return fmt::format("unknown: {:.4g} at most, which may be shape or noise", noise.most);
  if (noise.deviation > 0.005 * spacing) return fmt::format("{:.4g}", noise.deviation);
  return fmt::format("less than {:.1g}", std::max(noise.most, 1e-6 * spacing));
}

namespace {

constexpr ReportRow kNoiseEstimateRows[] = {
    reported<&NoiseEstimate::deviation>(
        {.name = "noise", .text = "Standard deviation of the samples off the surface", .unit = "length"}),
    reported<&NoiseEstimate::known>({.name = "noise_known", .text = "Whether noise and shape are distinguishable"}),
    reported<&NoiseEstimate::most>({.name = "most_noise", .text = "Upper bound of the noise", .unit = "length"})};

}  // namespace

const ReportSchema& NoiseEstimate::schema() {
  static constexpr ReportSchema schema{kNoiseEstimateRows};
  return schema;
}

}  // namespace sansmesh::inline v1
