// Field of functions with ellipsoidal supports: Σ w_i p_i / Σ w_i.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/methods/smooth_share.h"
#include "sansmesh/volume/samples/cell_fronts.h"
#include "sansmesh/volume/samples/local_polynomials.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Support radii of all samples in the local metrics: every point of a cell with the sample as a corner is within
/// `reach` times the radius; for cell data every corner of the sample's cell is within 0.7 of it.
std::vector<float> support_radii(const SampledVolume& volume, const LocalPolynomials& polynomials, double reach);

/// F(x) = Σ_i w_i(x) p_i(x) / Σ_i w_i(x) over the samples whose ellipsoids contain x, r = ‖M_i (x − x_i)‖ / radius_i <
/// 1, w = (1 − r²)⁴. For cell data, terms of degree 2 and more are multiplied by the polynomials' `trust`. Linear
/// interpolation replaces untrusted polynomials (LinearShare; docs/methods/volume-reconstruction.md). No polynomial
/// leaves the range of its star and of linear interpolation at the corners of its cell by more than a quarter of that
/// range, with full trust one and a half times it, or changes its sign if all samples have the same (but for
/// `logarithm`: values are logarithms). Near `fronts` these replace the blend (FrontShare). With `smooth` polynomials
/// count with their trust, and the smooth approximation with the rest, within the bounds of the polynomials that it
/// replaces; linear interpolation then only extrapolates.
///
/// Continuous wherever the mesh is connected, also across block borders and levels. A support does not cross gaps: in a
/// cell only samples within kRings mesh edges of the cell's own samples count. Outside the volume: the value at its
/// nearest point.
std::unique_ptr<VolumeField> make_support_blend(std::shared_ptr<const SampledVolume> volume,
                                                std::shared_ptr<const VolumeLocator> locator,
                                                LocalPolynomials polynomials, SharedArray<float> radii,
                                                const VolumeValues& values, bool logarithm = false,
                                                CellFronts fronts = {}, std::optional<SmoothShare> smooth = {});

}  // namespace sansmesh::inline v1
