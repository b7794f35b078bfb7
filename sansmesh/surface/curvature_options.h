// Principal curvatures as they are returned, and the options of their estimation.
#pragma once

#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

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
  std::optional<double> bandwidth = {};
  /// Samples in a neighbourhood, 8..2000; default: `choose_curvature_neighbours`. Not used with `bandwidth`.
  std::optional<int> neighbours = {};
  /// Let the fitted surface pass at a distance from the place, which may itself be noisy.
  bool offset = true;
  /// Let the fit tilt the normal.
  bool refit_normal = true;
  /// Standard deviation of the samples off the surface (length), to save its estimation.
  std::optional<double> noise = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
