#include "sansmesh/surface/implicit_surface.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/surface/feature_size.h"
#include "sansmesh/surface/implicit_kernels.h"
#include "sansmesh/surface/iterated_planes.h"

namespace sansmesh {
namespace {

constexpr double kCompactSupport = 2;         // R / h of the compact weights
constexpr double kGaussianSupport = 3.4641;   // where the kernels cut Gaussians off: √12
/// Thickness of the domain, as a share of the width of the weights: within it no formula changes its sign twice. The
/// generating functions of orders 4 and 6 do so at 1.22 and 0.96 widths from a plane, the extremal energy at 0.8.
constexpr double kSlab = 0.75;
/// Boxes of groups of points over the median spacing: smaller ones waste lanes, larger ones waste samples.
constexpr double kGroupExtent = 1.5;
/// Widths that Dey & Sun's supports stay between, over the spacing, and their share of the feature size.
constexpr double kLeastWidth = 1, kMostWidth = 2.5, kFeatureShare = 0.35;

struct Name {
  ImplicitMethod method;
  const char* name;
};
constexpr Name kNames[] = {{ImplicitMethod::hoppe, "hoppe"},       {ImplicitMethod::adamson, "adamson"},
                           {ImplicitMethod::kolluri, "kolluri"},   {ImplicitMethod::dey, "dey"},
                           {ImplicitMethod::extremal, "extremal"}, {ImplicitMethod::apss, "apss"},
                           {ImplicitMethod::amls, "amls"}};

detail::ImplicitFormula formula_of(ImplicitMethod method) {
  using F = detail::ImplicitFormula;
  switch (method) {
    case ImplicitMethod::hoppe:
      return F::hoppe;
    case ImplicitMethod::adamson:
      return F::adamson;
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

}  // namespace

struct ImplicitSurface::State {
  SurfaceSamples samples;
  ImplicitReport report;
  detail::ImplicitKernel kernel;
  std::vector<detail::Candidate> candidates;  // positions relative to the cloud's origin
  std::vector<float> reach;
  BallTree supports;
  Box3 bounds;
  double extent = 0;

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint8_t> inside) const;
  void beyond_supports(const Vec3& x, double& value, Vec3* gradient) const;
};

void ImplicitSurface::State::beyond_supports(const Vec3& x, double& value, Vec3* gradient) const {
  const auto nearest = samples.tree.nearest(Vec3f(x));
  if (!nearest) {
    value = bounds.diagonal();
    if (gradient) *gradient = {};
    return;
  }
  const Vec3 d = x - Vec3(samples.positions[nearest->index]);
  const Vec3 n(samples.normals[nearest->index]);
  const double distance = norm(d);
  const double sign = dot(d, n) < 0 ? -1 : 1;
  value = sign * distance;
  if (gradient) *gradient = distance > 0 ? d * (sign / distance) : n;
}

void ImplicitSurface::State::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                      std::span<std::uint8_t> inside) const {
  struct Scratch {
    std::vector<std::uint32_t> near;
    std::vector<detail::Candidate> chosen;
  };
  thread_local Scratch scratch;
  detail::GroupValues out;
  detail::for_each_group(x, extent, [&](const detail::PointGroup& group, const Box3f& box) {
    supports.touching(box, scratch.near);
    scratch.chosen.resize(scratch.near.size());
    const Vec3f& o = group.center;
    for (std::size_t k = 0; k < scratch.near.size(); ++k) {
      detail::Candidate& c = scratch.chosen[k];
      c = candidates[scratch.near[k]];
      c.x -= o.x, c.y -= o.y, c.z -= o.z;
      c.plane = c.x * c.nx + c.y * c.ny + c.z * c.nz;
      c.square = c.x * c.x + c.y * c.y + c.z * c.z;
      c.plane_m += c.x * c.mx + c.y * c.my + c.z * c.mz;
    }
    detail::implicit_values(kernel, scratch.chosen, group, !gradients.empty(), out);
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

ImplicitMethod implicit_method(const std::string& name) {
  std::string known;
  for (const Name& n : kNames) {
    if (name == n.name) return n.method;
    known += (known.empty() ? "" : ", ") + std::string(n.name);
  }
  throw ArgumentError("unknown surface '" + name + "': known are " + known);
}

const std::vector<std::string>& implicit_method_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const Name& n : kNames) result.emplace_back(n.name);
    return result;
  }();
  return names;
}

void ImplicitOptions::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw ArgumentError(what);
  };
  check(!smoothing || (*smoothing >= 0.5 && *smoothing <= 20), "smoothing must lie in 0.5..20");
  check(!width || (std::isfinite(*width) && *width > 0), "width must be a positive length");
  check(order == 2 || order == 4 || order == 6, "order must be 2, 4 or 6");
  check(!iterations || (*iterations >= 0 && *iterations <= 100), "iterations must lie in 0..100");
  check(reach >= 0.5 && reach <= 10, "reach must lie in 0.5..10");
}

