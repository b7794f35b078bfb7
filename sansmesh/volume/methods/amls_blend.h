// The field of amls: Σ φ_i p_i / D over ellipsoidal supports, with precomputed coefficients.
#pragma once

#include <memory>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/methods/amls_system.h"
#include "sansmesh/volume/methods/grouped_field.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// Whether the field falls back on linear interpolation in the grid by `trust`: requires conforming cells with samples
/// as corners.
bool has_linear_share(const SampledVolume& volume);

/// F = T A + (1 − T) L. A = Σ_i φ_i(x) p_i(x) / D(x) over the samples whose ellipsoids contain x, ‖M_i (x − x_i)‖ <
/// radius_i; a support does not cross gaps (SupportIndex). L is the linear interpolation of `values`, T that of the
/// polynomials' `trust` if has_linear_share(), else T = 1. A is continuous wherever the mesh is connected. Outside the
/// volume: continued from its nearest point. polynomials: degree 2 at most, with their final coefficients.
///
/// The supports that reach a cell are computed on first use and cached, up to 64 MiB for all cells. In addition each
/// thread caches 2048 cells, 12 to 40 MB for one component.
std::unique_ptr<GroupedField> make_amls_blend(std::shared_ptr<const SampledVolume> volume,
                                              std::shared_ptr<const VolumeLocator> locator,
                                              LocalPolynomials polynomials, SharedArray<float> radii,
                                              VolumeValues values, const AmlsShape& shape);

}  // namespace sansmesh::inline v1
