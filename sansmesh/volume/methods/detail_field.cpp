// mls-detail: robust local polynomials of adaptive degree, blended (tejada2008, 6.2).
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/methods/cell_blend.h"
#include "sansmesh/volume/methods/support_blend.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/cell_fronts.h"
#include "sansmesh/volume/samples/lattice_polynomials.h"
#include "sansmesh/volume/samples/local_polynomials.h"
#include "sansmesh/volume/samples/mean_polynomials.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace {

class StoredCornerPolynomials final : public CornerPolynomials {
 public:
  StoredCornerPolynomials(std::shared_ptr<const SampledVolume> volume, LocalPolynomials polynomials,
                          VolumeValues values)
      : volume_(std::move(volume)), polynomials_(std::move(polynomials)), values_(std::move(values)) {}

  std::size_t components() const override { return polynomials_.components; }
  const VolumeValues& values() const override { return values_; }
  double corners(std::span<const std::uint32_t> samples, std::size_t component,
                 std::span<detail::CellCorner> out) const override {
    const std::size_t c = polynomials_.components;
    const double base = values_.values[samples[0] * c + component];
    for (std::size_t v = 0; v < samples.size(); ++v) {
      const std::size_t i = samples[v];
      detail::CellCorner& corner = out[v];
      corner.metric = polynomials_.metric(*volume_, i);
      corner.coefficients = polynomials_.of(i, component).data();
      corner.degree = polynomials_.degrees[i];
      corner.constant = static_cast<float>(polynomials_.constants[i * c + component] - base);
      corner.value = static_cast<float>(values_.values[i * c + component] - base);
      corner.trust = polynomials_.trust[i];
    }
    return base;
  }

 private:
  std::shared_ptr<const SampledVolume> volume_;
  LocalPolynomials polynomials_;
  VolumeValues values_;
};

}  // namespace

static std::unique_ptr<VolumeField> make_mls_detail_field(ReconstructionInput input) {
  LocalPolynomialOptions local;
  VolumeReconstructionOptions& chosen = input.report.options;
  local.fit.max_degree = input.options.degree.value_or(3);
  local.fit.robust = input.options.robust.value_or(true);
  const bool interpolate = chosen.interpolate.emplace(input.options.interpolate.value_or(true));
  if (!interpolate) local.share = 0, local.fit.doubt_own = true;
  chosen.degree = local.fit.max_degree;
  chosen.robust = local.fit.robust;
  ReconstructionCoefficients& fitted = input.coefficients;
  // Fits of older files, without this option, took centres.
  const bool means =
      input.volume->in_cells && !input.volume->lattice && interpolate &&
      input.options.cell_values.value_or(fitted.empty() ? CellValues::means : CellValues::centres) == CellValues::means;
  check_argument(interpolate || input.options.cell_values != CellValues::means,
                 "without `interpolate` values in cells are those at their centres: omit `cell_values`");
  if (input.volume->in_cells) chosen.cell_values = means ? CellValues::means : CellValues::centres;
  if (fitted.empty()) {
    fitted.polynomials = means
                             ? fit_mean_polynomials(*input.volume, input.values, local, input.logarithm, input.progress)
                             : fit_polynomials(*input.volume, input.values, local, input.progress);
    if (blends_supports(*input.volume, "mls-detail"))
      fitted.radii = support_radii(*input.volume, fitted.polynomials, 1);
  }
  // Doubtful polynomials would return the samples.
  if (!interpolate) fitted.polynomials.trust = std::vector<float>(input.volume->size(), 1.0f);
  const LocalPolynomials& polynomials = fitted.polynomials;
  input.report.by_degree = fitted.by_degree();
  const auto doubtful = static_cast<std::size_t>(
      std::count_if(polynomials.trust.begin(), polynomials.trust.end(), [](float t) { return t < 0.5f; }));
  // Smoothed samples keep some noise, by which polynomials of neighbours differ.
  if (!input.noisy && 3 * doubtful > polynomials.size())
    input.report.notes.push_back(
        fmt::format("the samples are too far apart for what they show: at {:.0f} % of them polynomials of neighbours "
                    "disagree, and the result is hardly better than linear interpolation there",
                    100.0 * static_cast<double>(doubtful) / static_cast<double>(polynomials.size())));
  auto locator = std::make_shared<const VolumeLocator>(*input.volume);
  if (blends_supports(*input.volume, "mls-detail")) {
    CellFronts fronts;
    if (means && local.fit.robust) fronts = find_cell_fronts(*input.volume, input.values, polynomials, input.logarithm);
    std::optional<SmoothShare> smooth;
    const auto is_doubtful = [](float trust) { return SmoothShare::doubt_of(trust) > 0; };
    if (means && std::any_of(polynomials.trust.begin(), polynomials.trust.end(), is_doubtful))
      smooth.emplace(input.volume, locator, input.values, input.logarithm, polynomials,
                     std::vector<float>(fitted.radii.begin(), fitted.radii.end()), input.progress);
    return make_support_blend(std::move(input.volume), std::move(locator), polynomials, fitted.radii, input.values,
                              input.logarithm, std::move(fronts), std::move(smooth));
  }
  auto stored = std::make_unique<StoredCornerPolynomials>(input.volume, polynomials, std::move(input.values));
  return make_cell_blend(std::move(input.volume), std::move(locator), std::move(stored));
}

namespace {

constexpr std::string_view kMlsDetailUses[] = {"degree", "robust", "interpolate"};
constexpr VolumeMethod kDetailMethods[] = {
    {.name = "mls-detail",
     .summary = "robust polynomials at samples, of the degree that predicts best, blended",
     .grids = "all",
     .make = make_mls_detail_field,
     .uses = kMlsDetailUses,
     .fits = true}};

}  // namespace

std::span<const VolumeMethod> detail_field_methods() { return kDetailMethods; }

}  // namespace sansmesh::inline v1
