#include "sansmesh/approximation/approximate_mls_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/approximation/generating_matrix.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

// The iteration without a sample is carried out where φ exceeds this fraction of its peak around the sample.
constexpr double kPatch = 1e-2;

// Part of the cloud that represents the whole, and the indices of the samples to leave out.
template <int D>
struct Region {
  SampleIndex<D> samples;
  std::vector<double> values;
  std::vector<std::uint32_t> left_out;
};

template <int D>
std::vector<Region<D>> make_regions(const SampleIndex<D>& all, std::span<const double> values, std::size_t c,
                                    const ApproximateMlsSearch& search) {
  const std::size_t n = all.size();
  std::vector<Region<D>> regions;
  if (n <= search.max_samples) {
    Region<D>& region = regions.emplace_back();
    region.samples = all;
    region.values.assign(values.begin(), values.end());
    const std::size_t count = std::min(n, search.left_out);
    for (std::size_t i = 0; i < count; ++i) region.left_out.push_back(all.order()[i * n / count]);
    return regions;
  }
  constexpr std::size_t kClumps = 8;
  std::vector<typename SampleIndex<D>::Hit> hits;
  for (std::size_t clump = 0; clump < kClumps; ++clump) {
    all.nearest(all.positions()[all.order()[(2 * clump + 1) * n / (2 * kClumps)]], search.max_samples / kClumps, hits);
    Region<D>& region = regions.emplace_back();
    std::vector<Position<D>> positions;
    for (const auto& hit : hits) {
      positions.push_back(all.positions()[hit.index]);
      for (std::size_t m = 0; m < c; ++m) region.values.push_back(values[hit.index * c + m]);
    }
    region.samples = SampleIndex<D>(positions);
    // The samples nearest to the centre are left out, because the rim of the cluster is far from them.
    const std::size_t count = std::min(hits.size(), (search.left_out + kClumps - 1) / kClumps);
    for (std::size_t i = 0; i < count; ++i) region.left_out.push_back(static_cast<std::uint32_t>(i));
  }
  return regions;
}

// Iterates without sample k on the samples near k; errors[n] += |f_k − prediction_n|².
template <int D>
void leave_one_out(const detail::GeneratingMatrix& matrix, const Region<D>& region, const LaguerreGaussian& phi,
                   double radius, Normalisation normalisation, std::size_t c, std::uint32_t k, int iterations,
                   std::span<const double> history, std::span<double> errors) {
  const std::size_t n = matrix.size();
  std::vector<typename SampleIndex<D>::Hit> patch;
  region.samples.within(region.samples.positions()[k], radius, patch);
  std::vector<std::int32_t> slot(n, -1);
  std::size_t count = 0;
  std::erase_if(patch, [&](const auto& hit) { return hit.index == k; });
  for (const auto& hit : patch) slot[hit.index] = static_cast<std::int32_t>(count++);

  // Divisors without k differ only on its row.
  std::vector<double> factor(n, 1.0);
  const auto divisor = [&](std::size_t i, double gaussian, double v) {
    return detail::inverse_divisor(matrix.gaussian_sum[i] - gaussian, matrix.absolute_sum[i] - std::abs(v));
  };
  if (normalisation != Normalisation::kNone) {
    for (const auto& hit : patch)
      for (std::size_t e = matrix.row[hit.index]; e < matrix.row[hit.index + 1]; ++e)
        factor[matrix.column[e]] = divisor(matrix.column[e], 0, 0);
    for (std::size_t e = matrix.row[k]; e < matrix.row[k + 1]; ++e) {
      const std::size_t j = matrix.column[e];
      const double r2 = squared_distance<D>(region.samples.positions()[j], region.samples.positions()[k]);
      factor[j] = divisor(j, phi.gaussian(r2).value, matrix.value[e]);
    }
  }
  const bool columns = normalisation == Normalisation::kSamples;
  const auto row_factor = [&](std::size_t i) { return columns ? 1.0 : factor[i]; };
  const auto column_factor = [&](std::size_t j) { return columns ? factor[j] : 1.0; };

  std::vector<double> prediction(c, 0.0), residual(count * c), next(count * c), sum(c);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t m = 0; m < c; ++m) residual[i * c + m] = history[patch[i].index * c + m];
  for (int step = 0; step <= iterations; ++step) {
    const double* outside = history.data() + static_cast<std::size_t>(step) * n * c;
    const auto row_times_residual = [&](std::size_t i) {
      std::fill(sum.begin(), sum.end(), 0.0);
      for (std::size_t e = matrix.row[i]; e < matrix.row[i + 1]; ++e) {
        const std::size_t j = matrix.column[e];
        if (j == k) continue;
        const double* r = slot[j] >= 0 ? residual.data() + static_cast<std::size_t>(slot[j]) * c : outside + j * c;
        const double a = matrix.value[e] * column_factor(j);
        for (std::size_t m = 0; m < c; ++m) sum[m] += a * r[m];
      }
    };
    row_times_residual(k);
    double squared = 0;
    for (std::size_t m = 0; m < c; ++m) {
      prediction[m] += row_factor(k) * sum[m];
      const double e = region.values[k * c + m] - prediction[m];
      squared += e * e;
    }
    errors[static_cast<std::size_t>(step)] = squared;
    if (step == iterations) break;
    for (std::size_t i = 0; i < count; ++i) {
      row_times_residual(patch[i].index);
      for (std::size_t m = 0; m < c; ++m) next[i * c + m] = residual[i * c + m] - row_factor(patch[i].index) * sum[m];
    }
    residual.swap(next);
  }
}

}  // namespace

