// Fits polynomials at the samples of a lattice, axis by axis.
#pragma once

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// fit_local_polynomials for a lattice: `metrics` stay empty. A stencil is the (up to) five samples along each axis
/// around the sample, 125 in all; at the ends of axes the last five. Stencils and weights are products over the axes,
/// so the orthogonal polynomials are products of univariate ones, computed once for each coordinate of an axis; a fit
/// is three short passes over the stencil. Degrees, steps and trust are as for other grids, except that h_ii assumes
/// equal steps and that single outliers are not detected. Along axes with fewer samples powers stay below the number of
/// samples: across two layers polynomials are linear for every (total) degree.
LocalPolynomials fit_lattice_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                         const LocalPolynomialOptions& options, Progress& progress);

/// Dispatches on the kind of volume.
inline LocalPolynomials fit_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                        const LocalPolynomialOptions& options, Progress& progress) {
  return volume.lattice ? fit_lattice_polynomials(volume, values, options, progress)
                        : fit_local_polynomials(volume, values, options, progress);
}

}  // namespace sansmesh::inline v1
