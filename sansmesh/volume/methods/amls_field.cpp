// amls: approximate moving least squares, ellipsoidal, normalised, iterated, with precomputed coefficients (tejada2008,
// 6.3).
#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/methods/amls_blend.h"
#include "sansmesh/volume/methods/amls_choice.h"
#include "sansmesh/volume/methods/amls_system.h"
#include "sansmesh/volume/methods/support_blend.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/lattice_polynomials.h"
#include "sansmesh/volume/samples/star_metric.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace {

// Local polynomials, missing shape and iterations, and the iterated constants.
ReconstructionCoefficients fit_amls(const ReconstructionInput& input, const AmlsShape& phi, AmlsChoice& choice) {
  const SampledVolume& volume = *input.volume;
  // The local polynomials supply gradients and second derivatives at the samples.
  LocalPolynomialOptions how;
  how.fit.max_degree = input.options.degree.value_or(2);
  how.fit.robust = false;
  how.ask_in_cells = false;
  const bool spherical = input.options.spherical.value_or(false);
  if (spherical && volume.lattice)
    throw ArgumentError("`spherical` is not for uniform and rectilinear grids: their supports follow their steps");
  LocalPolynomials fitted =
      spherical ? fit_local_polynomials(volume, input.values, how, spherical_metrics(volume), input.progress)
                : fit_polynomials(volume, input.values, how, input.progress);
  const std::vector<float> least = support_radii(volume, fitted, 1);
  const auto& asked = input.options.epsilon;
  if (asked && input.options.iterations) {
    choice = {*asked, *input.options.iterations};
  } else {
    const AmlsTrial trial(volume, input.values, fitted, least, how, phi, asked.value_or(std::begin(kAmlsShapes)[0]),
                          asked.value_or(std::end(kAmlsShapes)[-1]), input.progress);
    choice = choose_amls(trial, asked, input.options.iterations, input.progress);
  }
  std::vector<float> radii = least;
  for (float& r : radii) r = std::max(r, static_cast<float>(AmlsShape::radius(choice.shape)));

  LocalPolynomials local = trusted(fitted);
  const AmlsMatrix matrix = amls_matrix(volume, local, radii, phi);
  AmlsIteration iteration(matrix, input.values.values, input.values.components);
  for (int k = 0; k < choice.iterations; ++k) iteration.advance();
  local.constants = iteration.coefficients();
  // Agreement between neighbours of the iterated constants with their polynomials.
  std::vector<float> trust(volume.size(), 1.0f);
  // As printed, only values are iterated, and their sum is all.
  if (how.fit.max_degree > 0 && has_linear_share(volume)) {
    std::vector<double> reached = input.values.values;
    for (std::size_t i = 0; i < reached.size(); ++i) reached[i] -= iteration.residuals()[i];
    fitted.constants = std::move(reached);
    const std::vector<std::uint8_t> unsplit(volume.size());
    trust = polynomial_trust(volume, input.values, fitted, {}, unsplit, false);
    for (float& t : trust) t = amls_share(t);
  }
  local.trust = std::move(trust);
  return {std::move(local), std::move(radii)};
}

}  // namespace

static std::unique_ptr<VolumeField> make_amls_field(ReconstructionInput input) {
  const int order = input.options.order.value_or(2);
  const AmlsShape phi = AmlsShape::of_order(order);
  ReconstructionCoefficients& fitted = input.coefficients;
  AmlsChoice choice;
  if (input.options.epsilon) choice.shape = *input.options.epsilon;
  if (input.options.iterations) choice.iterations = *input.options.iterations;
  if (fitted.empty()) fitted = fit_amls(input, phi, choice);
  for (const std::uint8_t degree : fitted.polynomials.degrees)
    if (degree > 2) throw DataError("polynomials of amls are of degree 2 at most");
  VolumeReconstructionOptions& chosen = input.report.options;
  chosen.degree = input.options.degree.value_or(2);
  chosen.order = order, chosen.epsilon = choice.shape, chosen.iterations = choice.iterations;
  auto locator = std::make_shared<const VolumeLocator>(*input.volume);
  return make_amls_blend(std::move(input.volume), std::move(locator), fitted.polynomials, fitted.radii,
                         std::move(input.values), phi);
}

namespace {

constexpr std::string_view kAmlsUses[] = {"degree", "iterations", "epsilon", "order", "spherical"};
constexpr VolumeMethod kAmlsMethods[] = {
    {.name = "amls",
     .summary = "approximate moving least squares: ellipsoidal, normalised, iterated; the fastest smooth method",
     .grids = "all",
     .make = make_amls_field,
     .uses = kAmlsUses,
     .fits = true}};

}  // namespace

std::span<const VolumeMethod> amls_field_methods() { return kAmlsMethods; }

}  // namespace sansmesh::inline v1
