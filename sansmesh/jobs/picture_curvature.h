// Curvature of what is drawn, for lines and accessibility.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/field/curvature_field.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {

/// Fewer samples make no surface that could be bent.
inline constexpr std::size_t kFewestSamples = 9;

/// Whether the picture has to know how its surface is bent.
bool wants_curvature(const RenderOptions& options);

/// Of a surface without a mesh, in its coordinates: by differences of its gradients, a spacing of the samples to each
/// side (FieldCurvature).
std::unique_ptr<CurvatureField> curvature_of_surface(const SurfaceModel& model, Progress& progress);

/// The same, estimated at the samples: over more of them than the surface's own weights, so that crests are calmer.
std::unique_ptr<CurvatureField> curvature_at_samples(const SurfaceModel& model, Progress& progress);

/// A mesh with the curvatures at its vertices, in coordinates of its own.
struct CurvedVertices {
  PointSet points;
  LocalFrame frame;
  std::vector<PrincipalCurvatures> curvatures;
};

/// For a mesh of whose faces `use` makes samples: these lie on flat triangles, and the mesh is bent at its vertices.
/// Nothing for others. Throws DataError where they make no surface.
std::optional<CurvedVertices> curved_vertices(const PointSet& mesh, const CloudPreparation& use, Progress& progress);

/// Of a mesh or cloud, in the coordinates of the input: estimated at its vertices. Null where they make no surface.
std::unique_ptr<CurvatureField> curvature_of_samples(const PointSet& points, const CloudPreparation& use,
                                                     Progress& progress);

}  // namespace sansmesh::inline v1
