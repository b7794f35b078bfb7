// Options of surfaces of samples that are never meshed, of curvatures, and of points that are moved onto a surface.
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
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// How samples are weighted by their distance d from a point.
enum class SurfaceWeights {
  compact,  ///< a_i (1 − d²/(2h_i)²)⁴: widths that follow the local spacing, and the area a_i that each sample stands
            ///< for
  gaussian  ///< exp(−d²/h²), cut off at √12 h: one h for the whole cloud, and all samples alike (the sources')
};

/// Normals of mean planes, or beside the gradient.
enum class SurfaceNormal {
  standard,    ///< the method's own
  covariance,  ///< adamson: the direction of least weighted covariance about x, not the mean normal (the source's)
  iterated     ///< amls: N(x) = Σ n_i φ_i(x), iterated as the values are, beside the gradient
};

/// curvature: what to do about samples whose directional curvature κ exceeds λ.
enum class SurfaceDiffusion {
  none,  ///< they count like all others
  soft,  ///< they count less (Lange & Polthier 2005, g = λ²/(λ² + 10(|κ| − λ)²))
  hard   ///< they do not count
};

/// curvature: how a foot on the mean plane gets onto the surface. The source's steps are x ← x + Δt (1/Ω) Σ ω_i g_i
/// (x_i − x), with g_i of SurfaceDiffusion, to the fixed point; the fit that follows has no offset.
enum class SurfaceFlow {
  fit,     ///< by the offset of the fit
  normal,  ///< by the source's steps, along the normal alone
  free     ///< by the source's steps, in any direction
};

/// levin: how the plane under the polynomial is found.
enum class SurfacePlane {
  iterated,  ///< weighted planes about the foot of the last one, six times
  nonlinear  ///< the least of Σ ⟨n, x_i − r − t n⟩² w(‖x_i − r − t n‖) over n and t, to convergence
};

/// levin, alexa: the polynomial over the plane; of lower degree where the samples do not determine it.
enum class SurfacePolynomial {
  linear = 1,  ///< degree 1
  quadratic,   ///< degree 2
  cubic,       ///< degree 3
  quartic,     ///< degree 4
  incomplete   ///< x², y², xy and 1
};

/// Weights of normals that turn sharply at edges and corners (docs/methods/sharp-features.md).
enum class SharpFormula {
  bilateral,  ///< by distance and by how normals differ
  /// The source's: Laguerre's polynomial of the combined argument s_i = ε ‖x − x_i‖²/h² + ⟨n, x_i − x⟩²/(2σ²),
  /// (35/8 − 7/2 s + ½ s²) e^{−s}, with one h for the cloud and nothing else. For evenly spread samples: its negative
  /// values make much of what chance leaves out.
  laguerre
};

/// The surface that most begin with, and that function files keep: "partition".
inline constexpr std::string_view kPartitionSurface = "partition";

/// Which surface of samples, and its options. All optional values follow from the data where absent. Lengths are in the
/// unit of the input. A method uses some of them only; validate() says which.
struct SANSMESH_API SurfaceOptions {
  using Normal = SurfaceNormal;          ///< short for it
  using Plane = SurfacePlane;            ///< short for it
  using Polynomial = SurfacePolynomial;  ///< short for it
  using Flow = SurfaceFlow;              ///< short for it
  using Diffusion = SurfaceDiffusion;    ///< short for it

  std::string method = "apss";                       ///< name of the method; ArgumentError lists them all for others
  std::optional<SharpFormula> sharp = {};            ///< normals turn sharply at edges and corners, by these weights
  std::optional<double> smoothing = {};              ///< width of the weights over the local spacing, 0.5..20
  std::optional<double> bandwidth = {};              ///< the same as one length for the whole cloud
  SurfaceWeights weights = SurfaceWeights::compact;  ///< of samples by their distance
  std::optional<int> order = {};                     ///< of the approximation: 2, 4 or 6
  std::optional<int> iterations = {};                ///< of the approximation, 0..100: 0 smooths most
  std::optional<double> epsilon = {};                ///< shape parameter of the approximation, 0.05..20
  Normal normal = Normal::standard;                  ///< of mean planes, or beside the gradient
  Plane reference_plane = Plane::iterated;           ///< under the polynomials
  Polynomial polynomial = Polynomial::quadratic;     ///< over the plane
  Flow flow = Flow::fit;                             ///< how points get onto the surface
  Diffusion diffusion = Diffusion::none;             ///< whether samples off the surface count less
  std::optional<double> diffusion_threshold = {};    ///< of diffusion: λ over the inverse of the width, > 0; default 1
  std::optional<int> tau = {};                       ///< exponent of the M-like weights, 1..3; default 2
  bool separate_sheets = true;                       ///< samples that look the other way than those nearby do not count
  std::optional<double> error = {};  ///< accepted distance of samples from the shape of their cell (length)
  std::optional<int> depth = {};     ///< deepest level of the octree, 2..14
  bool smooth = false;               ///< no edges and corners
  /// Options that a surface has for itself, by name, as rows of schema(): of those that programs add.
  std::map<std::string, OptionValue, std::less<>> own = {};

  static const OptionSchema& schema();  ///< a row a field, and one for each of `own`
  /// Throws ArgumentError naming the field: for values out of range, and for those that mean nothing to the method.
  void validate() const;
};

/// Measures of curvature that colours show.
enum class CurvatureQuantity {
  mean,      ///< (k1 + k2) / 2 (1 / length)
  gaussian,  ///< k1 k2 (1 / length²)
  k1,        ///< larger principal curvature (1 / length)
  k2         ///< smaller principal curvature (1 / length)
};

