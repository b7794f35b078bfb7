// Noise that grows with the signal or differs from place to place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Factors of a deviation by the value: linear between the knots, constant beyond. Empty: 1 everywhere.
struct NoiseByValue {
  std::vector<double> values;   ///< strictly increasing (unit of the array)
  std::vector<double> factors;  ///< monotone

  bool empty() const { return values.empty(); }
  double at(double value) const;
};

/// Factors of a deviation by the place: trilinear between equidistant nodes. Empty: 1 everywhere.
struct NoiseByPlace {
  Box3 box;
  std::array<std::size_t, 3> nodes{};
  std::vector<double> factors;  ///< node i + nx (j + ny k)

  bool empty() const { return factors.empty(); }
  double at(const Vec3& position) const;
};

/// What is known of the noise at a sample: the value predicted from its neighbours, and the residual of this
/// prediction, which is NaN beside steps.
struct NoiseResidual {
  double value = 0, residual = 0;
  Vec3 position;
};

/// Residuals of neighbours, which have the same sign where structure is not resolved.
struct ResidualPair {
  std::uint32_t first = 0, second = 0;
};

/// True if numbers are those of both sides of a step, whatever the noise: two groups explain most of their variance. Of
/// normal deviates they explain 0.64, of a slope 0.75, of a step of six deviations 0.9. Sorts them.
bool are_two_groups(std::vector<double>& numbers);

/// True if noise of values like these is more than rounding to multiples of their smallest difference, as to integers.
bool is_above_rounding(double deviation, std::vector<double> values);

/// Deviation of normal deviates with other, larger numbers among them: the variance of those within 2.5 deviations.
double trimmed_deviation(std::vector<double> magnitudes);

/// Mean of 2ab / (a² + b²) over residuals that differ from rounding and are no tails.
class SignCorrelation {
 public:
  void add(double a, double b, double deviation, double rounding);
  /// Whether there are enough pairs.
  bool known() const;
  double mean() const { return sum_ / static_cast<double>(count_); }
  /// Whether independent residuals may have this correlation. Those of a fit without the sample are slightly opposite.
  bool like_noise() const;
  /// Whether independent residuals hardly have it.
  bool unlike_noise() const;

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

/// How the deviation depends on the value: deviations of residuals with similar values, without those that
/// unresolved structure causes, and with the monotone curve of least sum of distances through their logarithms. Empty
/// if it explains less than 0.4 % of the variance of log |residual|; up to 1.2 % the curve is flattened.
NoiseByValue noise_by_value(const std::vector<NoiseResidual>& residuals, const std::vector<ResidualPair>& pairs,
                            double deviation, double rounding);
/// How it depends on the place, from the residuals nearest to each node of a lattice in `box`.
NoiseByPlace noise_by_place(const std::vector<NoiseResidual>& residuals, const std::vector<ResidualPair>& pairs,
                            const Box3& box, double deviation, double rounding);

}  // namespace sansmesh::inline v1
