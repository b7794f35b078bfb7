// Least-squares fits of a bivariate polynomial to the samples of one support, for all degrees at once.
#pragma once

#include <array>
#include <vector>

#include "sansmesh/partition/local_function.h"

namespace sansmesh::inline v1 {

/// Samples of one support in its local frame, divided by the scale; a reusable structure of arrays.
class LocalSamples {
 public:
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  void add(float u, float v, float w, float weight) {
    if (size_ + kPadding > data_[0].size())
      for (auto& d : data_) d.resize(2 * size_ + 64);
    data_[0][size_] = u, data_[1][size_] = v, data_[2][size_] = w, data_[3][size_] = weight;
    ++size_;
  }
  float* u() { return data_[0].data(); }
  float* v() { return data_[1].data(); }
  float* w() { return data_[2].data(); }
  float* weight() { return data_[3].data(); }
  const float* u() const { return data_[0].data(); }
  const float* v() const { return data_[1].data(); }
  const float* w() const { return data_[2].data(); }
  const float* weight() const { return data_[3].data(); }
  /// Room for n samples and a vector more; they are written to the rows, and then counted by resize().
  void reserve(std::size_t n) {
    if (n + kPadding > data_[0].size())
      for (auto& d : data_) d.resize(2 * n + 64);
  }
  void resize(std::size_t n) { size_ = n; }
  /// Pads to a whole number of SIMD vectors with samples of weight 0.
  void pad() {
    const std::size_t n = size_;
    while (size_ % 8 != 0) add(0, 0, 0, 0);
    size_ = n;
  }

 private:
  static constexpr std::size_t kPadding = 16;
  std::array<std::vector<float>, 4> data_;
  std::size_t size_ = 0;
};

/// Result of fit_all_degrees: entry d belongs to degree d.
struct DegreeFits {
  int highest = -1;                                  ///< highest degree fitted; -1: not even a constant
  double weight_sum = 0;                             ///< Σ w_i
  double effective_count = 0;                        ///< (Σ w_i)² / Σ w_i²
  std::array<double, kMaxDegree + 1> mean_square{};  ///< Σ w_i r_i² / Σ w_i, in units of scale²
  std::array<double, 15> y{};                        ///< coefficients in the orthonormal basis
  std::array<std::array<double, 15>, 15> l{};        ///< rows of the basis change (lower triangular)
};

/// Weighted least squares of w over (u, v) for every degree 0..max_degree. Stops below the first degree that the
/// samples do not determine (fewer than 2 samples per basis function, or a basis function that vanishes on them).
DegreeFits fit_all_degrees(LocalSamples& samples, int max_degree);

/// Monomial coefficients of the fit of one degree (<= fits.highest).
std::array<float, 15> monomial_coefficients(const DegreeFits& fits, int degree);

}  // namespace sansmesh::inline v1
