#include "sansmesh/volume/samples/noise_variation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kNoiseTails = 2.5, kWithoutTails = 0.9113;  // variance of a normal deviate without its tails
constexpr std::size_t kFewest = 40;                          // pairs below which nothing can be said
constexpr double kLikeNoise = 0.05, kAlternating = -0.35, kSpreadOfPair = 0.6;
/// Share of a bin beyond 2.5 deviations (of the median) above which it is not normal: 0.012 for noise.
constexpr double kMostTails = 0.04;
/// Most residuals that are looked at by place.
constexpr std::size_t kMostByPlace = 15'000;
/// Residuals per bin of values or place, and how many of these are needed.
constexpr std::size_t kInBin = 400, kLeastBins = 4, kMostBins = 32;
/// Share of the variance of log |residual| that varying noise has to explain: at the first it counts for nothing.
constexpr double kNotVarying = 0.004, kVarying = 0.012;
/// Bounds of magnitudes, in deviations, in this variance: neither rounding nor steps may dominate.
constexpr double kLeastMagnitude = 0.05, kMostMagnitude = 4;
/// Factors of deviations are at most this apart from 1.
constexpr double kMostFactor = 16;

double limited_log(double magnitude, double deviation) {
  return std::log(std::clamp(magnitude / deviation, kLeastMagnitude, kMostMagnitude));
}

double limited_factor(double f) { return std::clamp(f, 1 / kMostFactor, kMostFactor); }

/// How much of a varying deviation to use, 0 to 1. `of` gives the factor at a residual, fitted in `bins` bins.
template <class Factor>
double use_of(const std::vector<NoiseResidual>& residuals, double deviation, double rounding, std::size_t bins,
              const Factor& of) {
  double n = 0, mean = 0, mean_with = 0, square = 0, square_with = 0;
  for (const NoiseResidual& r : residuals) {
    const double size = std::abs(r.residual);
    if (!(size > rounding)) continue;
    const double a = limited_log(size, deviation), b = limited_log(size, deviation * of(r));
    ++n;
    const double da = a - mean, db = b - mean_with;
    mean += da / n, mean_with += db / n;
    square += da * (a - mean), square_with += db * (b - mean_with);
  }
  if (!(square > 0)) return 0;
  const double gain = 1 - square_with / square - static_cast<double>(bins) / n;
  return std::clamp((gain - kNotVarying) / (kVarying - kNotVarying), 0.0, 1.0);
}

/// Non-decreasing numbers with the least sum of distances from the given ones: medians of pooled neighbours.
std::vector<double> monotone_medians(const std::vector<double>& of) {
  std::vector<std::vector<double>> blocks;
  std::vector<double> levels;
  for (const double v : of) {
    blocks.push_back({v}), levels.push_back(v);
    while (levels.size() > 1 && levels[levels.size() - 2] > levels.back()) {
      std::vector<double> last = std::move(blocks.back());
      blocks.pop_back(), levels.pop_back();
      blocks.back().insert(blocks.back().end(), last.begin(), last.end());
      last = blocks.back();
      levels.back() = median(last);
    }
  }
  std::vector<double> result;
  for (std::size_t b = 0; b < blocks.size(); ++b) result.insert(result.end(), blocks[b].size(), levels[b]);
  return result;
}

/// The same, non-decreasing or non-increasing, whichever is nearer.
std::vector<double> monotone(const std::vector<double>& of) {
  const auto distance = [&](const std::vector<double>& to) {
    double sum = 0;
    for (std::size_t i = 0; i < of.size(); ++i) sum += std::abs(of[i] - to[i]);
    return sum;
  };
  std::vector<double> up = monotone_medians(of), down(of.rbegin(), of.rend());
  down = monotone_medians(down);
  std::reverse(down.begin(), down.end());
  return distance(down) < distance(up) ? down : up;
}

/// Partners of each residual in its pairs.
std::vector<std::array<std::uint32_t, 2>> partners_of(std::size_t n, const std::vector<ResidualPair>& pairs) {
  constexpr std::uint32_t kUnpaired = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::array<std::uint32_t, 2>> partners(n, {kUnpaired, kUnpaired});
  for (const ResidualPair& p : pairs) {
    auto& of = partners[p.first];
    (of[0] == kUnpaired ? of[0] : of[1]) = p.second;
  }
  return partners;
}

/// True if the share of large numbers is that of normal deviates; steps add more.
bool without_tails(std::vector<double> magnitudes) {
  const double most = kNoiseTails * kDeviationOverMedian * median(magnitudes);
  const auto large = std::count_if(magnitudes.begin(), magnitudes.end(), [&](double m) { return m > most; });
  return static_cast<double>(large) <= kMostTails * static_cast<double>(magnitudes.size());
}

