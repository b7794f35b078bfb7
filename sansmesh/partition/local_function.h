// Local approximation of the partition of unity: a bivariate polynomial height over a local plane.
#pragma once

#include <array>
#include <cstdint>

#include "sansmesh/fit_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Number of bivariate monomials up to degree d: (d+1)(d+2)/2.
constexpr std::array<int, kMaxDegree + 1> kBasisSize{1, 3, 6, 10, 15};

/// f(x) = scale · (w − g(u, v)), where (u, v, w) = frame · (x − center) / scale and g has the coefficients below in the
/// order 1 | u v | u² uv v² | u³ u²v uv² v³ | u⁴ … v⁴. Its support is the ball of `radius` around `center` (tejada2008,
/// 4.4). Without a frame (xi = eta = nu = 0) it is the constant −scale · coefficient[0]. The layout is that of function
/// files.
struct LocalFunction {
  Vec3f center;
  float radius = 0;
  Vec3f xi, eta, nu;  ///< orthonormal; nu points outward
  float scale = 1;
  std::array<float, 15> coefficient{};
  std::int32_t degree = 0;
  /// Creases (ohtake2003): index + 1 of the next function of the same support, combined with this one by max (convex)
  /// or min (concave); 0 = none.
  std::int32_t next = 0;
  std::uint32_t convex = 1;

  bool is_constant() const { return nu == Vec3f{}; }
};

/// f(x) of one piece alone.
float local_value(const LocalFunction& f, const Vec3f& x);

/// ∇g at (u, v).
struct HeightGradient {
  float u, v;
};

HeightGradient height_gradient(const LocalFunction& f, float u, float v);

/// Proven bound of ‖∇f‖ in the ball of this radius around `center`: at least 1, about as large as the largest gradient
/// there; 0 for constants.
float local_slope(const LocalFunction& f, const Vec3f& center, float radius);

static_assert(sizeof(LocalFunction) == 128 && alignof(LocalFunction) == 4);

}  // namespace sansmesh::inline v1
