// Options of surfaces of samples that are never meshed, of curvatures, and of points that are moved onto a surface.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// The method's own; or, adamson: the direction of least weighted covariance about x in place of the mean normal
/// (the source's); amls: N(x) = Σ n_i φ_i(x), iterated as the values are, as a NormalField beside the gradient.
enum class SurfaceNormal { standard, covariance, iterated };

/// curvature: what to do about samples whose directional curvature exceeds λ: soft, they count less (Lange & Polthier
/// 2005, g = λ²/(λ² + 10(|κ| − λ)²)); hard, not at all; none.
enum class SurfaceDiffusion { none, soft, hard };

/// curvature: how a foot on the mean plane gets onto the surface: by the offset of the fit; or, as in the source, by
/// steps x ← x + Δt (1/Ω) Σ ω_i g_i (x_i − x) to the fixed point, along the normal alone or freely, and then the fit
/// without an offset. g_i are those of `diffusion`.
enum class SurfaceFlow { fit, normal, free };

/// levin: how the plane is found: weighted planes about the foot of the last one, six times; or the least of
/// Σ ⟨n, x_i − r − t n⟩² w(‖x_i − r − t n‖) over n and t, to convergence.
enum class SurfacePlane { iterated, nonlinear };

/// levin, alexa: the polynomial over the plane, of degree 1 to 4 or [x², y², xy, 1]; lower where the samples do not
/// determine it.
enum class SurfacePolynomial { linear = 1, quadratic, cubic, quartic, incomplete };

/// The bilateral weights below; or the source's: Laguerre's polynomial of the combined argument
/// s_i = ε ‖x − x_i‖²/h² + ⟨n, x_i − x⟩²/(2σ²), (35/8 − 7/2 s + ½ s²) e^{−s}, with one h for the cloud and nothing
/// else. For evenly spread samples: its negative values make much of what chance leaves out.
enum class SharpFormula { bilateral, laguerre };

/// The surface that most begin with, and that function files keep: "partition".
inline constexpr std::string_view kPartitionSurface = "partition";

/// All optional values follow from the data where absent. Lengths are in the unit of the input. A method uses some of
/// them only (SurfaceMethod::uses).
struct SANSMESH_API SurfaceOptions {
  using Normal = SurfaceNormal;
  using Plane = SurfacePlane;
  using Polynomial = SurfacePolynomial;
  using Flow = SurfaceFlow;
  using Diffusion = SurfaceDiffusion;

  std::string method = "apss";             ///< a name of SurfaceMethod::registry()
  std::optional<SharpFormula> sharp = {};  ///< normals turn sharply at edges and corners, by these weights
  std::optional<double> smoothing = {};    ///< width of the weights over the local spacing, 0.5..20
  std::optional<double> bandwidth = {};    ///< the same as one length for the whole cloud
  SurfaceWeights weights = SurfaceWeights::compact;
  std::optional<int> order = {};       ///< of the approximation: 2, 4 or 6
  std::optional<int> iterations = {};  ///< of the approximation, 0..100: 0 smooths most
  std::optional<double> epsilon = {};  ///< shape parameter of the approximation, 0.05..20
  Normal normal = Normal::standard;    ///< of mean planes, or beside the gradient
  Plane plane = Plane::iterated;       ///< under the polynomials
  Polynomial polynomial = Polynomial::quadratic;
  Flow flow = Flow::fit;                           ///< how points get onto the surface
  Diffusion diffusion = Diffusion::none;           ///< whether samples off the surface count less
  std::optional<double> diffusion_threshold = {};  ///< of diffusion: λ over the inverse of the width, > 0; default 1
  std::optional<int> tau = {};                     ///< exponent of the M-like weights, 1..3; default 2
  bool separate_sheets = true;                     ///< samples that look the other way than those nearby do not count
  std::optional<double> error = {};  ///< accepted distance of samples from the shape of their cell (length)
  std::optional<int> depth = {};     ///< deepest level of the octree, 2..14
  bool smooth = false;               ///< no edges and corners

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field: for values out of range, and for those that mean nothing to the method.
  void validate() const;
};

/// Measures of curvature that colours show.
enum class CurvatureQuantity { mean, gaussian, k1, k2 };

/// The surface around one place. Curvatures in 1 / length, *positive where the surface is convex* (bends away from the
/// outward normal): +1/r on a sphere of radius r. (The quadratic form of a FootPoint has the opposite sign.)
struct PrincipalCurvatures {
  float k1 = 0, k2 = 0;          ///< k1 >= k2
  Vec3f direction1, direction2;  ///< unit, tangential, orthogonal, each up to its sign; to k1 and k2
  Vec3f normal;                  ///< unit, that of the fitted surface: as given unless `refit_normal`
  float offset = 0;              ///< how far along the given normal the fitted surface is; 0 unless `offset`
  bool defined = false;          ///< false: too few or degenerate neighbours, or no normal; then all is zero
};

inline float mean_curvature(const PrincipalCurvatures& c) { return 0.5f * (c.k1 + c.k2); }

inline float gaussian_curvature(const PrincipalCurvatures& c) { return c.k1 * c.k2; }

/// √((k1² + k2²)/2): how much the surface is curved at all (Koenderink & van Doorn 1992).
SANSMESH_API float curvedness(const PrincipalCurvatures& c);

/// In [−1, 1]: −1 a cup, −½ a rut, 0 a saddle, ½ a ridge, 1 a cap (same source, with convex as positive); 0 where flat.
SANSMESH_API float shape_index(const PrincipalCurvatures& c);

struct SANSMESH_API CurvatureOptions {
  /// Weights of the directional curvatures of neighbours at distance r.
  enum class Weights {
    m_like,  ///< r^(2 tau) exp(−r²/h²): little weight for near samples, whose directional curvatures are unreliable
    gaussian,  ///< exp(−r²/h²), to compare with
    uniform    ///< all alike (Huang & Menq 2001), to compare with
  };
  Weights weights = Weights::m_like;
  int tau = 2;  ///< 1..4
  /// h above (length, > 0): neighbours are the samples within 1.6 h. Default: the distance of the farthest of
  /// `neighbours` / 1.6, so that neighbourhoods follow the density.
  std::optional<double> radius = {};
  /// Samples in a neighbourhood, 8..2000; default: `choose_curvature_neighbours`. Not used with `radius`.
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

/// In the order of the enumerators.
inline constexpr std::string_view kCurvatureWords[] = {"mean", "gaussian", "k1", "k2"};

/// "mean", "gaussian", …
SANSMESH_API const char* quantity_word(CurvatureQuantity quantity);

/// Tells whether a word names one of them.
SANSMESH_API bool is_curvature(std::string_view word);

/// Throws ArgumentError for a word that is none of them.
SANSMESH_API CurvatureQuantity curvature_quantity(std::string_view word);

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
  /// Where the points start.
  std::uint64_t seed = 1;

  /// Radius and repulsion.
  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SANSMESH_API ProjectToSurface {
  int steps = 10;           ///< at most, 1..1000
  double tolerance = 1e-3;  ///< a step shorter than this share of the samples' spacing is the last, 1e-6..1

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SANSMESH_API SurfaceProjection {
  std::size_t projected = 0;
  std::size_t left_out = 0;                              ///< outside of the domain of definition, or too far from it
  double mean_move = 0, rms_move = 0, largest_move = 0;  ///< distances (length, unit of the input)

  static const ReportSchema& schema();
};

}  // namespace sansmesh::inline v1