/// Deviation of the residuals with these numbers; 0 if they are those of structure or steps, or too few.
double deviation_in_bin(const std::vector<NoiseResidual>& residuals, std::span<const std::uint32_t> bin,
                        const std::vector<std::array<std::uint32_t, 2>>& partners, double rounding) {
  std::vector<double> magnitudes;
  for (const std::uint32_t i : bin)
    if (const double r = std::abs(residuals[i].residual); r > rounding) magnitudes.push_back(r);
  if (magnitudes.size() < kInBin / 2 || !without_tails(magnitudes)) return 0;
  const double s = trimmed_deviation(std::move(magnitudes));
  SignCorrelation signs;
  for (const std::uint32_t i : bin)
    for (const std::uint32_t j : partners[i])
      if (j < residuals.size()) signs.add(residuals[i].residual, residuals[j].residual, s, rounding);
  return signs.known() && !signs.unlike_noise() ? s : 0;
}

/// The smallest difference of values of which all are multiples, as of integers; 0 if there is none.
double quantum_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 3) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) least = std::min(least, values[i] - values[i - 1]);
  const double steps = (values.back() - values.front()) / least;
  if (!(steps < 70000)) return 0;
  // Rounding of the least difference adds up over many steps.
  const double quantum = (values.back() - values.front()) / std::round(steps);
  for (const double v : values) {
    const double n = (v - values.front()) / quantum;
    if (std::abs(n - std::round(n)) > 0.02) return 0;
  }
  return quantum;
}

}  // namespace

bool are_two_groups(std::vector<double>& numbers) {
  constexpr double kExplained = 0.8;
  std::sort(numbers.begin(), numbers.end());
  const auto n = static_cast<double>(numbers.size());
  double sum = 0, squares = 0, lower = 0, best = 0;
  for (const double v : numbers) sum += v;
  for (const double v : numbers) squares += (v - sum / n) * (v - sum / n);
  for (std::size_t i = 0; i + 1 < numbers.size(); ++i) {
    lower += numbers[i] - sum / n;
    const auto k = static_cast<double>(i + 1);
    best = std::max(best, lower * lower * n / (k * (n - k)));
  }
  return best > kExplained * squares;
}

bool is_above_rounding(double deviation, std::vector<double> values) {
  constexpr double kQuanta = 0.6;
  return deviation > kQuanta * quantum_of(std::move(values));
}

double NoiseByValue::at(double value) const {
  if (empty()) return 1;
  const auto next = static_cast<std::size_t>(std::upper_bound(values.begin(), values.end(), value) - values.begin());
  if (next == 0) return factors.front();
  if (next == values.size()) return factors.back();
  const double t = (value - values[next - 1]) / (values[next] - values[next - 1]);
  return factors[next - 1] + t * (factors[next] - factors[next - 1]);
}

double NoiseByPlace::at(const Vec3& position) const {
  if (empty()) return 1;
  std::array<std::size_t, 3> first{};
  std::array<double, 3> t{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (nodes[k] < 2) continue;
    const auto last = static_cast<double>(nodes[k] - 1);
    const double u = std::clamp((position[k] - box.lower[k]) / box.size()[k], 0.0, 1.0) * last;
    first[k] = std::min(static_cast<std::size_t>(u), nodes[k] - 2);
    t[k] = u - static_cast<double>(first[k]);
  }
  double sum = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    double weight = 1;
    std::size_t node = 0, step = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const bool upper = (c >> k & 1) != 0;
      weight *= upper ? t[k] : 1 - t[k];
      node += std::min(first[k] + (upper ? 1 : 0), nodes[k] - 1) * step;
      step *= nodes[k];
    }
    sum += weight * factors[node];
  }
  return sum;
}

double trimmed_deviation(std::vector<double> magnitudes) {
  if (magnitudes.empty()) return 0;
  std::sort(magnitudes.begin(), magnitudes.end());
  std::vector<double> squares(magnitudes.size() + 1);
  for (std::size_t i = 0; i < magnitudes.size(); ++i) squares[i + 1] = squares[i] + magnitudes[i] * magnitudes[i];
  double s = kDeviationOverMedian * magnitudes[magnitudes.size() / 2];
  for (int again = 0; again < 50 && s > 0; ++again) {
    const auto n = static_cast<std::size_t>(std::upper_bound(magnitudes.begin(), magnitudes.end(), kNoiseTails * s) -
                                            magnitudes.begin());
    const double next = n > 0 ? std::sqrt(squares[n] / (static_cast<double>(n) * kWithoutTails)) : 0;
    if (std::abs(next - s) <= 1e-6 * s) return next;
    s = next;
  }
  return s;
}

void SignCorrelation::add(double a, double b, double deviation, double rounding) {
  const double square = a * a + b * b;
  if (!(square <= 2 * (kNoiseTails * deviation) * (kNoiseTails * deviation))) return;
  if (std::max(std::abs(a), std::abs(b)) <= rounding) return;
  sum_ += 2 * a * b / square, ++count_;
}

bool SignCorrelation::known() const { return count_ >= kFewest; }

bool SignCorrelation::like_noise() const {
  return mean() + kSpreadOfPair / std::sqrt(static_cast<double>(count_)) <= kLikeNoise && mean() >= kAlternating;
}

