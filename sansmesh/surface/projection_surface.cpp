#include "sansmesh/surface/projection_surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sansmesh/core/check_range.h"
#include "sansmesh/surface/candidates.h"
#include "sansmesh/surface/feet_of_groups.h"
#include "sansmesh/surface/implicit_surface.h"
#include "sansmesh/surface/projection_kernels.h"
#include "sansmesh/surface/published_projection.h"

namespace sansmesh::inline v1 {
namespace {

/// Increment of the width over the spacing relative to implicit functions: the polynomials need about a dozen samples.
/// The curvature fit has four unknowns, not six: without noise it is as exact as the others on fewer samples.
constexpr double kMore = 0.1, kFewer = 0.2, kMostSmoothing = 5;
/// The same for the polynomials of 3, 6, 10 and 15 unknowns.
constexpr double kMoreOfDegree[] = {0, 0, kMore, 0.3, 0.5};

}  // namespace

struct ProjectionSurface::State {
  SurfaceSamples samples;
  detail::ProjectionKernel kernel;
  detail::Candidates candidates;
  double smoothing = 0;
};

ProjectionMethod projection_method(std::string_view name) {
  const auto known = std::find(std::begin(kProjectionMethods), std::end(kProjectionMethods), name);
  check_argument(known != std::end(kProjectionMethods), "`method` is no projection");
  return static_cast<ProjectionMethod>(known - std::begin(kProjectionMethods));
}

void ProjectionOptions::validate() const {
  if (smoothing) check_range("smoothing", *smoothing, 0.5, 20);
  check_argument(!bandwidth || (std::isfinite(*bandwidth) && *bandwidth > 0), "`bandwidth` must be a positive length");
  if (reach) check_range("reach", *reach, 0.5, 10);
  check_argument(std::isfinite(threshold) && threshold > 0, "`threshold` must be positive");
  check_argument(tau >= 1 && tau <= 3, "`tau` must be 1, 2 or 3");
  check_argument(flow == SurfaceFlow::fit || method == ProjectionMethod::curvature,
                 "only the surface curvature has `flow`");
  check_argument(plane == SurfacePlane::iterated || method == ProjectionMethod::levin,
                 "only the surface levin has `plane`");
  check_argument(polynomial == SurfacePolynomial::quadratic || method != ProjectionMethod::curvature,
                 "only the surfaces levin and alexa have `polynomial`");
}

ProjectionSurface make_projection_surface(SurfaceSamples samples, const ProjectionOptions& options,
                                          Progress& progress) {
  options.validate();
  if (options.bandwidth) detail::check_width(samples, *options.bandwidth);
  auto state = std::make_shared<ProjectionSurface::State>();
  progress.begin("supports");
  const double ratio = samples.noise / samples.median_spacing;
  const bool curvature = options.method == ProjectionMethod::curvature;
  const bool incomplete = options.polynomial == SurfacePolynomial::incomplete;
  const int degree = incomplete ? 2 : static_cast<int>(options.polynomial);
  const double more = kMoreOfDegree[degree] - (curvature ? std::max(kFewer - ratio, 0.0) : 0.0);
  state->smoothing = options.smoothing.value_or(std::min(default_smoothing(samples) + more, kMostSmoothing));
  smooth_noisy_normals(samples, state->smoothing);
  const bool gaussian = options.weights == SurfaceWeights::gaussian;
  const std::vector<float> widths =
      detail::weight_widths(samples, state->smoothing, options.bandwidth, options.weights);
  state->candidates =
      detail::Candidates(samples, widths, options.weights, options.reach.value_or(default_reach(samples)));
  if (gaussian) state->candidates.equalize_areas();
  state->kernel = {options.method,
                   options.separate_sheets,
                   gaussian,
                   options.diffusion != SurfaceDiffusion::none,
                   options.diffusion == SurfaceDiffusion::hard,
                   static_cast<float>(options.threshold),
                   options.tau,
                   options.flow,
                   options.plane == SurfacePlane::nonlinear,
                   degree,
                   incomplete};
  state->samples = std::move(samples);
  progress.finish();
  return ProjectionSurface(std::move(state));
}

Box3 ProjectionSurface::bounds() const { return state_->candidates.bounds(); }
BallUnion ProjectionSurface::balls() const { return {state_->samples.positions, state_->candidates.reach()}; }
const SurfaceSamples& ProjectionSurface::samples() const { return state_->samples; }
double ProjectionSurface::smoothing() const { return state_->smoothing; }

void ProjectionSurface::project(std::span<const Vec3> x, std::span<FootPoint> feet) const {
  detail::project_groups(state_->candidates, x, feet,
                         [&](const detail::PointGroup& group, std::span<const detail::Candidate> chosen, bool mixed,
                             detail::GroupFeet& out) {
                           detail::ProjectionKernel how = state_->kernel;
                           how.sheets = how.sheets && mixed;
                           if (how.as_published())
                             detail::project_group_as_published(how, chosen, group, out);
                           else
                             detail::project_group(how, chosen, group, out);
                         });
}

}  // namespace sansmesh::inline v1
