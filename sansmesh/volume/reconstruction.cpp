#include "sansmesh/volume/reconstruction.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/field/exponential_volume.h"
#include "sansmesh/field/scaled_volume.h"
#include "sansmesh/volume/choose_reconstruction.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/smoothed_values.h"
#include "sansmesh/volume/value_logarithm.h"
#include "sansmesh/volume/volume_traits.h"

namespace sansmesh::inline v1 {
namespace {

/// Rejects options that the method does not use.
void check_options(const VolumeReconstructionOptions& options, const VolumeMethod& method) {
  std::vector<std::string_view> set = options_set(options);
  std::erase_if(set, [](std::string_view o) {
    return o == "method" || o == "smoothing" || o == "cell_values" || o == "logarithm";
  });
  check_used(set, method.uses, set, fmt::format("the reconstruction {}", method.name));
  const bool lagrange = method.name == "lagrange", amls = method.name == "amls";
  if (options.degree) check_range("degree", *options.degree, lagrange ? 1 : 0, lagrange ? 5 : amls ? 2 : 4);
}

template <class... Arrays>
std::size_t bytes_in(const Arrays&... arrays) {
  return (std::size_t{0} + ... + (arrays.size() * sizeof(arrays[0])));
}

std::size_t bytes_of_samples(const SampledVolume& v) {
  std::size_t sum =
      bytes_in(v.positions, v.cells.shapes, v.cells.corners, v.cells.first, v.corners, v.cell_sample, v.higher.of_piece,
               v.higher.nodes, v.stars.entries, v.stars.first, v.part, v.block, v.level);
  for (const Attribute& a : v.attributes)
    sum += std::visit([](const auto& values) { return bytes_in(values); }, a.values);
  if (v.lattice)
    for (const auto& axis : v.lattice->axes) sum += bytes_in(axis);
  constexpr std::size_t kLocated = 40;  // bytes per cell of the boxes of the locator's tree and their order
  return sum + kLocated * v.cells.size();
}

std::size_t bytes_of_coefficients(const ReconstructionCoefficients& c) {
  const LocalPolynomials& p = c.polynomials;
  return bytes_in(p.metrics, p.constants, p.degrees, p.first, p.coefficients, p.trust, c.radii);
}

/// Checks values that `scale` reduces for a method with float coefficients. Throws DataError if a few numbers are so
/// much larger than the rest that floats lose the rest. A loss in continuous decay to zero is accepted.
void check_not_lost(const VolumeValues& values, double scale, std::string_view method) {
  constexpr double kLost = 0x1p-120, kApart = 0x1p-60;
  constexpr std::size_t kLooked = 100'000;
  const std::size_t n = values.components, rows = values.values.size() / n, stride = 1 + rows / kLooked;
  std::vector<double> away, component;
  for (std::size_t k = 0; k < n; ++k) {
    component.clear();
    for (std::size_t i = 0; i < rows; i += stride) component.push_back(values.values[i * n + k]);
    away.resize(component.size(), 0.0);
    const double middle = median(component);
    for (std::size_t r = 0; r < away.size(); ++r)
      away[r] = std::max(away[r], std::abs(values.values[r * stride * n + k] - middle));
  }
  std::erase(away, 0.0);
  if (away.empty()) return;
  const double rest = median(away);
  if (rest * scale >= kLost || rest < kLost) return;
  const double most = largest_value(values);
  if (std::any_of(away.begin(), away.end(), [&](double a) { return a >= kLost * most && a < kApart * most; })) return;
  throw DataError(
      fmt::format("array '{}': values of up to {:.4g} stand so far apart from the rest, which spans about {:.4g}, that "
                  "{} loses it beside them: say what stands for missing values (`fill_value`), or choose the method "
                  "linear",
                  printable(values.name, 60), most, rest, method));
}

/// Smooths the values, or takes smoothed ones from the coefficients of a fit; whether noise was found.
bool smooth_values(const SampledVolume& volume, VolumeValues& values, const std::optional<double>& factor,
                   const SampleNoise* noise, ReconstructionCoefficients& used, VolumeReconstructionReport& r,
                   Progress& progress) {
  if (!used.smoothed.empty()) {
    values.values = used.smoothed.copy();
    r.options.smoothing = factor.value_or(1), r.noise = used.noise;
    return true;
  }
  SmoothedValues smooth = smoothed_values(volume, std::move(values), factor, progress, noise);
  values = std::move(smooth.values);
  r.options.smoothing = smooth.smoothing;
  r.noise = smooth.noise, r.noise_kind = smooth.kind;
  if (used.keep_smoothed && smooth.smoothing > 0) {
    used.smoothed = std::vector<double>(values.values);
    used.noise = smooth.noise;
  }
  if (smooth.too_many)
    r.notes.push_back(
        fmt::format("noise of {:.3g} was found, but {} samples take minutes to smooth (`smoothing` 1 does)",
                    smooth.noise, volume.size()));
  return smooth.smoothing > 0 && smooth.found;
}

/// Whether the logarithm is reconstructed: as requested, as in a fit, or as the data ask for.
bool uses_logarithm(const SampledVolume& volume, const VolumeValues& values, const VolumeReconstructionOptions& options,
                    const VolumeMethod& method, bool fitted) {
  if (options.logarithm && *options.logarithm && values.components != 1)
    throw ArgumentError("`logarithm` is for arrays of one component");
  if (options.logarithm || fitted || method.plain) return options.logarithm.value_or(false);
  return choose_logarithm(volume, values).use;
}

/// The field of the logarithm of the values, as a field of the values.
std::unique_ptr<VolumeField> exponential_field(const VolumeMethod& method, ReconstructionInput input) {
  const double unit = logarithm_unit(input.values);
  input.values = logarithm_of(std::move(input.values), unit);
  input.logarithm = true;
  return std::make_unique<ExponentialVolume>(method.make(std::move(input)), unit);
}

}  // namespace

std::unique_ptr<VolumeField> reconstruct_volume(std::shared_ptr<const SampledVolume> volume, const std::string& array,
                                                const VolumeReconstructionOptions& options, Progress& progress,
                                                VolumeReconstructionReport* report,
                                                ReconstructionCoefficients* coefficients, const SampleNoise* noise) {
  options.validate();
  if (options.method) check_options(options, volume_method(*options.method));
  VolumeReconstructionReport own;
  VolumeReconstructionReport& r = report ? *report : own;
  r = {};
  r.options = options;
  VolumeValues values = volume_values(*volume, array);
  SampleNoise own_noise;
  if (!options.method) {
    if (!noise) own_noise = noise_of_values(*volume, values, progress), noise = &own_noise;
    VolumeReconstructionChoice recommended =
        choose_reconstruction(*volume, measure_volume_traits(*volume, values, *noise, progress), options.smoothing);
    r.options.method = std::move(recommended.method), r.why = std::move(recommended.why);
  }
  const VolumeMethod& method = volume_method(*r.options.method);
  if (!values.filled.empty())
    r.notes.push_back(fmt::format("{} of {} samples have no finite value: filled in from their neighbours",
                                  values.filled.size(), volume->size()));
  ReconstructionCoefficients own_coefficients;
  ReconstructionCoefficients& used = coefficients ? *coefficients : own_coefficients;
  const bool noisy = smooth_values(*volume, values, options.smoothing, noise, used, r, progress);
  const std::size_t bytes = bytes_of_samples(*volume) + values.values.size() * sizeof(double);
  if (r.options.cell_values && !volume->in_cells)
    throw ArgumentError("`cell_values` is for arrays of cells: this one has values at points");
  if (r.options.cell_values == CellValues::means && (method.name != "mls-detail" || volume->lattice))
    throw ArgumentError("`cell_values = means` needs `method = mls-detail`, and no uniform or rectilinear grid");
  r.options.logarithm = uses_logarithm(*volume, values, r.options, method, !used.empty());
  if (*r.options.logarithm) {
    // Few numbers beyond all others are missing values rather than decades.
    if (const std::vector<double> scales = value_scales(values); !options.logarithm && !scales.empty())
      check_not_lost(values, scales[0], method.name);
    std::unique_ptr<VolumeField> field =
        exponential_field(method, {std::move(volume), std::move(values), r.options, progress, r, used, false, noisy});
    r.bytes = bytes + bytes_of_coefficients(used);
    return field;
  }
  // Coefficients and kernels are in float, squares in double: values far from 1 are scaled before and after.
  std::vector<double> factors = used.empty() ? value_scales(values) : used.scales;
  if (!factors.empty() && factors[0] < 1 && method.fits) check_not_lost(values, factors[0], method.name);
  values = scaled_values(std::move(values), factors);
  std::unique_ptr<VolumeField> field =
      method.make({std::move(volume), std::move(values), r.options, progress, r, used, false, noisy});
  if (!used.empty()) used.scales = factors;
  r.bytes = bytes + bytes_of_coefficients(used);
  if (factors.empty()) return field;
  for (double& f : factors) f = 1 / f;
  return ScaledVolume::of(std::move(field), std::move(factors));
}

}  // namespace sansmesh::inline v1
