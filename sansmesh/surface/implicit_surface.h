// Surfaces as zero sets of weighted means of the samples: the precomputation is a few numbers per sample, and no system
// is solved.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/normal_field.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::inline v1 {

enum class ImplicitMethod {
  hoppe,     ///< tangent plane of the nearest sample (hoppe1992)
  adamson,   ///< distance from the mean of the samples along the mean normal (adamson2003)
  kolluri,   ///< mean of the tangent planes, samples weighted by their area (kolluri2005)
  dey,       ///< the same with supports that follow the feature size (dey2005)
  extremal,  ///< extremum along the normal of the energy of the distances (amenta2004)
  apss,      ///< algebraic sphere fitted to the samples and their normals (guennebaud2007)
  amls       ///< iterated approximate moving least squares (tejada2008, 4.3.1)
};

/// Names in the order of the enumerators.
inline constexpr std::string_view kImplicitMethods[] = {"hoppe",    "adamson", "kolluri", "dey",
                                                        "extremal", "apss",    "amls"};
/// Throws ArgumentError for an unknown name.
ImplicitMethod implicit_method(std::string_view name);

struct ImplicitOptions {
  ImplicitMethod method = ImplicitMethod::apss;
  /// Width h of the weights, exp(−d²/h²) or the similar compact (1 − d²/(2h)²)⁴, as a multiple of the local spacing of
  /// the samples, 0.5..20; default: from the noise.
  std::optional<double> smoothing = {};
  /// Width of the weights as one length for the whole cloud, replaces `smoothing`.
  std::optional<double> bandwidth = {};
  std::optional<int> order = {};  ///< amls: order of the approximation, 2, 4 or 6; default: 2 or 4, by cross validation
  std::optional<int> iterations = {};  ///< amls: 0..100; default: by leave-one-out cross validation, with the width
  /// amls: shape parameter ε of the generating functions, r = ε d²/h², 0.05..20; default: 1, with h by cross
  /// validation. If it is given, the default of h is that of the other methods.
  std::optional<double> epsilon = {};
  SurfaceWeights weights = SurfaceWeights::compact;  ///< not used by hoppe; amls is always Gaussian with one h
  SurfaceNormal normal = SurfaceNormal::standard;
  bool separate_sheets = true;  ///< samples that face away from those nearby are ignored
  /// Radius of the balls of the domain of definition, as a multiple of the local spacing, 0.5..10; default:
  /// `default_reach`.
  std::optional<double> reach = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Parameters derived from the data.
struct ImplicitReport {
  double spacing = 0, noise = 0;  ///< spacing and noise of the samples (length)
  double smoothing = 0;           ///< median width over median spacing
  int order = 0, iterations = 0;  ///< amls
};

/// Defined in balls around the samples; the surface is the change of sign there.
/// Within about a third of the weights' width from the surface the value is that of the method. Farther out it blends
/// into the mean of the tangent planes within the supports; beyond them it is the mean of those of the nearest samples,
/// and from six spacings on the signed distance to the nearest one. Gradients are exact derivatives, except that the
/// weights of the choice of sheet, and beyond the supports all weights, are treated as constant.
class ImplicitSurface : public ScalarField {
 public:
  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;

  /// The balls of the domain of definition.
  BallUnion balls() const;
  const SurfaceSamples& samples() const;
  const ImplicitReport& report() const;

  /// amls: unit vectors along Nᵏ(x) = Σ n_i φ_i(x), iterated k times like the values (tejada2008, 4.3.1): with m = Σ_k
  /// (I − A)^k n it is Σ m_i φ_i(x). Normals outside all supports are unchanged. Sizes must agree. Throws ArgumentError
  /// for other methods.
  void iterated_normals(std::span<const Vec3> x, std::span<Vec3> normals) const;

  struct State;

 private:
  friend ImplicitSurface make_implicit_surface(SurfaceSamples, const ImplicitOptions&, Progress&);
  explicit ImplicitSurface(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  std::shared_ptr<const State> state_;
};

/// Iterated normals of an amls surface.
class IteratedNormals : public NormalField {
 public:
  explicit IteratedNormals(std::shared_ptr<const ImplicitSurface> surface) : surface_(std::move(surface)) {}
  void refine(std::span<const Vec3> x, std::span<Vec3> normals) const override {
    surface_->iterated_normals(x, normals);
  }

 private:
  std::shared_ptr<const ImplicitSurface> surface_;
};

/// Throws ArgumentError for invalid options.
ImplicitSurface make_implicit_surface(SurfaceSamples samples, const ImplicitOptions& options, Progress& progress);

/// Recommended width of the weights over the spacing: for even samples without noise just wide enough to connect them,
/// otherwise wider.
double default_smoothing(const SurfaceSamples& samples, ImplicitMethod method = ImplicitMethod::apss);

}  // namespace sansmesh::inline v1
