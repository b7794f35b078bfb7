// Options of meshless surfaces, of curvature estimation, and of projections onto a surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/api.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Weight of a sample by its distance d from the query point.
enum class SurfaceWeights {
  compact,  ///< a_i (1 − d²/(2h_i)²)⁴: the width h_i follows the local spacing, a_i is the area of the sample
  gaussian  ///< exp(−d²/h²), cut off at √12 h: one h for the whole cloud, all samples weigh the same (published form)
};

/// Normals of mean planes, or normals reported beside the gradient.
enum class SurfaceNormal {
  standard,    ///< the method's own normals
  covariance,  ///< adamson: direction of least weighted covariance about x instead of the mean normal (adamson2003)
  iterated     ///< amls: N(x) = Σ n_i φ_i(x), iterated like the values, beside the gradient
};

/// Method "curvature": weight of samples whose directional curvature κ exceeds λ.
enum class SurfaceDiffusion {
  none,  ///< the same weight as all others
  soft,  ///< reduced weight, g = λ²/(λ² + 10(|κ| − λ)²) (lange2005)
  hard   ///< no weight
};

/// Method "curvature": step from the foot point on the mean plane onto the surface. The published steps (tejada2008,
/// 4.2) are x ← x + Δt (1/Ω) Σ ω_i g_i (x_i − x), with g_i of SurfaceDiffusion, to the fixed point; the fit after them
/// has no offset.
enum class SurfaceFlow {
  fit,     ///< offset of the fit
  normal,  ///< published steps, along the normal only
  free     ///< published steps, in any direction
};

/// Method "levin": search for the plane under the polynomial.
enum class SurfacePlane {
  iterated,  ///< six weighted planes, each about the foot point on the last one
  nonlinear  ///< minimum of Σ ⟨n, x_i − r − t n⟩² w(‖x_i − r − t n‖) over n and t, to convergence
};

/// Methods "levin" and "alexa": polynomial over the plane. The degree is lowered where the samples do not determine it.
enum class SurfacePolynomial {
  linear = 1,  ///< degree 1
  quadratic,   ///< degree 2
  cubic,       ///< degree 3
  quartic,     ///< degree 4
  incomplete   ///< x², y², xy and 1
};

/// Weights of normals that reproduce edges and corners (docs/methods/sharp-features.md).
enum class SharpFormula {
  bilateral,  ///< weights by distance and by the difference of normals
  /// Published weights (tejada2008, 4.3.2): Laguerre polynomial of the combined argument s_i = ε ‖x − x_i‖²/h² + ⟨n,
  /// x_i − x⟩²/(2σ²), (35/8 − 7/2 s + ½ s²) e^{−s}, with one h for the cloud. For evenly spread samples only: negative
  /// values amplify gaps of random samples.
  laguerre
};

/// Name of the default surface, which function files store: "partition".
inline constexpr std::string_view kPartitionSurface = "partition";

/// Choice of a meshless surface, and its options. Optional values are derived from the data where absent. Lengths are
/// in the unit of the input. Each method uses a subset; validate() rejects the others.
struct SANSMESH_API SurfaceOptions {
  using Normal = SurfaceNormal;          ///< short name
  using Plane = SurfacePlane;            ///< short name
  using Polynomial = SurfacePolynomial;  ///< short name
  using Flow = SurfaceFlow;              ///< short name
  using Diffusion = SurfaceDiffusion;    ///< short name

  std::string method = "apss";             ///< name of the method; an ArgumentError for an unknown name lists all
  std::optional<SharpFormula> sharp = {};  ///< weights that reproduce edges and corners; absent: none
  std::optional<double> smoothing = {};    ///< width of the weights over the local spacing, 0.5..20
  std::optional<double> bandwidth = {};    ///< the same width as one length for the whole cloud
  SurfaceWeights weights = SurfaceWeights::compact;  ///< weights of samples by their distance
  std::optional<int> order = {};                     ///< order of the approximation: 2, 4 or 6
  std::optional<int> iterations = {};                ///< iterations of the approximation, 0..100: 0 smooths most
  std::optional<double> epsilon = {};                ///< shape parameter of the approximation, 0.05..20
  Normal normal = Normal::standard;                  ///< normals of mean planes, or beside the gradient
  Plane reference_plane = Plane::iterated;           ///< plane under the polynomials
  Polynomial polynomial = Polynomial::quadratic;     ///< polynomial over the plane
  Flow flow = Flow::fit;                             ///< step from the mean plane onto the surface
  Diffusion diffusion = Diffusion::none;             ///< weight of samples off the surface
  std::optional<double> diffusion_threshold = {};    ///< λ of `diffusion` times the width, > 0; default 1
  std::optional<int> tau = {};                       ///< exponent of the M-like weights, 1..3; default 2
  bool separate_sheets = true;                       ///< ignore samples that face the opposite way of those nearby
  std::optional<double> error = {};  ///< accepted distance of samples from the local shape of their cell (length)
  std::optional<int> depth = {};     ///< deepest level of the octree, 2..14
  bool smooth = false;               ///< fit no edges and corners
  /// Options of surfaces that a program adds, keyed by their name in schema().
  std::map<std::string, OptionValue, std::less<>> own = {};

