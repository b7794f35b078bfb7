// Points on a meshless surface: others moved onto it, or new ones spread over it.
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

/// The surface that suits samples which are to be moved onto their own (docs/methods/projections.md has the table):
/// `partition`, unless it moves them by more than their noise explains and `curvature`, whose fits are smaller, by
/// less.
SurfaceModel make_suited_surface(PreparedCloud cloud, Progress& progress);

/// The points on the surface (by the projection, or down the gradient of an implicit one), with its normals; colours
/// and other attributes stay. Points are left out, and counted, outside of the domain of definition, and where the
/// surface or the samples are farther than 3 spacings (of samples around the place there, at most twice the median) and
/// 5 deviations of the noise. Positions of points and model are world coordinates.
PointSet project_points(const PointSet& points, const SurfaceModel& model, const ProjectToSurface& options,
                        Progress& progress, SurfaceProjection* report = nullptr);

/// About `count` points spread evenly over the surface (Poisson discs), with normals and the samples' colours. More
/// than there are samples: upsampling. Throws ArgumentError for count = 0.
PointSet resample_surface(const SurfaceModel& model, std::size_t count, const ProjectToSurface& options,
                          Progress& progress, SurfaceProjection* report = nullptr);

}  // namespace sansmesh::inline v1
