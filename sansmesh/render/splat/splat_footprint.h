// What a camera sees of a Gaussian on a tangent plane: the footprint of elliptical weighted average splatting.
#pragma once

#include <optional>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// An ellipse of a picture with Gaussian weights. Pixels: x to the right, y down, whole numbers at pixels' corners.
struct SplatFootprint {
  float x = 0, y = 0;              ///< middle
  float xx = 0, xy = 0, yy = 0;    ///< inverse of the covariance, 1 / pixels²
  float peak = 0;                  ///< weight in the middle, for 1 on the surface
  float reach_x = 0, reach_y = 0;  ///< half the box that holds what counts, pixels

  /// Squared distance of a place from the middle, in standard deviations.
  float square(float dx, float dy) const { return dx * (xx * dx + 2 * xy * dy) + dy * yy * dy; }
};

/// What lies farther out than so many standard deviations does not count.
constexpr float kSplatCut = 3;

/// Of exp(−½(u² + v²)) at `center` + u·a + v·b, where the camera sees that: by the affine map that its projection is
/// near the centre, with derivative M = [∂/∂u ∂/∂v], and then through a Gaussian of standard deviation `filter` pixels,
/// that covers no less than pixels can show (Zwicker, Pfister, van Baar & Gross 2001, section 4): covariance V = M Mᵀ +
/// filter² I, peak |det M| / √det V, which keeps the sum over all pixels. Nothing behind the camera, and where
/// the centre is nearer to it than the splat is wide.
std::optional<SplatFootprint> splat_footprint(const Camera& camera, int width, int height, const Vec3f& center,
                                              const Vec3f& a, const Vec3f& b, float filter);

}  // namespace sansmesh::inline v1
