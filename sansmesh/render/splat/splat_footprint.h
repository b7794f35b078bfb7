// Projection of a Gaussian on a tangent plane: the footprint of elliptical weighted average splatting.
#pragma once

#include <optional>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// An ellipse in a picture with Gaussian weights. Pixel coordinates: x to the right, y down, integers at pixel corners.
struct SplatFootprint {
  float x = 0, y = 0;              ///< centre
  float xx = 0, xy = 0, yy = 0;    ///< inverse of the covariance, 1 / pixels²
  float peak = 0;                  ///< weight at the centre, for 1 on the surface
  float reach_x = 0, reach_y = 0;  ///< half the size of the box of non-negligible weights, pixels

  /// Squared distance from the centre, in standard deviations.
  float square(float dx, float dy) const { return dx * (xx * dx + 2 * xy * dy) + dy * yy * dy; }
};

/// Radius of non-negligible weights, in standard deviations.
constexpr float kSplatCut = 3;

/// Projection of exp(−½(u² + v²)) at `center` + u·a + v·b: by the affine approximation of the camera's map at the
/// centre with derivative M = [∂/∂u ∂/∂v], convolved with a Gaussian of standard deviation `filter` pixels that avoids
/// aliasing (Zwicker, Pfister, van Baar & Gross 2001, section 4). Covariance V = M Mᵀ + filter² I, peak |det M| / √det
/// V, which preserves the sum over all pixels. Empty behind the camera, and if the distance of the centre is less than
/// the width of the splat.
std::optional<SplatFootprint> splat_footprint(const Camera& camera, int width, int height, const Vec3f& center,
                                              const Vec3f& a, const Vec3f& b, float filter);

}  // namespace sansmesh::inline v1