  static const OptionSchema& schema();  ///< one row a field, and one for each entry of `own`
  /// Throws ArgumentError naming the field: for values out of range, and for options that the method does not use.
  void validate() const;
};

/// Curvature measures for colour maps.
enum class CurvatureQuantity {
  mean,      ///< (k1 + k2) / 2 (1 / length)
  gaussian,  ///< k1 k2 (1 / length²)
  k1,        ///< larger principal curvature (1 / length)
  k2         ///< smaller principal curvature (1 / length)
};

/// √((k1² + k2²)/2) (1 / length): amount of curvature (Koenderink & van Doorn 1992).
SANSMESH_API float curvedness(const PrincipalCurvatures& c);

/// Scale-free shape of the surface, in [−1, 1]: −1 cup, −½ rut, 0 saddle, ½ ridge, 1 cap (same source, convex is
/// positive); 0 on a plane.
SANSMESH_API float shape_index(const PrincipalCurvatures& c);

/// Estimation of curvatures from neighbouring samples.
struct SANSMESH_API CurvatureOptions {
  /// Weights of the directional curvatures of neighbours at distance r.
  enum class Weights {
    m_like,    ///< r^(2 tau) exp(−r²/h²): low weight for near samples, whose directional curvatures are unreliable
    gaussian,  ///< exp(−r²/h²), for comparison
    uniform    ///< equal weights (huang2001), for comparison
  };
  Weights weights = Weights::m_like;  ///< weights of the neighbours
  int tau = 2;                        ///< exponent of the M-like weights, 1..4
  /// h above (length, > 0): neighbours are the samples within 1.6 h. Default: the distance of the farthest of
  /// `neighbours` / 1.6, which follows the density.
  std::optional<double> bandwidth = {};
  /// Samples in a neighbourhood, 8..2000; default: from the noise and the spacing. Not used with `bandwidth`.
  std::optional<int> neighbours = {};
  /// Let the fitted surface pass at a distance from the point, which may be noisy.
  bool offset = true;
  /// Let the fit tilt the normal.
  bool refit_normal = true;
  /// Standard deviation of the samples off the surface (length). Default: estimated.
  std::optional<double> noise = {};

  static const OptionSchema& schema();  ///< one row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Names of CurvatureQuantity, in the order of the enumerators.
inline constexpr std::string_view kCurvatureWords[] = {"mean", "gaussian", "k1", "k2"};

/// Name of a quantity: "mean", "gaussian", …
SANSMESH_API const char* quantity_word(CurvatureQuantity quantity);

/// Whether a word is the name of a CurvatureQuantity.
SANSMESH_API bool is_curvature(std::string_view word);

/// CurvatureQuantity of a name. Throws ArgumentError for an unknown name.
SANSMESH_API CurvatureQuantity curvature_quantity(std::string_view word);

/// Consolidation by a locally optimal projection (docs/methods/consolidation.md). Needs neither normals nor a surface.
struct SANSMESH_API LopOptions {
  /// Number of points of the result, at least 1. Default: half the number of samples. With more points than samples the
  /// result is on the surface, but no more even than random samples.
  std::optional<std::size_t> points = {};
  /// Radius h of the neighbourhoods (length, > 0); the weights are exp(−16 r²/h²) within it. Default: from the spacings
  /// of the samples and of the result, and from the noise.
  std::optional<double> radius = {};
  /// Repulsion between the points, in [0, 0.5): the larger, the more even the result.
  double repulsion = 0.45;
  /// Number of steps, 1..1000; fewer when the points come to rest.
  int iterations = 25;
  /// Compensate for the density of the cloud, for an even result from uneven samples (huang2009).
  bool weighted = true;
  /// Estimate normals of the result from the new points; their signs are those of the nearest samples. No effect
  /// without normals in the cloud.
  bool normals = true;
  /// Seed of the random choice of starting samples: the same seed gives the same points.
  std::uint64_t seed = 1;

  /// Excludes the number of points, the normals and the seed.
  static const OptionSchema& schema();  ///< one row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Options of projecting points onto a surface.
struct SANSMESH_API ProjectToSurface {
  int most_steps = 10;      ///< largest number of steps, 1..1000
  double tolerance = 1e-3;  ///< a step shorter than this share of the samples' spacing is the last, 1e-6..1

  static const OptionSchema& schema();  ///< one row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Result of projecting points onto a surface. Lengths in the unit of the input.
struct SANSMESH_API SurfaceProjection {
  std::size_t projected = 0;  ///< points now on the surface
  std::size_t left_out = 0;   ///< points outside the domain of definition, or too far from it
  double mean_move = 0;       ///< distance, mean
  double rms_move = 0;        ///< distance, root mean square
  double largest_move = 0;    ///< distance, largest

  static const ReportSchema& schema();  ///< one row a figure
};

/// Report on a meshless surface.
struct SANSMESH_API SurfaceReport {
  std::string method;             ///< name of the method
  double spacing = 0, noise = 0;  ///< spacing and noise of the samples (length, unit of the input)
  double smoothing = 0;           ///< median width over the local spacing; 0 where the method has no weights
  int order = 0, iterations = 0;  ///< amls only
  std::size_t samples = 0;        ///< number of samples

  static const ReportSchema& schema();  ///< one row a figure
};

/// Spacing and noise of the samples and width of the weights, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceReport& report);

}  // namespace sansmesh::inline v1
