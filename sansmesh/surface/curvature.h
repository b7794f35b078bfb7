// Principal curvatures and directions of a sampled surface, without a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/core/vec.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {

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
float curvedness(const PrincipalCurvatures& c);
/// In [−1, 1]: −1 a cup, −½ a rut, 0 a saddle, ½ a ridge, 1 a cap (same source, with convex as positive); 0 where flat.
float shape_index(const PrincipalCurvatures& c);

struct CurvatureOptions {
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
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Curvatures anywhere near a cloud (METHODS §2.2). Around x with normal n and tangent coordinates (u, v), each
/// neighbour d = x_i − x gives a directional curvature κ_i = −2⟨n, d⟩/‖d‖², and Euler's theorem makes χ₁ + χ₂ cos 2θ +
/// χ₃ sin 2θ ≈ κ_i a linear least-squares problem in three unknowns. Beyond the source: an offset and two slopes as
/// further unknowns, and the neighbourhood chosen from the data.
class CurvatureEstimator {
 public:
  /// Copies what it needs of the cloud. Throws ArgumentError for bad options, DataError for a cloud without normals.
  CurvatureEstimator(const PointSet& points, const CurvatureOptions& options);

  /// Curvatures at points on or next to the surface with unit outward normals there. Undefined where the nearest sample
  /// is farther away than half the neighbourhood's radius. Sizes must agree. Safe from several threads; runs in
  /// parallel itself.
  void evaluate(std::span<const Vec3> x, std::span<const Vec3> normals, std::span<PrincipalCurvatures> result) const;
  /// Curvatures at all samples, in the cloud's order.
  std::vector<PrincipalCurvatures> at_samples(Progress& progress) const;

  /// Samples in a neighbourhood; 0 where a radius was given.
  int neighbours() const { return neighbours_; }

 private:
  KdTree tree_;
  std::vector<Vec3f> positions_;  ///< in tree order, like the normals
  std::vector<Vec3f> normals_;
  std::vector<std::uint32_t> slot_of_;
  CurvatureOptions options_;
  int neighbours_ = 0;
  std::size_t cloud_size_ = 0;
};

/// Neighbours that make the expected error of the curvatures least: a few hundred places are fitted with
/// neighbourhoods of 20 to 640 samples. What the noise does to a fit follows from the fit's weights; what the shape
/// does is seen in how the curvatures change from one size to the next.
int choose_curvature_neighbours(const PointSet& points, double noise);

/// Curvatures at all samples; not defined where positions are not finite or normals zero. Throws ArgumentError for bad
/// options, DataError for a cloud without normals.
std::vector<PrincipalCurvatures> estimate_curvatures(const PointSet& points, const CurvatureOptions& options,
                                                     Progress& progress);

}  // namespace sansmesh
