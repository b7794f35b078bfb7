// Surfaces as the fixed points of projection operators.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface/projection_kernels.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::inline v1 {

/// Names in the order of the enumerators.
inline constexpr std::string_view kProjectionMethods[] = {"levin", "alexa", "curvature"};
/// Throws ArgumentError for an unknown name.
ProjectionMethod projection_method(std::string_view name);

struct ProjectionOptions {
  ProjectionMethod method = ProjectionMethod::curvature;
  /// Width of the weights over the local spacing, 0.5..20; default: from the noise.
  std::optional<double> smoothing = {};
  std::optional<double> bandwidth = {};  ///< width of the weights as one length, replaces `smoothing`
  bool separate_sheets = true;           ///< samples that face away from those nearby are ignored
  /// Radius of the domain's balls over the local spacing, 0.5..10; default: `default_reach`.
  std::optional<double> reach = {};
  SurfaceDiffusion diffusion = SurfaceDiffusion::none;
  double threshold = 1;  ///< curvature: λ times the width, > 0
  int tau = 2;           ///< curvature: exponent of the M-like weights, 1..3
  SurfaceFlow flow = SurfaceFlow::fit;
  SurfacePlane plane = SurfacePlane::iterated;
  SurfacePolynomial polynomial = SurfacePolynomial::quadratic;
  SurfaceWeights weights = SurfaceWeights::compact;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

class ProjectionSurface : public Projection {
 public:
  Box3 bounds() const override;
  void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override;

  BallUnion balls() const;
  const SurfaceSamples& samples() const;
  double smoothing() const;

  struct State;

 private:
  friend ProjectionSurface make_projection_surface(SurfaceSamples, const ProjectionOptions&, Progress&);
  explicit ProjectionSurface(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  std::shared_ptr<const State> state_;
};

/// Throws ArgumentError for invalid options.
ProjectionSurface make_projection_surface(SurfaceSamples samples, const ProjectionOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
