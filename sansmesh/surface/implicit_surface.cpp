#include "sansmesh/surface/implicit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/surface/candidates.h"
#include "sansmesh/surface/feature_size.h"
#include "sansmesh/surface/implicit_kernels.h"
#include "sansmesh/surface/iterated_planes.h"

namespace sansmesh::inline v1 {
namespace {

/// Increments of the width for random samples and for noise over spacing. Without the former, single samples next to
/// gaps dominate, and the surface grows fins beyond edges.
constexpr double kUneven = 0.45, kSpheresUneven = 0.35, kNoisy = 2;
/// Widths of dey2005 are this share of the feature size, and at most kMostWidth times the least width.
constexpr double kMostWidth = 2, kFeatureShare = 0.35;
/// Beyond the supports: the mean of the tangent planes of the nearest kBeyond samples, up to kPlanesReach spacings from
/// the nearest, with weights that nearly vanish at the farthest (squared distance of weight 0 over that of the
/// farthest).
constexpr std::size_t kBeyond = 12;
constexpr double kPlanesReach = 6, kFarthest = 1.2;

detail::ImplicitFormula formula_of(const ImplicitOptions& options) {
  using F = detail::ImplicitFormula;
  switch (options.method) {
    case ImplicitMethod::hoppe:
      return F::hoppe;
    case ImplicitMethod::adamson:
      return options.normal == SurfaceNormal::covariance ? F::adamson_covariance : F::adamson;
    case ImplicitMethod::kolluri:
    case ImplicitMethod::dey:
      return F::kolluri;
    case ImplicitMethod::extremal:
      return F::extremal;
    case ImplicitMethod::apss:
      return F::apss;
    case ImplicitMethod::amls:
      return F::amls;
  }
  throw ArgumentError("unknown surface method");
}

/// With more noise than this (over the spacing) leaving samples out is not informative: neighbours of a sample that is
/// off the surface are off it in the same direction, and the order that follows the noise wins. Then the noise decides:
/// order 2, whose one iteration removes the curvature error of the mean, and a width that grows with the noise.
constexpr double kTelling = 0.1;
constexpr double kSmoothingOfNoise = 2.2, kMostOfNoise = 5;

detail::IterationChoice choose_by_noise(const SurfaceSamples& samples, const ImplicitOptions& options) {
  detail::IterationChoice choice;
  choice.order = options.order.value_or(2);
  choice.iterations = options.iterations.value_or(choice.order == 2 ? 1 : 0);
  choice.smoothing = options.smoothing.value_or(
      std::min(1 + kSmoothingOfNoise * samples.noise / samples.median_spacing, kMostOfNoise));
  return choice;
}

/// Order, width and iterations of the approximation with the least leave-one-out error, unless given.
detail::IterationChoice choose(const SurfaceSamples& samples, const ImplicitOptions& options,
                               detail::IterationOptions iteration) {
  if (samples.noise >= kTelling * samples.median_spacing) {
    PointSet points;
    points.positions = samples.positions;
    if (measure_noise(points).known) return choose_by_noise(samples, options);  // otherwise it may be shape
  }
  detail::IterationChoice best;
  for (const int order : {2, 4}) {
    if (order != 2 && options.order) break;
    iteration.order = options.order.value_or(order);
    const auto choice =
        detail::choose_iterations(samples, iteration, options.smoothing.value_or(0), options.iterations.value_or(-1));
    if (order == 2 || choice.error < best.error) best = choice;
  }
  return best;
}

/// The weights of kolluri2005 are divided by the number of samples within h of the sample, including itself.
std::vector<float> shares_of_crowds(const SurfaceSamples& samples, const std::vector<float>& widths) {
  std::vector<float> shares(samples.size());
  parallel_for(0, samples.size(), 1024, [&](std::size_t i) {
    const std::size_t crowd = samples.tree.count_within(samples.positions[i], widths[i]);
    shares[i] = 1 / std::max(1.0f, static_cast<float>(crowd));
  });
  return shares;
}

}  // namespace

struct ImplicitSurface::State {
  SurfaceSamples samples;
  ImplicitReport report;
  detail::ImplicitKernel kernel;
  detail::Candidates candidates;

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint8_t> inside) const;
  void beyond_supports(const Vec3& x, double& value, Vec3* gradient) const;
};

