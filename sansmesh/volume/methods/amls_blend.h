// The field of amls: Σ φ_i p_i / D over ellipsoidal supports, with precomputed coefficients.
#pragma once

#include <memory>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/methods/amls_system.h"
#include "sansmesh/volume/samples/local_polynomials.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Whether the field falls back on the grid's linear interpolation by `trust`: where cells have samples as corners and
/// fit together.
bool has_linear_share(const SampledVolume& volume);

/// F = T A + (1 − T) L. A = Σ_i φ_i(x) p_i(x) / D(x) over the samples whose ellipsoids hold x, ‖M_i (x − x_i)‖ <
/// radius_i; a support does not reach across gaps (SupportIndex). L is the linear interpolation of `values`, T that of
/// the polynomials' `trust`, if has_linear_share(); else T = 1. A is continuous wherever the mesh is connected.
/// Outside of the volume: from its nearest place on. polynomials: of degree 2 at most, coefficients as they count.
///
/// Which supports reach a cell is found when it is asked for first and kept, up to 64 MiB for all cells. Besides, each
/// thread that asks has the data of 2048 cells at hand, 12 to 40 MB for one component.
std::unique_ptr<VolumeField> make_amls_blend(std::shared_ptr<const SampledVolume> volume,
                                             std::shared_ptr<const VolumeLocator> locator, LocalPolynomials polynomials,
                                             SharedArray<float> radii, VolumeValues values, const AmlsShape& shape);

}  // namespace sansmesh::inline v1