template <int D>
ApproximateMlsChoice choose_shape_and_iterations(std::span<const Position<D>> positions, std::span<const double> values,
                                                 const ApproximateMlsOptions& options,
                                                 const ApproximateMlsSearch& search) {
  detail::check_options(options, positions.size(), values);
  if (search.shapes.empty() || search.max_iterations < 0 || search.left_out == 0 || search.max_samples < 100)
    throw ArgumentError(
        "approximation: the search needs shapes, iterations >= 0, a number of samples to leave out and at least 100 "
        "samples");
  const SampleIndex<D> all(positions);
  const std::size_t c = values.size() / positions.size();
  const double spacing = options.spacing ? *options.spacing : all.spacing();
  const std::vector<Region<D>> regions = make_regions<D>(all, values, c, search);

  const auto steps = static_cast<std::size_t>(search.max_iterations) + 1;
  ApproximateMlsChoice choice;
  for (const double shape : search.shapes) {
    const LaguerreGaussian phi(D, options.order, shape, spacing);
    const double radius = phi.cutoff(options.cutoff), patch = std::min(radius, phi.cutoff(kPatch));
    std::vector<double> total(steps, 0.0);
    std::size_t count = 0;
    for (const Region<D>& region : regions) {
      const detail::GeneratingMatrix matrix =
          detail::generating_matrix<D>(region.samples, phi, radius, options.max_entries);
      // Residuals of all iterations with all samples.
      std::vector<double> residual = region.values, scratch(residual.size()), history;
      history.reserve(steps * residual.size());
      for (std::size_t step = 0; step < steps; ++step) {
        history.insert(history.end(), residual.begin(), residual.end());
        if (step + 1 < steps) matrix.step(options.normalisation, c, residual, scratch);
      }
      std::vector<double> errors(region.left_out.size() * steps);
      parallel_for(0, region.left_out.size(), 1, [&](std::size_t i) {
        leave_one_out<D>(matrix, region, phi, patch, options.normalisation, c, region.left_out[i],
                         search.max_iterations, history, std::span(errors).subspan(i * steps, steps));
      });
      for (std::size_t i = 0; i < region.left_out.size(); ++i)
        for (std::size_t step = 0; step < steps; ++step) total[step] += errors[i * steps + step];
      count += region.left_out.size() * c;
    }
    for (double& t : total) {
      t = std::sqrt(t / static_cast<double>(count));
      if (!std::isfinite(t)) t = std::numeric_limits<double>::infinity();
    }
    choice.errors.push_back(std::move(total));
  }

  double least = std::numeric_limits<double>::infinity();
  for (const auto& row : choice.errors) least = std::min(least, *std::min_element(row.begin(), row.end()));
  // Fewest iterations first, then least error.
  for (std::size_t step = 0; step < steps; ++step) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < search.shapes.size(); ++s)
      if (choice.errors[s][step] <= least * (1 + search.tolerance) && choice.errors[s][step] < best) {
        best = choice.errors[s][step];
        choice.shape = search.shapes[s];
        choice.iterations = static_cast<int>(step);
        choice.error = best;
      }
    if (std::isfinite(best)) return choice;
  }
  throw DataError("approximation: the iteration diverges for every shape parameter (normalise)");
}

template ApproximateMlsChoice choose_shape_and_iterations<1>(std::span<const Position<1>>, std::span<const double>,
                                                             const ApproximateMlsOptions&, const ApproximateMlsSearch&);
template ApproximateMlsChoice choose_shape_and_iterations<2>(std::span<const Position<2>>, std::span<const double>,
                                                             const ApproximateMlsOptions&, const ApproximateMlsSearch&);
template ApproximateMlsChoice choose_shape_and_iterations<3>(std::span<const Position<3>>, std::span<const double>,
                                                             const ApproximateMlsOptions&, const ApproximateMlsSearch&);

}  // namespace sansmesh::inline v1
