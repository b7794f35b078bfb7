// Estimates unoriented normals from neighbouring samples.
#pragma once

#include "sansmesh/cloud_options.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

class KdTree;

/// Number of neighbours that keeps the error of normals due to noise near a few degrees: it grows with the ratio of
/// noise to spacing.
int choose_neighbours(double spacing, double noise);

/// Replaces points.normals by unit normals of arbitrary sign (zero if all neighbours coincide or the position is not
/// finite). `orient_normals` determines the signs. Throws ArgumentError for invalid options.
void estimate_normals(PointSet& points, const NormalOptions& options, Progress& progress);

/// Same, with an existing tree of the positions.
void estimate_normals(PointSet& points, const KdTree& tree, const NormalOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