bool SignCorrelation::unlike_noise() const {
  const double spread = 2 * kSpreadOfPair / std::sqrt(static_cast<double>(count_));
  return mean() - spread > kLikeNoise || mean() + spread < kAlternating;
}

NoiseByValue noise_by_value(const std::vector<NoiseResidual>& residuals, const std::vector<ResidualPair>& pairs,
                            double deviation, double rounding) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < residuals.size(); ++i)
    if (std::abs(residuals[i].residual) > rounding) order.push_back(i);
  const std::size_t bins = std::min(order.size() / kInBin, kMostBins);
  if (bins < kLeastBins || !(deviation > 0)) return {};
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(residuals[a].value, a) < std::pair(residuals[b].value, b);
  });
  const auto partners = partners_of(residuals.size(), pairs);
  NoiseByValue curve;
  std::vector<double> logs;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = b * order.size() / bins, last = (b + 1) * order.size() / bins;
    const double s = deviation_in_bin(residuals, std::span(order).subspan(first, last - first), partners, rounding);
    const double value = residuals[order[(first + last) / 2]].value;
    if (!(s > 0) || (!curve.empty() && value <= curve.values.back())) continue;
    curve.values.push_back(value), logs.push_back(std::log(limited_factor(s / deviation)));
  }
  if (2 * logs.size() < bins || logs.size() < kLeastBins) return {};
  logs = monotone(logs);
  for (const double l : logs) curve.factors.push_back(std::exp(l));
  const double use =
      use_of(residuals, deviation, rounding, bins, [&](const NoiseResidual& r) { return curve.at(r.value); });
  if (!(use > 0)) return {};
  for (std::size_t i = 0; i < logs.size(); ++i) curve.factors[i] = std::exp(use * logs[i]);
  return curve;
}

NoiseByPlace noise_by_place(const std::vector<NoiseResidual>& residuals, const std::vector<ResidualPair>& pairs,
                            const Box3& box, double deviation, double rounding) {
  std::vector<std::uint32_t> used;
  for (std::uint32_t i = 0; i < residuals.size(); ++i)
    if (std::abs(residuals[i].residual) > rounding) used.push_back(i);
  // Nodes and the work at each grow with the residuals, which arrays of many components have many of.
  if (const std::size_t step = (used.size() + kMostByPlace - 1) / kMostByPlace; step > 1) {
    for (std::size_t k = 0; k * step < used.size(); ++k) used[k] = used[k * step];
    used.resize((used.size() + step - 1) / step);
  }
  const std::size_t bins = used.size() / kInBin;
  if (bins < 2 * kLeastBins || !(deviation > 0)) return {};
  NoiseByPlace map;
  map.box = box;
  // Neighbouring nodes share residuals.
  const auto nodes = static_cast<std::size_t>(std::lround(1 + 1.2 * std::cbrt(static_cast<double>(bins))));
  for (std::size_t k = 0; k < 3; ++k) map.nodes[k] = box.size()[k] > 0 ? nodes : 1;
  const auto partners = partners_of(residuals.size(), pairs);
  std::vector<double> logs(map.nodes[0] * map.nodes[1] * map.nodes[2], std::numeric_limits<double>::quiet_NaN());
  const auto of_axis = [&](double x, std::size_t k) {
    return map.nodes[k] > 1 ? (x - box.lower[k]) / box.size()[k] : 0;
  };
  parallel_for(0, logs.size(), 1, [&](std::size_t node) {
    std::array<double, 3> at{};
    for (std::size_t k = 0, rest = node; k < 3; rest /= map.nodes[k], ++k)
      if (map.nodes[k] > 1) at[k] = static_cast<double>(rest % map.nodes[k]) / static_cast<double>(map.nodes[k] - 1);
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const std::uint32_t i : used) {
      double square = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = of_axis(residuals[i].position[k], k) - at[k];
        square += d * d;
      }
      near.emplace_back(square, i);
    }
    std::nth_element(near.begin(), near.begin() + (kInBin - 1), near.end());
    std::vector<std::uint32_t> bin;
    bin.reserve(kInBin);
    for (std::size_t j = 0; j < kInBin; ++j) bin.push_back(near[j].second);
    if (const double s = deviation_in_bin(residuals, bin, partners, rounding); s > 0)
      logs[node] = std::log(limited_factor(s / deviation));
  });
  std::vector<double> known;
  for (const double l : logs)
    if (!std::isnan(l)) known.push_back(l);
  if (2 * known.size() < logs.size()) return {};
  const double usual = median(known);
  for (double& l : logs) {
    if (std::isnan(l)) l = usual;
    map.factors.push_back(std::exp(l));
  }
  const double use =
      use_of(residuals, deviation, rounding, bins, [&](const NoiseResidual& r) { return map.at(r.position); });
  if (!(use > 0)) return {};
  for (std::size_t i = 0; i < logs.size(); ++i) map.factors[i] = std::exp(use * logs[i]);
  return map;
}

}  // namespace sansmesh::inline v1
