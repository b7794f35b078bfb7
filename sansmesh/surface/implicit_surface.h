// Surfaces as zero sets of weighted means of the samples: nothing is fitted beforehand but a few numbers per sample,
// and nothing is solved (METHODS §2.1, §2.3).
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
  hoppe,     ///< tangent plane of the nearest sample (Hoppe et al. 1992)
  adamson,   ///< distance from the mean of the samples along the mean normal (Adamson & Alexa 2003)
  kolluri,   ///< mean of the tangent planes, samples weighted by the area they stand for (Kolluri 2005)
  dey,       ///< the same with supports that follow the feature size (Dey & Sun 2005)
  extremal,  ///< extremum along the normal of the energy of the distances (Amenta & Kil 2004)
  apss,      ///< algebraic sphere fitted to the samples and their normals (Guennebaud & Gross 2007)
  amls       ///< iterated approximate moving least squares (tejada2008 §4.3.1)
};

/// In the order of the enumerators.
inline constexpr std::string_view kImplicitMethods[] = {"hoppe",    "adamson", "kolluri", "dey",
                                                        "extremal", "apss",    "amls"};
/// Throws ArgumentError for a name that is none of them.
ImplicitMethod implicit_method(std::string_view name);

struct ImplicitOptions {
  using Normal = SurfaceNormal;
  ImplicitMethod method = ImplicitMethod::apss;
  /// Width h of the weights, exp(−d²/h²) or the compact (1 − d²/(2h)²)⁴ that resembles it, as a multiple of the local
  /// spacing of the samples, 0.5..20; default: from the noise.
  std::optional<double> smoothing = {};
  /// Width of the weights as one length for the whole cloud, in place of `smoothing`.
  std::optional<double> bandwidth = {};
  std::optional<int> order = {};  ///< amls: order of the approximation, 2, 4 or 6; default: 2 or 4, by cross validation
  std::optional<int> iterations = {};  ///< amls: 0..100; default: by leave-one-out cross validation, with the width
  /// amls: shape parameter ε of the generating functions, r = ε d²/h², 0.05..20; default: 1, and h by cross validation.
  /// Where it is given, h is by itself that of the other methods.
  std::optional<double> epsilon = {};
  SurfaceWeights weights = SurfaceWeights::compact;  ///< not of hoppe; amls is always Gaussian: one h for all
  SurfaceNormal normal = SurfaceNormal::standard;
  bool separate_sheets = true;  ///< samples that face away from those nearby are ignored
  /// Radius of the balls that the surface is defined in, as a multiple of the local spacing, 0.5..10; default:
  /// `default_reach`.
  std::optional<double> reach = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What was chosen for the data.
struct ImplicitReport {
  double spacing = 0, noise = 0;  ///< of the samples (length)
  double smoothing = 0;           ///< median width over median spacing
  int order = 0, iterations = 0;  ///< amls
};

/// Defined in balls around the samples: there a change of sign is the surface.
/// Within about a third of the weights' width from the surface the value is the method's own; farther out it goes over
/// to the mean of the tangent planes, as far as supports reach; beyond, it is the mean of those of the nearest samples,
/// and from six spacings on the signed distance to the nearest one. Gradients are exact derivatives but for the choice
/// of sheet, whose weights are taken as constant, and beyond the supports, where all weights are.
class ImplicitSurface : public ScalarField {
 public:
  ~ImplicitSurface() override;
  ImplicitSurface(ImplicitSurface&&) noexcept;
  ImplicitSurface& operator=(ImplicitSurface&&) noexcept;

  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;

  /// The balls of the domain of definition.
  BallUnion balls() const;
  const SurfaceSamples& samples() const;
  const ImplicitReport& report() const;

  /// amls: unit vectors along Nᵏ(x) = Σ n_i φ_i(x), iterated k times as the values are (tejada2008 §4.3.1): with
  /// m = Σ_k (I − A)^k n it is Σ m_i φ_i(x). Where no support reaches, normals stay as they are. Sizes must agree.
  /// Throws ArgumentError for other methods.
  void iterated_normals(std::span<const Vec3> x, std::span<Vec3> normals) const;

  struct State;  ///< internal

 private:
  friend ImplicitSurface make_implicit_surface(SurfaceSamples, const ImplicitOptions&, Progress&);
  explicit ImplicitSurface(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The iterated normals of a surface of amls.
class IteratedNormals : public NormalField {
 public:
  explicit IteratedNormals(std::shared_ptr<const ImplicitSurface> surface) : surface_(std::move(surface)) {}
  void refine(std::span<const Vec3> x, std::span<Vec3> normals) const override {
    surface_->iterated_normals(x, normals);
  }

 private:
  std::shared_ptr<const ImplicitSurface> surface_;
};

/// Throws ArgumentError for bad options.
ImplicitSurface make_implicit_surface(SurfaceSamples samples, const ImplicitOptions& options, Progress& progress);

/// Width of the weights over the spacing that suits the samples: just enough to connect them where they lie evenly
/// and without noise, wider otherwise.
double default_smoothing(const SurfaceSamples& samples, ImplicitMethod method = ImplicitMethod::apss);

}  // namespace sansmesh::inline v1
