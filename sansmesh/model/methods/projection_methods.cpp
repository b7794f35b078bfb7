// Surfaces as the fixed points of projections (docs/methods/projections.md).
#include <memory>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/surface/implicit_surface.h"
#include "sansmesh/surface/projection_surface.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {
namespace {

ProjectionOptions projection_options(const SurfaceOptions& options) {
  ProjectionOptions o;
  o.method = projection_method(options.method);
  o.smoothing = options.smoothing, o.bandwidth = options.bandwidth, o.weights = options.weights;
  o.plane = options.reference_plane, o.polynomial = options.polynomial;
  o.flow = options.flow, o.diffusion = options.diffusion;
  o.threshold = options.diffusion_threshold.value_or(o.threshold), o.tau = options.tau.value_or(o.tau);
  o.separate_sheets = options.separate_sheets;
  return o;
}

void check_projection(const SurfaceOptions& options) { projection_options(options).validate(); }

/// Signed distance to the foot point near the surface; farther away, a field that classifies inside and outside.
struct SidedField {
  std::shared_ptr<const ProjectionSurface> projection;
  ImplicitSurface beyond;
  ProjectionField field{*projection, &beyond};

  SidedField(std::shared_ptr<const ProjectionSurface> p, ImplicitSurface b)
      : projection(std::move(p)), beyond(std::move(b)) {}
};

SurfaceParts make_projection(PreparedCloud& cloud, const SurfaceOptions& options, Progress& progress) {
  const auto surface = std::make_shared<const ProjectionSurface>(make_projection_surface(
      prepare_samples(cloud.points, progress, cloud.noise), projection_options(options), progress));
  SurfaceParts parts;
  parts.projection = surface;
  parts.make_field = [surface](Progress& p) -> std::shared_ptr<const ScalarField> {
    p.begin("sides of the surface");
    p.check();
    const auto sided = std::make_shared<const SidedField>(
        surface, make_implicit_surface(surface->samples(), {.method = ImplicitMethod::kolluri}, p));
    p.finish();
    return {sided, &sided->field};
  };
  parts.support = surface->balls();
  parts.samples = {surface, &surface->samples()};
  parts.spacings = parts.samples->spacing;
  parts.spacing = parts.samples->median_spacing, parts.noise = parts.samples->noise;
  parts.smoothing = surface->smoothing();
  return parts;
}

constexpr std::string_view kOfLeastPlanes[] = {"smoothing",  "bandwidth",       "weights", "reference_plane",
                                               "polynomial", "separate_sheets", "sharp"};
constexpr std::string_view kOfPolynomials[] = {"smoothing",  "bandwidth",       "weights",
                                               "polynomial", "separate_sheets", "sharp"};
constexpr std::string_view kOfCurvatures[] = {
    "smoothing", "bandwidth", "weights", "flow", "diffusion", "diffusion_threshold", "tau", "separate_sheets", "sharp"};

constexpr SurfaceMethod projecting(std::string_view name, std::string_view summary,
                                   std::span<const std::string_view> uses) {
  return {.name = name,
          .summary = summary,
          .page = "projections.md",
          .make = make_projection,
          .uses = uses,
          .projects = true,
          .check = check_projection};
}

constexpr SurfaceMethod kProjecting[] = {
    projecting("levin", "polynomials over planes that are found by iteration (projection)", kOfLeastPlanes),
    projecting("alexa", "polynomials over planes that are found in one step (projection)", kOfPolynomials),
    projecting("curvature", "principal curvatures over mean planes (projection)", kOfCurvatures)};

}  // namespace

std::span<const SurfaceMethod> projection_methods() { return kProjecting; }

}  // namespace sansmesh::inline v1
