#include "sansmesh/approximation/generating_matrix.h"

#include <algorithm>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {

void check_options(const ApproximateMlsOptions& options, std::size_t samples, std::span<const double> values) {
  if (samples == 0) throw DataError("approximation: no samples");
  if (values.empty() || values.size() % samples != 0)
    throw ArgumentError("approximation: " + std::to_string(values.size()) + " values do not fit " +
                        std::to_string(samples) + " samples");
  if (options.iterations < 0) throw ArgumentError("approximation: the number of iterations must not be negative");
  if (!(options.cutoff > 0 && options.cutoff <= 0.1))
    throw ArgumentError("approximation: the cutoff must lie in (0, 0.1]");
  require_finite(values, values.size() / samples);
}

template <int D>
GeneratingMatrix generating_matrix(const SampleIndex<D>& samples, const LaguerreGaussian& phi, double radius,
                                   std::size_t max_entries) {
  const std::size_t n = samples.size();
  GeneratingMatrix k;
  k.row.assign(n + 1, 0);
  k.gaussian_sum.assign(n, 0.0);
  k.absolute_sum.assign(n, 0.0);
  using Hit = typename SampleIndex<D>::Hit;

  // The entries of some rows estimate whether the matrix fits.
  const std::size_t probes = std::min<std::size_t>(n, 64);
  double expected = 0;
  for (std::size_t i = 0; i < probes; ++i) {
    std::vector<Hit> hits;
    samples.within(samples.positions()[samples.order()[i * n / probes]], radius, hits);
    expected += static_cast<double>(hits.size()) / static_cast<double>(probes);
  }
  const auto too_many = [&] {
    throw DataError(
        "approximation: the supports hold too many samples each (raise the shape parameter or the cutoff, lower the "
        "spacing, or allow more entries)");
  };
  if (expected * static_cast<double>(n) > 4 * static_cast<double>(max_entries)) too_many();

  // One thread builds a block of rows; the blocks are concatenated afterwards.
  constexpr std::size_t kBlock = 1024;
  struct Block {
    std::vector<std::uint32_t> column;
    std::vector<double> value;
  };
  std::vector<Block> blocks((n + kBlock - 1) / kBlock);
  parallel_for(0, blocks.size(), 1, [&](std::size_t b) {
    std::vector<Hit> hits;
    Block& block = blocks[b];
    for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
      samples.within(samples.positions()[i], radius, hits);
      std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& c) { return a.index < c.index; });
      for (const Hit& hit : hits) {
        const double v = phi(hit.squared_distance);
        block.column.push_back(hit.index);
        block.value.push_back(v);
        k.gaussian_sum[i] += phi.gaussian(hit.squared_distance).value;
        k.absolute_sum[i] += std::abs(v);
      }
      k.row[i + 1] = hits.size();
      if (block.column.size() > max_entries) too_many();
    }
  });
  for (std::size_t i = 0; i < n; ++i) k.row[i + 1] += k.row[i];
  if (k.row[n] > max_entries) too_many();
  k.column.resize(k.row[n]);
  k.value.resize(k.row[n]);
  parallel_for(0, blocks.size(), 1, [&](std::size_t b) {
    const auto at = static_cast<std::ptrdiff_t>(k.row[b * kBlock]);
    std::copy(blocks[b].column.begin(), blocks[b].column.end(), k.column.begin() + at);
    std::copy(blocks[b].value.begin(), blocks[b].value.end(), k.value.begin() + at);
    blocks[b] = {};
  });
  return k;
}

void GeneratingMatrix::step(Normalisation normalisation, std::size_t c, std::span<double> residual,
                            std::span<double> scratch) const {
  const bool columns = normalisation == Normalisation::kSamples, rows = normalisation == Normalisation::kPartition;
  for (std::size_t i = 0; i < size(); ++i) {
    const double factor = columns ? inverse_divisor(gaussian_sum[i], absolute_sum[i]) : 1;
    for (std::size_t m = 0; m < c; ++m) scratch[i * c + m] = factor * residual[i * c + m];
  }
  parallel_for(0, size(), 512, [&](std::size_t i) {
    const double factor = rows ? inverse_divisor(gaussian_sum[i], absolute_sum[i]) : 1;
    if (c == 1) {
      double t = 0;
      for (std::size_t e = row[i]; e < row[i + 1]; ++e) t += value[e] * scratch[column[e]];
      residual[i] -= factor * t;
      return;
    }
    for (std::size_t m = 0; m < c; ++m) {
      double t = 0;
      for (std::size_t e = row[i]; e < row[i + 1]; ++e) t += value[e] * scratch[column[e] * c + m];
      residual[i * c + m] -= factor * t;
    }
  });
}

template GeneratingMatrix generating_matrix<1>(const SampleIndex<1>&, const LaguerreGaussian&, double, std::size_t);
template GeneratingMatrix generating_matrix<2>(const SampleIndex<2>&, const LaguerreGaussian&, double, std::size_t);
template GeneratingMatrix generating_matrix<3>(const SampleIndex<3>&, const LaguerreGaussian&, double, std::size_t);

}  // namespace sansmesh::inline v1::detail
