// Surfaces as the points that a projection operator leaves where they are (METHODS §2.1, §2.2).
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::inline v1 {

enum class ProjectionMethod {
  levin,     ///< plane of least weighted squares over direction and offset, then a polynomial (Levin 2003)
  alexa,     ///< the same with weights about the point itself: one step (Alexa et al. 2003)
  curvature  ///< mean plane, then principal curvatures from directional ones (tejada2008 §4.2)
};

/// In the order of the enumerators.
inline constexpr std::string_view kProjectionMethods[] = {"levin", "alexa", "curvature"};
/// Throws ArgumentError for a name that is none of them.
ProjectionMethod projection_method(std::string_view name);

struct ProjectionOptions {
  ProjectionMethod method = ProjectionMethod::curvature;
  /// Width of the weights over the local spacing, 0.5..20; default: from the noise.
  std::optional<double> smoothing = {};
  std::optional<double> bandwidth = {};  ///< width of the weights as one length, in place of `smoothing`
  bool separate_sheets = true;           ///< samples that face away from those nearby are ignored
  /// Radius of the domain's balls over the local spacing, 0.5..10; default: `default_reach`.
  std::optional<double> reach = {};
  /// curvature: what to do about samples whose directional curvature exceeds λ: soft, they count less (Lange & Polthier
  /// 2005, g = λ²/(λ² + 10(|κ| − λ)²)); hard, not at all; none.
  enum class Diffusion { none, soft, hard } diffusion = Diffusion::none;
  double threshold = 1;  ///< curvature: λ times the width, > 0
  int tau = 2;           ///< curvature: exponent of the M-like weights, 1..3
  /// curvature: how a foot on the mean plane gets onto the surface: by the offset of the fit; or, as in the source, by
  /// steps x ← x + Δt (1/Ω) Σ ω_i g_i (x_i − x) to the fixed point, along the normal alone or freely, and then the fit
  /// without an offset. g_i are those of `diffusion`.
  enum class Flow { fit, normal, free } flow = Flow::fit;
  /// levin: how the plane is found: weighted planes about the foot of the last one, six times; or the least of
  /// Σ ⟨n, x_i − r − t n⟩² w(‖x_i − r − t n‖) over n and t, to convergence.
  enum class Plane { iterated, nonlinear } plane = Plane::iterated;
  /// levin, alexa: the polynomial over the plane, of degree 1 to 4 or [x², y², xy, 1]; lower where the samples do not
  /// determine it.
  enum class Polynomial { linear = 1, quadratic, cubic, quartic, incomplete } polynomial = Polynomial::quadratic;
  SurfaceWeights weights = SurfaceWeights::compact;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

class ProjectionSurface : public Projection {
 public:
  ~ProjectionSurface() override;
  ProjectionSurface(ProjectionSurface&&) noexcept;
  ProjectionSurface& operator=(ProjectionSurface&&) noexcept;

  Box3 bounds() const override;
  void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override;

  BallUnion balls() const;
  const SurfaceSamples& samples() const;
  double smoothing() const;

  struct State;  ///< internal

 private:
  friend ProjectionSurface make_projection_surface(SurfaceSamples, const ProjectionOptions&, Progress&);
  explicit ProjectionSurface(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Throws ArgumentError for bad options.
ProjectionSurface make_projection_surface(SurfaceSamples samples, const ProjectionOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
