// Polynomials about the samples of a lattice, axis by axis.
#pragma once

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// As fit_local_polynomials, for a lattice: `metrics` stay empty. Stencils are the (up to) five samples along each axis
/// around the sample, 125 in all, at the ends of axes the last five. Since these are products of axes and so are the
/// weights, the orthogonal polynomials are products of those in one variable, which are set up once for each coordinate
/// of an axis; a fit is three short passes over the stencil. Degrees, steps and trust are as for other grids, but that
/// h_ii is taken of equal steps, and that single outliers are not looked for. Along axes of fewer samples the powers
/// end below their number: with two layers polynomials are straight across, whatever their (total) degree.
LocalPolynomials fit_lattice_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                         const LocalPolynomialOptions& options, Progress& progress);

/// One or the other, as the volume has it.
inline LocalPolynomials fit_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                        const LocalPolynomialOptions& options, Progress& progress) {
  return volume.lattice ? fit_lattice_polynomials(volume, values, options, progress)
                        : fit_local_polynomials(volume, values, options, progress);
}

}  // namespace sansmesh::inline v1
