// The field of functions with ellipsoidal supports: Σ w_i p_i / Σ w_i.
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/samples/local_polynomials.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Radii of the supports of all samples, in the local metrics: every point of a cell that a sample is a corner of lies
/// within `reach` times the radius, or every corner of the cells that it stands for within 0.7 of it.
std::vector<float> support_radii(const SampledVolume& volume, const LocalPolynomials& polynomials, double reach);

/// F(x) = Σ_i w_i(x) p_i(x) / Σ_i w_i(x) over the samples whose ellipsoids hold x, r = ‖M_i (x − x_i)‖ / radius_i < 1,
/// w = (1 − r²)⁴. Continuous wherever the mesh is connected, over borders of blocks and levels, too. A support does not
/// reach across gaps: in a cell only those count whose sample is at most kRings edges of the mesh away from the cell's
/// own. Outside of the volume: at its nearest place.
///
/// trust of the polynomials: their terms of degree 2 and more count by that factor.
///
/// Of samples in cells linear interpolation L takes over where they are not trusted: F = (1 − s) Σ w p / Σ w + s L, s =
/// (1 − trust)² at the samples, the mean of those around at corners of cells, between these as L is. At corners on the
/// surface of the volume, beyond the samples, s is at least Σ 5/2 (a − b)² / Σ (a² + 5/2 (a − b)²), a the correction of
/// L that the polynomials of the cells there are, b that of the samples next to them. s is 0 where it would be below a
/// hundredth, and in cells that touch others but for whole faces (borders of levels and blocks), where L is not
/// continuous.
std::unique_ptr<VolumeField> make_support_blend(std::shared_ptr<const SampledVolume> volume,
                                                std::shared_ptr<const VolumeLocator> locator,
                                                LocalPolynomials polynomials, SharedArray<float> radii,
                                                const VolumeValues& values);

}  // namespace sansmesh::inline v1
