// Consolidation: an even, denoised set of points in place of a cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// The locally optimal projection (METHODS §2.1: Lipman et al. 2007; weighted as by Huang et al. 2009). Points that
/// start on samples spread evenly over the area move to weighted *medians* of the samples around them, so that outliers
/// do not attract them, and away from each other. Needs neither normals nor a parameterisation. The origin is that of
/// the cloud; there are no colours or faces. Points without any sample in reach do not move; outliers start none.
/// Beyond the sources: points repel each other along the surface only. Not-finite samples are ignored. The same for any
/// number of threads. Throws ArgumentError for bad options, DataError for a cloud without finite samples.
PointSet consolidate(const PointSet& points, const LopOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
