#include "sansmesh/volume/methods/amls_system.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/support_index.h"

namespace sansmesh::inline v1 {

AmlsShape AmlsShape::of_order(int order) {
  constexpr double d = kDecay;
  if (order == 4) return {2.5, -d, 0};
  if (order == 6) return {4.375, -3.5 * d, 0.5 * d * d};
  return {};
}

LocalPolynomials trusted(LocalPolynomials polynomials) {
  std::vector<float> coefficients = polynomials.coefficients.copy();
  parallel_for(0, polynomials.size(), 8192, [&](std::size_t i) {
    const auto terms = static_cast<std::size_t>(monomial_count(3, polynomials.degrees[i]) - 1);
    for (std::size_t m = 0; m < polynomials.components; ++m)
      for (std::size_t j = 3; j < terms; ++j)
        coefficients[polynomials.first[i] + m * terms + j] *= polynomials.trust[i];
  });
  polynomials.coefficients = std::move(coefficients);
  return polynomials;
}

void AmlsMatrix::multiply(std::span<const double> numbers, std::size_t c, std::size_t begin, std::size_t end,
                          std::span<double> products) const {
  parallel_for(begin, end, 1024, [&](std::size_t i) {
    if (c == 1) {
      double sum = 0;
      for (std::uint64_t e = first[i]; e < first[i + 1]; ++e)
        sum += static_cast<double>(shares[e]) * numbers[columns[e]];
      products[i] = sum;
      return;
    }
    for (std::size_t m = 0; m < c; ++m) products[i * c + m] = 0;
    for (std::uint64_t e = first[i]; e < first[i + 1]; ++e)
      for (std::size_t m = 0; m < c; ++m)
        products[i * c + m] += static_cast<double>(shares[e]) * numbers[columns[e] * c + m];
  });
}

AmlsMatrix amls_matrix(const SampledVolume& volume, const LocalPolynomials& local, std::span<const float> radii,
                       const AmlsShape& shape) {
  const std::size_t n = volume.size(), c = local.components;
  const SupportIndex index(volume, local.metrics.view(), radii);
  AmlsMatrix matrix;
  matrix.rises.resize(n * c);
  struct Part {
    std::vector<std::uint32_t> columns;
    std::vector<float> shares;
  };
  constexpr std::size_t kChunk = 4096;
  std::vector<Part> parts((n + kChunk - 1) / kChunk);
  std::vector<std::uint32_t> counts(n);
  parallel_ranges(0, parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    SupportIndex::Memory found;
    std::vector<double> rises(c), phis;
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t i = p * kChunk; i < std::min(n, (p + 1) * kChunk); ++i) {
        index.of_sample(static_cast<std::uint32_t>(i), found);
        const Vec3 x = volume.position(i);
        double weights = 0, sizes = 0;
        std::fill(rises.begin(), rises.end(), 0.0);
        phis.clear();
        for (const std::uint32_t j : found.supports) {
          const Vec3 u = local.metric(volume, j)(x - volume.position(j));
          const double radius = static_cast<double>(radii[j]), t = squared_norm(u) / (radius * radius);
          const double w = shape.weight(t), phi = w * shape.laguerre(t);
          weights += w, sizes += std::abs(phi);
          phis.push_back(phi);
          for (std::size_t m = 0; m < c; ++m) rises[m] += phi * amls_rise(local.of(j, m), u);
        }
        const double divisor = shape.divisor(weights, sizes), inverse = divisor > 1e-30 ? 1 / divisor : 0;
        for (std::size_t m = 0; m < c; ++m) matrix.rises[i * c + m] = rises[m] * inverse;
        Part& part = parts[p];
        part.columns.insert(part.columns.end(), found.supports.begin(), found.supports.end());
        for (const double phi : phis) part.shares.push_back(static_cast<float>(phi * inverse));
        counts[i] = static_cast<std::uint32_t>(phis.size());
      }
  });
  matrix.first.reserve(n + 1);
  for (const std::uint32_t count : counts) matrix.first.push_back(matrix.first.back() + count);
  matrix.columns.reserve(matrix.first.back()), matrix.shares.reserve(matrix.first.back());
  for (Part& part : parts) {
    matrix.columns.insert(matrix.columns.end(), part.columns.begin(), part.columns.end());
    matrix.shares.insert(matrix.shares.end(), part.shares.begin(), part.shares.end());
    part = {};
  }
  return matrix;
}

AmlsIteration::AmlsIteration(const AmlsMatrix& matrix, std::span<const double> values, std::size_t components)
    : matrix_(matrix),
      components_(components),
      g_(values.begin(), values.end()),
      residual_(values.size()),
      product_(values.size()) {
  matrix_.multiply(g_, components_, 0, matrix_.size(), product_);
  for (std::size_t i = 0; i < g_.size(); ++i) residual_[i] = values[i] - product_[i] - matrix_.rises[i];
}

void AmlsIteration::advance() {
  for (std::size_t i = 0; i < g_.size(); ++i) g_[i] += residual_[i];
  matrix_.multiply(residual_, components_, 0, matrix_.size(), product_);
  for (std::size_t i = 0; i < residual_.size(); ++i) residual_[i] -= product_[i];
}

}  // namespace sansmesh::inline v1
