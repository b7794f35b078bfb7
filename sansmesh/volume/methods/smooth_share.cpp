#include "sansmesh/volume/methods/smooth_share.h"

#include <algorithm>
#include <utility>

#include "sansmesh/volume/methods/amls_blend.h"
#include "sansmesh/volume/methods/amls_system.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSmoothEpsilon = 1;  ///< ε of amls: functions reach over the star
constexpr int kSmoothIterations = 2;
constexpr float kLeastDoubt = 0.01f;  ///< less is none, to save time
/// Most by which doubtful polynomials move the logarithm at the centre of a cell: means of exponentials of steep slopes
/// say little about it.
constexpr double kMostMoved = 0.1;

}  // namespace

SmoothShare::SmoothShare(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
                         VolumeValues values, bool logarithm, const LocalPolynomials& polynomials,
                         std::vector<float> radii, Progress& progress) {
  const std::size_t n = volume->size(), c = values.components;
  doubts_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    doubts_[i] = doubt_of(polynomials.trust[i]);
    const double limited = logarithm ? static_cast<double>(doubts_[i]) : 0;
    for (std::size_t m = 0; m < c; ++m) {
      double& value = values.values[i * c + m];
      const double move = polynomials.constants[i * c + m] - value;
      value += (1 - limited) * move + limited * std::clamp(move, -kMostMoved, kMostMoved);
    }
  }
  LocalPolynomialOptions how;
  how.fit.max_degree = 2;
  how.fit.robust = false;
  how.ask_in_cells = false;
  std::vector<StarMetric> metrics(polynomials.metrics.begin(), polynomials.metrics.end());
  LocalPolynomials local = trusted(fit_local_polynomials(*volume, values, how, std::move(metrics), progress));
  for (float& r : radii) r = std::max(r, static_cast<float>(AmlsShape::radius(kSmoothEpsilon)));
  const AmlsShape shape = AmlsShape::of_order(2);
  const AmlsMatrix matrix = amls_matrix(*volume, local, radii, shape);
  AmlsIteration iteration(matrix, values.values, c);
  for (int k = 0; k < kSmoothIterations; ++k) iteration.advance();
  local.constants = iteration.coefficients();
  local.trust = std::vector<float>(n, 1.0f);
  field_ = make_amls_blend(std::move(volume), std::move(locator), std::move(local), std::move(radii), std::move(values),
                           shape);
}

float SmoothShare::doubt_of(float trust) { return std::max(1 - trust - kLeastDoubt, 0.0f) / (1 - kLeastDoubt); }

bool SmoothShare::any(std::span<const std::uint32_t> samples) const {
  return std::any_of(samples.begin(), samples.end(), [&](std::uint32_t i) { return doubts_[i] > 0; });
}

}  // namespace sansmesh::inline v1