/// The surface around one place. Curvatures in 1 / length, *positive where the surface is convex* (bends away from the
/// outward normal): +1/r on a sphere of radius r.
struct PrincipalCurvatures {
  float k1 = 0;          ///< the larger one
  float k2 = 0;          ///< the smaller one
  Vec3f direction1;      ///< of k1: unit, tangential, up to its sign
  Vec3f direction2;      ///< of k2: unit, tangential, orthogonal to direction1, up to its sign
  Vec3f normal;          ///< unit, that of the fitted surface: as given unless `refit_normal`
  float offset = 0;      ///< how far along the given normal the fitted surface is; 0 unless `offset`
  bool defined = false;  ///< false: too few or degenerate neighbours, or no normal; then all is zero
};

/// (k1 + k2) / 2 (1 / length).
inline float mean_curvature(const PrincipalCurvatures& c) { return 0.5f * (c.k1 + c.k2); }

/// k1 k2 (1 / length²).
inline float gaussian_curvature(const PrincipalCurvatures& c) { return c.k1 * c.k2; }

/// √((k1² + k2²)/2) (1 / length): how much the surface is curved at all (Koenderink & van Doorn 1992).
SANSMESH_API float curvedness(const PrincipalCurvatures& c);

/// Shape of the surface whatever its size, in [−1, 1]: −1 a cup, −½ a rut, 0 a saddle, ½ a ridge, 1 a cap (same source,
/// with convex as positive); 0 where flat.
SANSMESH_API float shape_index(const PrincipalCurvatures& c);

/// How curvatures are estimated from neighbours.
struct SANSMESH_API CurvatureOptions {
  /// Weights of the directional curvatures of neighbours at distance r.
  enum class Weights {
    m_like,  ///< r^(2 tau) exp(−r²/h²): little weight for near samples, whose directional curvatures are unreliable
    gaussian,  ///< exp(−r²/h²), to compare with
    uniform    ///< all alike (Huang & Menq 2001), to compare with
  };
  Weights weights = Weights::m_like;  ///< of the neighbours
  int tau = 2;                        ///< exponent of the M-like weights, 1..4
  /// h above (length, > 0): neighbours are the samples within 1.6 h. Default: the distance of the farthest of
  /// `neighbours` / 1.6, so that neighbourhoods follow the density.
  std::optional<double> bandwidth = {};
  /// Samples in a neighbourhood, 8..2000; default: from the noise and the spacing. Not used with `bandwidth`.
  std::optional<int> neighbours = {};
  /// Let the fitted surface pass at a distance from the place, which may itself be noisy.
  bool offset = true;
  /// Let the fit tilt the normal.
  bool refit_normal = true;
  /// Standard deviation of the samples off the surface (length), to save its estimation.
  std::optional<double> noise = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Words for CurvatureQuantity, in the order of the enumerators.
inline constexpr std::string_view kCurvatureWords[] = {"mean", "gaussian", "k1", "k2"};

/// The word for a quantity: "mean", "gaussian", …
SANSMESH_API const char* quantity_word(CurvatureQuantity quantity);

/// Whether a word names a CurvatureQuantity.
SANSMESH_API bool is_curvature(std::string_view word);

/// The CurvatureQuantity that a word names. Throws ArgumentError for a word that is none of them.
SANSMESH_API CurvatureQuantity curvature_quantity(std::string_view word);

/// Consolidation by a locally optimal projection (docs/methods/consolidation.md): points without normals or a surface.
struct SANSMESH_API LopOptions {
  /// Points of the result, at least 1. Default: half as many as there are samples. With more than there are samples the
  /// result lies on the surface, but is no more even than random samples.
  std::optional<std::size_t> points = {};
  /// Radius h of the neighbourhoods (length, > 0); the weights are exp(−16 r²/h²) within it. Default: from the spacing,
  /// that of the result, and the noise.
  std::optional<double> radius = {};
  /// Repulsion between the points, in [0, 0.5): the larger, the more even the result.
  double repulsion = 0.45;
  /// Steps, 1..1000; fewer where the points come to rest.
  int iterations = 25;
  /// Take out the density of the cloud, so that the result is even where the samples are not (Huang et al. 2009).
  bool weighted = true;
  /// Give the result normals: estimated from the new points, with the signs of those of the nearest samples. Without
  /// normals in the cloud there are none.
  bool normals = true;
  /// Of the choice of samples at which the points start: the same seed gives the same points.
  std::uint64_t seed = 1;

  /// All but the number of points, the normals and the seed.
  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// How points move onto a surface.
struct SANSMESH_API ProjectToSurface {
  int most_steps = 10;      ///< at most, 1..1000
  double tolerance = 1e-3;  ///< a step shorter than this share of the samples' spacing is the last, 1e-6..1

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// How far points were moved onto a surface. Lengths in the unit of the input.
struct SANSMESH_API SurfaceProjection {
  std::size_t projected = 0;  ///< points on the surface now
  std::size_t left_out = 0;   ///< points outside of the domain of definition, or too far from it
  double mean_move = 0;       ///< distance, mean
  double rms_move = 0;        ///< distance, root mean square
  double largest_move = 0;    ///< distance, largest

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// A surface that was made of samples.
struct SANSMESH_API SurfaceReport {
  std::string method;             ///< by name
  double spacing = 0, noise = 0;  ///< of the samples (length, unit of the input)
  double smoothing = 0;           ///< median width over the local spacing; 0 where the method has no weights
  int order = 0, iterations = 0;  ///< amls
  std::size_t samples = 0;        ///< that it was made of

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What the samples are like, and how wide the weights are, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SurfaceReport& report);

}  // namespace sansmesh::inline v1
