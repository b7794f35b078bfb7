#include "sansmesh/approximation/approximate_mls.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/approximation/generating_matrix.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

template <int D>
ApproximateMls<D>::ApproximateMls(std::span<const Position<D>> positions, std::span<const double> values,
                                  const ApproximateMlsOptions& options)
    : options_((detail::check_options(options, positions.size(), values), options)),
      index_(positions),
      spacing_(options.spacing ? *options.spacing : index_.spacing()),
      phi_(D, options.order, options.shape, spacing_),
      radius_(phi_.cutoff(options.cutoff)),
      components_(values.size() / positions.size()) {
  coefficients_.assign(values.begin(), values.end());
  if (options.iterations == 0 && options.normalisation != Normalisation::kSamples)
    return;  // no iteration needs the matrix
  const detail::GeneratingMatrix k = detail::generating_matrix<D>(index_, phi_, radius_, options.max_entries);
  std::vector<double> residual(values.begin(), values.end()), scratch(values.size());
  double magnitude = 0;
  for (const double v : values) magnitude = std::max(magnitude, std::abs(v));
  for (int n = 0; n <= options.iterations; ++n) {
    for (std::size_t i = 0; n > 0 && i < residual.size(); ++i) coefficients_[i] += residual[i];
    k.step(options.normalisation, components_, residual, scratch);
    double sum = 0;
    for (const double r : residual) sum += r * r;
    residuals_.push_back(std::sqrt(sum / static_cast<double>(residual.size())));
    if (!(residuals_.back() <= 1e6 * magnitude))
      throw DataError("approximation: the iteration diverges (normalise, or lower the number of iterations)");
  }
  if (options.normalisation == Normalisation::kSamples) {
    inverse_divisor_.resize(k.size());
    for (std::size_t i = 0; i < k.size(); ++i)
      inverse_divisor_[i] = detail::inverse_divisor(k.gaussian_sum[i], k.absolute_sum[i]);
  }
}

template <int D>
void ApproximateMls<D>::evaluate(std::span<const Position<D>> x, std::span<double> values,
                                 std::span<double> gradients) const {
  const std::size_t c = components_;
  if (values.size() != x.size() * c || !(gradients.empty() || gradients.size() == x.size() * c * D))
    throw ArgumentError("approximation: the sizes of values and gradients must match the number of points");
  const bool partition = options_.normalisation == Normalisation::kPartition;
  parallel_ranges(0, x.size(), 64, [&](std::size_t first, std::size_t last) {
    std::vector<typename SampleIndex<D>::Hit> hits;
    std::vector<double> sums((D + 1) * c);
    for (std::size_t p = first; p < last; ++p) {
      index_.within(x[p], radius_, hits);
      // Entry 0 of each group is the value, entry 1 + k the derivative with respect to x_k.
      std::fill(sums.begin(), sums.end(), 0.0);
      std::array<double, D + 1> s{}, t{};
      for (const auto& hit : hits) {
        const Position<D>& sample = index_.positions()[hit.index];
        RadialValue v;
        if (gradients.empty())
          v.value = phi_(hit.squared_distance);
        else
          v = phi_.with_slope(hit.squared_distance);
        if (!inverse_divisor_.empty()) v.value *= inverse_divisor_[hit.index], v.slope *= inverse_divisor_[hit.index];
        std::array<double, D + 1> term{v.value};
        for (std::size_t k = 0; k < D; ++k) term[1 + k] = v.slope * (x[p][k] - sample[k]);
        const double sign = v.value < 0 ? -1 : 1;
        if (partition) {
          const RadialValue e = phi_.gaussian(hit.squared_distance);
          s[0] += e.value;
          for (std::size_t k = 0; k < D; ++k) s[1 + k] += e.slope * (x[p][k] - sample[k]);
          for (std::size_t k = 0; k <= D; ++k) t[k] += sign * term[k];
        }
        for (std::size_t m = 0; m < c; ++m) {
          const double g = coefficients_[hit.index * c + m];
          for (std::size_t k = 0; k <= D; ++k) sums[m * (D + 1) + k] += g * term[k];
        }
      }
      const double inverse = partition ? detail::inverse_divisor(s[0], t[0]) : 1;
      const bool by_sum = s[0] >= 0.55 * t[0];
      for (std::size_t m = 0; m < c; ++m) {
        const double* sum = sums.data() + m * (D + 1);
        const double value = values[p * c + m] = sum[0] * inverse;
        if (gradients.empty()) continue;
        for (std::size_t k = 0; k < D; ++k) {
          const double divisor_slope = partition ? (by_sum ? s[1 + k] : 0.55 * t[1 + k]) : 0;
          gradients[(p * c + m) * D + k] = (sum[1 + k] - value * divisor_slope) * inverse;
        }
      }
    }
  });
}

template class ApproximateMls<1>;
template class ApproximateMls<2>;
template class ApproximateMls<3>;

}  // namespace sansmesh::inline v1
