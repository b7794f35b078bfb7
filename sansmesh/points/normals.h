// Unoriented normals from neighbouring samples.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/cloud_options.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

class KdTree;

/// Neighbours that keep the error of the normals from the noise near a few degrees: more where the noise is large
/// against the spacing.
int choose_neighbours(double spacing, double noise);

/// Replaces points.normals by unit normals of arbitrary sign (zero where all neighbours coincide or the position is not
/// finite). `orient_normals` gives them their sign. Throws ArgumentError for bad options.
void estimate_normals(PointSet& points, const NormalOptions& options, Progress& progress);

/// The same with a tree of the positions at hand.
void estimate_normals(PointSet& points, const KdTree& tree, const NormalOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
