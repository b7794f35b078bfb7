// Consolidation: an even, denoised set of points from a cloud.
#pragma once

#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// Locally optimal projection (lipman2007; weighted as in huang2009). Points that start on samples spread evenly over
/// the area move to weighted *medians* of the samples around them, which are robust to outliers, and repel each other.
/// Needs neither normals nor a parameterisation. The result keeps the cloud's origin and has no colours or faces.
/// Points without a sample in reach do not move; none starts at an outlier. Difference from the sources: points repel
/// each other along the surface only. Samples that are not finite are ignored. The result does not depend on the number
/// of threads. Throws ArgumentError for invalid options, DataError for a cloud without finite samples.
PointSet consolidate(const PointSet& points, const LopOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
