// Projection of points onto a meshless surface, and resampling of the surface.
#pragma once

#include <cstddef>

#include "sansmesh/error.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// The surface recommended for projecting samples onto their own surface (table in docs/methods/projections.md):
/// `partition`, unless it moves them by more than their noise explains and `curvature`, whose fits are smaller, moves
/// them less.
SurfaceModel make_suited_surface(PreparedCloud cloud, Progress& progress);

/// Projects points onto the surface (by its projection, or along the gradient of an implicit one) and sets their
/// normals; colours and other attributes stay. Drops and counts points outside the domain of definition, and points
/// whose distance to the surface or the samples exceeds 3 spacings (local, at most twice the median) and 5 standard
/// deviations of the noise. Positions of points and model are world coordinates.
PointSet project_points(const PointSet& points, const SurfaceModel& model, const ProjectToSurface& options,
                        Progress& progress, SurfaceProjection* report = nullptr);

/// About `count` points spread evenly over the surface (Poisson discs), with normals and the samples' colours. A count
/// above the number of samples upsamples. Throws ArgumentError for count = 0.
PointSet resample_surface(const SurfaceModel& model, std::size_t count, const ProjectToSurface& options,
                          Progress& progress, SurfaceProjection* report = nullptr);

}  // namespace sansmesh::inline v1
