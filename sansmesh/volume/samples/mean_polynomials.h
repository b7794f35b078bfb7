// Polynomials at the samples of cell means.
#pragma once

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// Polynomials whose mean over the cell of a sample is the value, also with their terms of degree 2 and more multiplied
/// by the trust (fit_local_polynomials). `volume` has values in cells and is no lattice. Where the values are
/// logarithms of means, the mean of the exponential of the polynomial is that of the value. Runs in parallel.
LocalPolynomials fit_mean_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                      const LocalPolynomialOptions& options, bool logarithm, Progress& progress);

}  // namespace sansmesh::inline v1
