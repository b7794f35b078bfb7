// Samples for the tests of approximations.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::test {

inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

template <int D>
std::vector<Position<D>> random_positions(std::size_t n, unsigned seed, double low = 0, double high = 1) {
  std::mt19937 random(seed);
  std::vector<Position<D>> x(n);
  for (auto& p : x)
    for (double& v : p) v = uniform(random, low, high);
  return x;
}

/// The grid {low + i h} with n samples an axis.
template <int D>
std::vector<Position<D>> grid(std::size_t n, double low, double h) {
  std::size_t count = 1;
  for (int k = 0; k < D; ++k) count *= n;
  std::vector<Position<D>> x(count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0, rest = i; k < D; ++k, rest /= n) x[i][k] = low + h * static_cast<double>(rest % n);
  return x;
}

template <int D>
double smooth(const Position<D>& x) {
  double s = 0.4, t = 1;
  for (std::size_t k = 0; k < D; ++k) {
    s += (1.0 + 0.5 * static_cast<double>(k)) * x[k];
    t *= std::cos(1.3 * x[k] - 0.2);
  }
  return std::sin(2 * s) + t;
}

template <int D, class F>
std::vector<double> sampled(const std::vector<Position<D>>& x, F&& f) {
  std::vector<double> values;
  for (const auto& p : x) values.push_back(f(p));
  return values;
}

/// Central difference of a scalar function of a position.
template <int D, class F>
double difference(F&& f, Position<D> x, std::size_t k, double h) {
  x[k] += h;
  const double ahead = f(x);
  x[k] -= 2 * h;
  return (ahead - f(x)) / (2 * h);
}

}  // namespace sansmesh::test