void ImplicitSurface::State::beyond_supports(const Vec3& x, double& value, Vec3* gradient) const {
  std::array<Neighbour, kBeyond> found;
  const std::size_t n = samples.tree.nearest(Vec3f(x), found);
  if (n == 0) {
    value = candidates.bounds().diagonal();
    if (gradient) *gradient = {};
    return;
  }
  const Vec3 nearest_normal(samples.normals[found[0].index]);
  const double distance = std::sqrt(static_cast<double>(found[0].squared_distance));
  if (distance > kPlanesReach * static_cast<double>(samples.spacing[found[0].index])) {
    const Vec3 d = x - Vec3(samples.positions[found[0].index]);
    const double sign = dot(d, nearest_normal) < 0 ? -1 : 1;
    value = sign * distance;
    if (gradient) *gradient = distance > 0 ? d * (sign / distance) : nearest_normal;
    return;
  }
  const double reach2 = kFarthest * static_cast<double>(found[n - 1].squared_distance);
  double weight = 0, plane = 0;
  Vec3 normal;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 m(samples.normals[found[k].index]);
    if (k > 0 && dot(m, nearest_normal) < 0) continue;  // another sheet
    const double t = 1 - static_cast<double>(found[k].squared_distance) / reach2, w = t * t;
    weight += w, normal += m * w;
    plane += w * dot(x - Vec3(samples.positions[found[k].index]), m);
  }
  value = plane / weight;
  if (gradient) *gradient = normal / weight;
}

void ImplicitSurface::State::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                      std::span<std::uint8_t> inside) const {
  // Points that are not finite belong to no group.
  std::fill(values.begin(), values.end(), candidates.bounds().diagonal());
  std::fill(gradients.begin(), gradients.end(), Vec3{});
  std::fill(inside.begin(), inside.end(), std::uint8_t{0});
  candidates.for_each_group(
      x, [&](const detail::PointGroup& group, std::span<const detail::Candidate> chosen, bool mixed) {
        detail::GroupValues out;
        detail::ImplicitKernel how = kernel;
        how.sheets = kernel.sheets && mixed;
        detail::implicit_values(how, chosen, group, !gradients.empty(), out);
        for (std::size_t k = 0; k < group.count; ++k) {
          const std::uint32_t i = group.slot[k];
          if (!inside.empty()) inside[i] = out.inside[k] > 0;
          if (!(out.weight[k] > 0)) {
            beyond_supports(x[i], values[i], gradients.empty() ? nullptr : &gradients[i]);
            continue;
          }
          values[i] = static_cast<double>(out.value[k]);
          if (!gradients.empty()) gradients[i] = Vec3(Vec3f{out.x[k], out.y[k], out.z[k]});
        }
      });
}

ImplicitMethod implicit_method(std::string_view name) {
  const auto known = std::find(std::begin(kImplicitMethods), std::end(kImplicitMethods), name);
  check_argument(known != std::end(kImplicitMethods), "`method` is no surface of weighted means");
  return static_cast<ImplicitMethod>(known - std::begin(kImplicitMethods));
}

void ImplicitOptions::validate() const {
  if (smoothing) check_range("smoothing", *smoothing, 0.5, 20);
  check_argument(!bandwidth || (std::isfinite(*bandwidth) && *bandwidth > 0), "`bandwidth` must be a positive length");
  check_argument(!order || *order == 2 || *order == 4 || *order == 6, "`order` must be 2, 4 or 6");
  if (iterations) check_range("iterations", *iterations, 0, 100);
  if (reach) check_range("reach", *reach, 0.5, 10);
  if (epsilon) check_range("epsilon", *epsilon, 0.05, 20);
  check_argument(weights == SurfaceWeights::compact || method != ImplicitMethod::hoppe,
                 "the surface hoppe has no `weights`");
  check_argument(!epsilon || method == ImplicitMethod::amls, "only the surface amls has `epsilon`");
  check_argument(normal != SurfaceNormal::covariance || method == ImplicitMethod::adamson,
                 "only the surface adamson has `normal` = covariance");
  check_argument(normal != SurfaceNormal::iterated || method == ImplicitMethod::amls,
                 "only the surface amls has `normal` = iterated");
}

double default_smoothing(const SurfaceSamples& samples, ImplicitMethod method) {
  const double noise = samples.noise / samples.median_spacing;
  const double least =
      method == ImplicitMethod::apss ? 1.2 + kSpheresUneven * unevenness(samples) : 1.1 + kUneven * unevenness(samples);
  return std::clamp(least + kNoisy * noise, least, 5.0);
}

