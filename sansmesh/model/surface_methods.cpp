#include "sansmesh/model/surface_methods.h"

#include <algorithm>
#include <iterator>

#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

using Option = SurfaceOption;

constexpr Option kOfWeights[] = {Option::smoothing, Option::bandwidth, Option::weights, Option::separate_sheets,
                                 Option::sharp};
constexpr Option kOfNearest[] = {Option::smoothing, Option::bandwidth, Option::sharp};
constexpr Option kOfMeanPlanes[] = {Option::smoothing, Option::bandwidth,       Option::weights,
                                    Option::normal,    Option::separate_sheets, Option::sharp};
constexpr Option kOfIterations[] = {Option::smoothing, Option::bandwidth,       Option::weights,
                                    Option::order,     Option::iterations,      Option::epsilon,
                                    Option::normal,    Option::separate_sheets, Option::sharp};
constexpr Option kOfPolynomials[] = {Option::smoothing,  Option::bandwidth,       Option::weights,
                                     Option::polynomial, Option::separate_sheets, Option::sharp};
constexpr Option kOfLeastPlanes[] = {Option::smoothing,  Option::bandwidth,       Option::weights, Option::plane,
                                     Option::polynomial, Option::separate_sheets, Option::sharp};
constexpr Option kOfCurvatures[] = {Option::smoothing, Option::bandwidth,       Option::weights,
                                    Option::flow,      Option::diffusion,       Option::threshold,
                                    Option::tau,       Option::separate_sheets, Option::sharp};

constexpr Option kOfOctrees[] = {Option::error, Option::max_depth, Option::smooth};

constexpr SurfaceMethodInfo kMethods[] = {
    {SurfaceMethod::partition,
     "partition",
     {},
     "local polynomials, blended (adaptive partition of unity): closed, with creases",
     {},
     "partition-of-unity.md",
     "its supports and its creases follow the data"},
    {SurfaceMethod::hoppe, "hoppe", ImplicitMethod::hoppe, "tangent plane of the nearest sample: to compare with",
     kOfNearest, "implicit-surfaces.md"},
    {SurfaceMethod::adamson, "adamson", ImplicitMethod::adamson, "mean plane of the samples: to compare with",
     kOfMeanPlanes, "implicit-surfaces.md"},
    {SurfaceMethod::kolluri, "kolluri", ImplicitMethod::kolluri, "mean of the tangent planes", kOfWeights,
     "implicit-surfaces.md"},
    {SurfaceMethod::dey, "dey", ImplicitMethod::dey, "mean of the tangent planes, weights wider where the shape allows",
     kOfWeights, "implicit-surfaces.md"},
    {SurfaceMethod::extremal, "extremal", ImplicitMethod::extremal,
     "extrema of an energy of distances: to compare with", kOfWeights, "implicit-surfaces.md"},
    {SurfaceMethod::apss, "apss", ImplicitMethod::apss, "algebraic spheres: the one to begin with", kOfWeights,
     "implicit-surfaces.md"},
    {SurfaceMethod::amls, "amls", ImplicitMethod::amls, "iterated approximate moving least squares of order 2, 4 or 6",
     kOfIterations, "implicit-surfaces.md"},
    {SurfaceMethod::levin, "levin", ProjectionMethod::levin,
     "polynomials over planes that are found by iteration (projection)", kOfLeastPlanes, "projections.md"},
    {SurfaceMethod::alexa, "alexa", ProjectionMethod::alexa,
     "polynomials over planes that are found in one step (projection)", kOfPolynomials, "projections.md"},
    {SurfaceMethod::curvature, "curvature", ProjectionMethod::curvature,
     "principal curvatures over mean planes (projection)", kOfCurvatures, "projections.md"},
    {SurfaceMethod::mpu, "mpu", MpuFormula{},
     "quadrics on an octree, with edges and corners, blended (MPU): closed; for clean parts", kOfOctrees, "mpu.md",
     "its balls follow the data, and its edges are those of its pieces"},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < std::size(kMethods); ++i)
    if (static_cast<std::size_t>(kMethods[i].method) != i) return false;
  return true;
}
static_assert(in_order(), "the table is indexed by the method");

}  // namespace

const char* field_name(SurfaceOption option) {
  static constexpr const char* kNames[kSurfaceOptions] = {
      "smoothing", "bandwidth", "weights",   "order", "iterations",      "epsilon", "normal", "plane",     "polynomial",
      "flow",      "diffusion", "threshold", "tau",   "separate_sheets", "sharp",   "error",  "max_depth", "smooth"};
  return kNames[static_cast<std::size_t>(option)];
}

bool SurfaceMethodInfo::heeds(SurfaceOption option) const {
  return std::find(options.begin(), options.end(), option) != options.end();
}

std::span<const SurfaceMethodInfo> surface_methods() { return kMethods; }

const SurfaceMethodInfo& surface_method_info(SurfaceMethod method) {
  const auto i = static_cast<std::size_t>(method);
  if (i >= std::size(kMethods)) throw ArgumentError("`method` is none of " + surface_method_names());
  return kMethods[i];
}

SurfaceMethod surface_method(std::string_view name) {
  for (const SurfaceMethodInfo& info : kMethods)
    if (name == info.name) return info.method;
  throw ArgumentError("unknown surface '" + printable(name, 40) + "': known are " + surface_method_names());
}

std::string surface_method_names() {
  std::string text;
  for (const SurfaceMethodInfo& info : kMethods) text += (text.empty() ? "" : ", ") + std::string(info.name);
  return text;
}

std::string heeded_by(SurfaceOption option) {
  std::string text;
  for (const SurfaceMethodInfo& info : kMethods)
    if (info.heeds(option)) text += (text.empty() ? "" : ", ") + std::string(info.name);
  return text;
}

}  // namespace sansmesh