double default_smoothing(const SurfaceSamples& samples) {
  const double ratio = samples.noise / samples.median_spacing;
  return std::clamp(1.2 + 1.5 * ratio, 1.2, 4.0);
}

ImplicitSurface make_implicit_surface(SurfaceSamples samples, const ImplicitOptions& options, Progress& progress) {
  options.validate();
  auto state = std::make_unique<ImplicitSurface::State>();
  const bool gaussian = options.method == ImplicitMethod::amls;
  detail::IterationOptions iteration{options.order, options.iterations.value_or(0), options.separate_sheets};
  double smoothing = options.smoothing.value_or(default_smoothing(samples));
  if (gaussian && !options.width && (!options.smoothing || !options.iterations)) {
    progress.begin("cross validation");
    const auto choice = detail::choose_iterations(samples, iteration, options.smoothing.value_or(0),
                                                  options.iterations.value_or(-1));
    smoothing = choice.smoothing;
    iteration.iterations = choice.iterations;
    progress.finish();
  }

  std::vector<float> widths = samples.spacing;
  for (float& w : widths) w = options.width ? static_cast<float>(*options.width) : w * static_cast<float>(smoothing);
  if (options.method == ImplicitMethod::dey) {
    const std::vector<float> feature = estimate_feature_size(samples, progress);
    for (std::size_t i = 0; i < widths.size(); ++i)
      widths[i] = std::clamp(static_cast<float>(kFeatureShare) * feature[i],
                             static_cast<float>(kLeastWidth) * samples.spacing[i],
                             static_cast<float>(std::max(kMostWidth, smoothing)) * samples.spacing[i]);
  }
  detail::IteratedPlanes planes{samples.normals, std::vector<float>(samples.size(), 0)};
  if (gaussian) planes = detail::iterate_planes(samples, widths, iteration, progress);

  progress.begin("supports");
  const std::size_t n = samples.size();
  std::vector<float> radii(n);
  state->reach.resize(n), state->candidates.resize(n);
  Box3f box;
  for (std::size_t i = 0; i < n; ++i) {
    detail::Candidate& c = state->candidates[i];
    const Vec3f &p = samples.positions[i], &normal = samples.normals[i];
    const float h = widths[i], s = samples.spacing[i];
    radii[i] = h * static_cast<float>(gaussian ? kGaussianSupport : kCompactSupport);
    const float reach = std::min(s * static_cast<float>(options.reach), radii[i]);
    const float height = h * static_cast<float>(kSlab);
    c = {};
    c.x = p.x, c.y = p.y, c.z = p.z;
    c.inverse_support = gaussian ? 1 / (h * h) : 1 / (radii[i] * radii[i]);
    c.nx = normal.x, c.ny = normal.y, c.nz = normal.z;
    const float share = s / static_cast<float>(samples.median_spacing);
    c.weight = share * share;
    c.inverse_reach = 1 / (reach * reach);
    c.inverse_height = 1 / (height * height);
    c.mx = planes.m[i].x, c.my = planes.m[i].y, c.mz = planes.m[i].z;
    c.plane_m = planes.offset[i];
    state->reach[i] = reach;
    box.extend(p - Vec3f{reach, reach, reach});
    box.extend(p + Vec3f{reach, reach, reach});
  }
  state->supports = BallTree(samples.positions, radii);
  state->bounds = {Vec3(box.lower), Vec3(box.upper)};
  state->extent = kGroupExtent * samples.median_spacing;
  state->kernel = {formula_of(options.method), options.order,
                   options.separate_sheets && options.method != ImplicitMethod::hoppe};
  std::vector<float> ratio(n);
  for (std::size_t i = 0; i < n; ++i) ratio[i] = widths[i] / samples.spacing[i];
  std::nth_element(ratio.begin(), ratio.begin() + static_cast<std::ptrdiff_t>(n / 2), ratio.end());
  state->report = {samples.median_spacing, samples.noise, static_cast<double>(ratio[n / 2]), iteration.iterations};
  state->samples = std::move(samples);
  progress.finish();
  return ImplicitSurface(std::move(state));
}

ImplicitSurface::ImplicitSurface(std::unique_ptr<State> state) : state_(std::move(state)) {}
ImplicitSurface::~ImplicitSurface() = default;
ImplicitSurface::ImplicitSurface(ImplicitSurface&&) noexcept = default;
ImplicitSurface& ImplicitSurface::operator=(ImplicitSurface&&) noexcept = default;

Box3 ImplicitSurface::bounds() const { return state_->bounds; }
const SurfaceSamples& ImplicitSurface::samples() const { return state_->samples; }
const ImplicitReport& ImplicitSurface::report() const { return state_->report; }
BallUnion ImplicitSurface::balls() const { return {state_->samples.positions, state_->reach}; }

void ImplicitSurface::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  state_->evaluate(x, values, gradients, {});
}

void ImplicitSurface::evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                         std::span<std::uint8_t> inside) const {
  state_->evaluate(x, values, gradients, inside);
}

}  // namespace sansmesh
