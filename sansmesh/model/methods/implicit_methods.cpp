// Surfaces as zero sets of weighted means of the samples (docs/methods/implicit-surfaces.md).
#include <memory>

#include "sansmesh/error.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/surface/implicit_surface.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {
namespace {

using Normal = SurfaceOptions::Normal;

/// hoppe: adjacent patches do not meet.
constexpr double kJumpOfPatches = 0.5;

ImplicitOptions implicit_options(const SurfaceOptions& options) {
  ImplicitOptions o;
  o.method = implicit_method(options.method);
  o.smoothing = options.smoothing, o.bandwidth = options.bandwidth, o.weights = options.weights;
  o.order = options.order, o.iterations = options.iterations, o.epsilon = options.epsilon;
  o.normal = options.normal;
  o.separate_sheets = options.separate_sheets;
  return o;
}

void check_implicit(const SurfaceOptions& options) { implicit_options(options).validate(); }

SurfaceParts make_implicit(PreparedCloud& cloud, const SurfaceOptions& options, Progress& progress) {
  const auto surface = std::make_shared<const ImplicitSurface>(
      make_implicit_surface(prepare_samples(cloud.points, progress, cloud.noise), implicit_options(options), progress));
  SurfaceParts parts;
  parts.field = surface;
  parts.support = surface->balls();
  parts.samples = {surface, &surface->samples()};
  parts.spacings = parts.samples->spacing;
  if (options.normal == Normal::iterated) parts.normals = std::make_shared<const IteratedNormals>(surface);
  if (options.method == "hoppe") parts.traits.jump = kJumpOfPatches;
  parts.spacing = parts.samples->median_spacing, parts.noise = parts.samples->noise;
  parts.smoothing = surface->report().smoothing;
  parts.order = surface->report().order, parts.iterations = surface->report().iterations;
  return parts;
}

constexpr std::string_view kOfWeights[] = {"smoothing", "bandwidth", "weights", "separate_sheets", "sharp"};
constexpr std::string_view kOfNearest[] = {"smoothing", "bandwidth", "sharp"};
constexpr std::string_view kOfMeanPlanes[] = {"smoothing", "bandwidth",       "weights",
                                              "normal",    "separate_sheets", "sharp"};
constexpr std::string_view kOfIterations[] = {"smoothing", "bandwidth", "weights",         "order", "iterations",
                                              "epsilon",   "normal",    "separate_sheets", "sharp"};

constexpr SurfaceMethod implicit(std::string_view name, std::string_view summary,
                                 std::span<const std::string_view> uses) {
  return {.name = name,
          .summary = summary,
          .page = "implicit-surfaces.md",
          .make = make_implicit,
          .uses = uses,
          .check = check_implicit};
}

constexpr SurfaceMethod kImplicit[] = {
    implicit("hoppe", "tangent plane of the nearest sample; for comparison", kOfNearest),
    implicit("adamson", "mean plane of the samples; for comparison", kOfMeanPlanes),
    implicit("kolluri", "mean of the tangent planes", kOfWeights),
    implicit("dey", "mean of the tangent planes, weights wider where the shape allows", kOfWeights),
    implicit("extremal", "extrema of an energy of distances; for comparison", kOfWeights),
    implicit("apss", "algebraic spheres; recommended", kOfWeights),
    implicit("amls", "iterated approximate moving least squares of order 2, 4 or 6", kOfIterations)};

}  // namespace

std::span<const SurfaceMethod> implicit_methods() { return kImplicit; }

}  // namespace sansmesh::inline v1
