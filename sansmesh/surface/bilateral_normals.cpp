#include "sansmesh/surface/bilateral_normals.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/check_range.h"
#include "sansmesh/surface/bilateral_kernels.h"
#include "sansmesh/surface/candidates.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSmoothing = 1.2;
constexpr double kHeightOverSpacing = 0.33, kHeightOverNoise = 1;

}  // namespace

struct BilateralNormals::State {
  detail::Candidates candidates;
  int iterations = 0;
  float inverse_turn = 0;
  detail::NormalFormula formula = detail::NormalFormula::bilateral;
};

void BilateralOptions::validate() const {
  check_argument(!height || (std::isfinite(*height) && *height > 0), "`height` must be a positive length");
  if (smoothing) check_range("smoothing", *smoothing, 0.5, 20);
  check_argument(std::isfinite(turn) && turn > 0, "`turn` must be positive");
  check_range("iterations", iterations, 0, 20);
  check_range("epsilon", epsilon, 0.05, 20);
  check_argument(!bandwidth || (std::isfinite(*bandwidth) && *bandwidth > 0), "`bandwidth` must be a positive length");
}

BilateralNormals::BilateralNormals(const SurfaceSamples& samples, const BilateralOptions& options) {
  options.validate();
  const auto state = std::make_shared<State>();
  state->iterations = options.iterations;
  state->inverse_turn = static_cast<float>(1 / (options.turn * options.turn));
  const double noise = samples.noise / samples.median_spacing;
  const bool laguerre = options.formula == SharpFormula::laguerre;
  const bool gaussian = laguerre || options.weights == SurfaceWeights::gaussian;
  if (gaussian) state->formula = laguerre ? detail::NormalFormula::laguerre : detail::NormalFormula::bilateral_gaussian;
  const double smoothing = std::min(kSmoothing + 1.5 * noise, 5.0);
  const SurfaceWeights weights = gaussian ? SurfaceWeights::gaussian : SurfaceWeights::compact;
  auto widths = detail::weight_widths(samples, options.smoothing.value_or(smoothing), options.bandwidth, weights);
  if (laguerre)
    for (float& w : widths) w /= static_cast<float>(std::sqrt(options.epsilon));
  state->candidates = detail::Candidates(samples, widths, weights, default_reach(samples));
  if (gaussian) state->candidates.equalize_areas();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double height = options.height.value_or(kHeightOverSpacing * static_cast<double>(samples.spacing[i]) +
                                                  kHeightOverNoise * samples.noise);
    state->candidates.all()[i].inverse_height = static_cast<float>(1 / (2 * height * height));
  }
  state_ = state;
}

void BilateralNormals::refine(std::span<const Vec3> x, std::span<Vec3> normals, std::span<double> heights) const {
  std::fill(heights.begin(), heights.end(), 0.0);
  state_->candidates.for_each_group(
      x, [&](const detail::PointGroup& group, std::span<const detail::Candidate> chosen, bool) {
        detail::GroupNormals n;
        for (std::size_t k = 0; k < detail::kGroup; ++k) {
          const Vec3f given(normalized(normals[group.slot[k]]));
          n.x[k] = given.x, n.y[k] = given.y, n.z[k] = given.z;
        }
        detail::refine_group(state_->formula, chosen, group, state_->iterations, state_->inverse_turn, n);
        for (std::size_t k = 0; k < group.count; ++k) {
          normals[group.slot[k]] = Vec3(Vec3f{n.x[k], n.y[k], n.z[k]});
          if (!heights.empty()) heights[group.slot[k]] = static_cast<double>(n.height[k]);
        }
      });
}

void FaceField::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  std::vector<Vec3> own(gradients.empty() ? x.size() : 0);
  const std::span<Vec3> g = gradients.empty() ? std::span<Vec3>(own) : gradients;
  field_.evaluate(x, values, g);
  std::vector<Vec3> normals(g.begin(), g.end());
  std::vector<double> heights(x.size());
  normals_.refine(x, normals, heights);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (heights[i] == 0) continue;
    values[i] = heights[i];
    g[i] = normals[i];
  }
}

}  // namespace sansmesh::inline v1