ImplicitSurface make_implicit_surface(SurfaceSamples samples, const ImplicitOptions& options, Progress& progress) {
  options.validate();
  auto state = std::make_shared<ImplicitSurface::State>();
  const bool amls = options.method == ImplicitMethod::amls;
  const bool gaussian = options.weights == SurfaceWeights::gaussian;
  ImplicitOptions chosen = options;
  double smoothing = options.smoothing.value_or(default_smoothing(samples, options.method));
  smooth_noisy_normals(samples, default_smoothing(samples));
  if (options.method == ImplicitMethod::hoppe) move_noisy_to_means(samples, smoothing);
  detail::IterationOptions iteration{options.order.value_or(4), options.iterations.value_or(0), options.separate_sheets,
                                     gaussian};
  // ε d²/h² is equivalent to a width of h/√ε.
  if (options.epsilon) {
    const double narrower = 1 / std::sqrt(*options.epsilon);
    chosen.smoothing = smoothing * narrower;
    if (options.bandwidth) chosen.bandwidth = *options.bandwidth * narrower;
    check_argument(
        options.bandwidth || (*chosen.smoothing >= 0.3 && *chosen.smoothing <= 20),
        "`smoothing` over the square root of `epsilon`, the width of the weights in spacings, must be in 0.3..20");
  }
  if (chosen.bandwidth) detail::check_width(samples, *chosen.bandwidth);
  if (amls && !chosen.bandwidth && (!chosen.smoothing || !chosen.iterations || !chosen.order)) {
    progress.begin("cross validation");
    const detail::IterationChoice choice = choose(samples, chosen, iteration);
    chosen.smoothing = choice.smoothing;
    iteration.order = choice.order;
    iteration.iterations = choice.iterations;
    progress.finish();
  }

  if (!chosen.smoothing) chosen.smoothing = smoothing;
  std::vector<float> widths = detail::weight_widths(samples, *chosen.smoothing, chosen.bandwidth, options.weights);
  if (options.method == ImplicitMethod::dey) {
    const std::vector<float> feature = estimate_feature_size(samples, progress);
    for (std::size_t i = 0; i < widths.size(); ++i)
      widths[i] = std::clamp(static_cast<float>(kFeatureShare) * feature[i], widths[i],
                             static_cast<float>(kMostWidth) * widths[i]);
  }
  detail::IteratedPlanes planes{samples.normals, std::vector<float>(samples.size(), 0)};
  if (amls) planes = detail::iterate_planes(samples, widths, iteration, progress);

  progress.begin("supports");
  state->candidates = detail::Candidates(samples, widths, amls ? SurfaceWeights::gaussian : options.weights,
                                         options.reach.value_or(default_reach(samples)));
  const std::size_t n = samples.size();
  if (gaussian) state->candidates.equalize_areas();
  const bool crowds = gaussian && options.method == ImplicitMethod::kolluri;
  const std::vector<float> shares = crowds ? shares_of_crowds(samples, widths) : std::vector<float>{};
  for (std::size_t i = 0; i < n; ++i) {
    detail::Candidate& c = state->candidates.all()[i];
    c.mx = planes.m[i].x, c.my = planes.m[i].y, c.mz = planes.m[i].z;
    c.plane_m = planes.offset[i];
    if (crowds) c.weight = shares[i];
  }
  state->kernel = {formula_of(options), iteration.order,
                   options.separate_sheets && options.method != ImplicitMethod::hoppe, gaussian};
  std::vector<float> relative(n);
  for (std::size_t i = 0; i < n; ++i) relative[i] = widths[i] / samples.spacing[i];
  state->report = {samples.median_spacing, samples.noise, static_cast<double>(median(relative)), iteration.order,
                   iteration.iterations};
  state->samples = std::move(samples);
  progress.finish();
  return ImplicitSurface(std::move(state));
}

Box3 ImplicitSurface::bounds() const { return state_->candidates.bounds(); }
const SurfaceSamples& ImplicitSurface::samples() const { return state_->samples; }
const ImplicitReport& ImplicitSurface::report() const { return state_->report; }
BallUnion ImplicitSurface::balls() const { return {state_->samples.positions, state_->candidates.reach()}; }

void ImplicitSurface::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  state_->evaluate(x, values, gradients, {});
}

void ImplicitSurface::evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                         std::span<std::uint8_t> inside) const {
  state_->evaluate(x, values, gradients, inside);
}

void ImplicitSurface::iterated_normals(std::span<const Vec3> x, std::span<Vec3> normals) const {
  if (state_->kernel.formula != detail::ImplicitFormula::amls)
    throw ArgumentError("only the surface amls has `normal` = iterated");
  if (normals.size() != x.size()) throw ArgumentError("iterated_normals: as many normals as points are needed");
  state_->candidates.for_each_group(
      x, [&](const detail::PointGroup& group, std::span<const detail::Candidate> candidates, bool mixed) {
        detail::GroupValues out;
        detail::ImplicitKernel how = state_->kernel;
        how.sheets = how.sheets && mixed;
        detail::implicit_normals(how, candidates, group, out);
        for (std::size_t k = 0; k < group.count; ++k) {
          const Vec3 n(Vec3f{out.x[k], out.y[k], out.z[k]});
          if (out.weight[k] > 0 && squared_norm(n) > 0) normals[group.slot[k]] = normalized(n);
        }
      });
}

}  // namespace sansmesh::inline v1
