#include "sansmesh/volume/reconstruction_coefficients.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sansmesh/error.h"
#include "sansmesh/volume/grid/holds_for_all.h"

namespace sansmesh::inline v1 {
namespace {

using detail::holds_for_all;

bool is_metric(const StarMetric& metric) {
  return std::all_of(metric.rows.begin(), metric.rows.end(), [](const Vec3f& row) {
    const double square = squared_norm(Vec3(row));
    return std::isfinite(square) && square > 0;
  });
}

}  // namespace

bool blends_supports(const SampledVolume& volume, std::string_view method) {
  if (method == "amls") return true;
  return method == "mls-detail" && !volume.lattice && (!volume.cell_sample.empty() || volume.facts.overlapped > 0);
}

std::vector<std::size_t> ReconstructionCoefficients::by_degree() const {
  if (empty()) return {};
  std::vector<std::size_t> count(LocalPolynomials::kMaxDegree + 1);
  for (const std::uint8_t d : polynomials.degrees) ++count.at(d);
  return count;
}

void ReconstructionCoefficients::check(const SampledVolume& volume, std::size_t components,
                                       std::string_view method) const {
  const LocalPolynomials& p = polynomials;
  const std::size_t n = volume.size();
  const auto require = [](bool right, const char* what) {
    if (!right) throw DataError(what);
  };
  require(p.components == components && p.degrees.size() == n && p.first.size() == n + 1 && p.trust.size() == n &&
              p.constants.size() == n * components && p.metrics.size() == (volume.lattice ? 0 : n) &&
              radii.size() == (blends_supports(volume, method) ? n : 0),
          "its coefficients do not fit its samples");
  const auto fits = [&](std::size_t i) {
    if (p.degrees[i] > LocalPolynomials::kMaxDegree) return false;
    const auto terms = static_cast<std::size_t>(monomial_count(3, p.degrees[i]) - 1);
    return p.first[i + 1] - p.first[i] == components * terms;
  };
  require(p.first[0] == 0 && p.first[n] == p.coefficients.size() && holds_for_all(n, fits),
          "the degrees of its polynomials do not fit its coefficients");
  require(holds_for_all(p.coefficients.size(), [&](std::size_t i) { return std::isfinite(p.coefficients[i]); }) &&
              holds_for_all(p.constants.size(), [&](std::size_t i) { return std::isfinite(p.constants[i]); }),
          "a coefficient is not finite");
  require(holds_for_all(n, [&](std::size_t i) { return p.trust[i] >= 0 && p.trust[i] <= 1; }),
          "the trust of its polynomials is invalid");
  require(holds_for_all(p.metrics.size(), [&](std::size_t i) { return is_metric(p.metrics[i]); }),
          "a local metric is invalid");
  require(scales.empty() || (scales.size() == components &&
                             std::all_of(scales.begin(), scales.end(),
                                         [](double s) { return s > 0 && std::isfinite(s) && std::isfinite(1 / s); })),
          "a scale of its values is invalid");
  require(holds_for_all(radii.size(), [&](std::size_t i) { return radii[i] > 0 && std::isfinite(radii[i]); }),
          "the radius of a support is invalid");
}

}  // namespace sansmesh::inline v1
