// Curvature of drawn surfaces, for lines and accessibility.
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

/// Fewest samples that define curvature.
inline constexpr std::size_t kFewestSamples = 9;

/// Whether the picture needs curvatures of its surface.
bool wants_curvature(const RenderOptions& options);

/// Curvature of a surface without a mesh, in its coordinates, from differences of its gradients over one sample spacing
/// to each side (LevelSetCurvature).
std::unique_ptr<CurvatureField> curvature_of_surface(const SurfaceModel& model, Progress& progress);

/// Curvature estimated at the samples, with a larger support than the surface's own weights, which smooths crests.
std::unique_ptr<CurvatureField> curvature_at_samples(const SurfaceModel& model, Progress& progress);

/// A mesh in a local frame, with curvatures at its vertices.
struct CurvedVertices {
  PointSet points;
  LocalFrame frame;
  std::vector<FittedCurvatures> curvatures;
};

/// For a mesh whose faces `use` samples: the samples are on flat triangles, so curvatures are estimated at the
/// vertices. Empty for other input. Throws DataError if the vertices form no surface.
std::optional<CurvedVertices> curved_vertices(const PointSet& mesh, const CloudPreparation& use, Progress& progress);

/// Curvature of a mesh or cloud in the coordinates of the input, estimated at its vertices. Null if they form no
/// surface.
std::unique_ptr<CurvatureField> curvature_of_samples(const PointSet& points, const CloudPreparation& use,
                                                     Progress& progress);

}  // namespace sansmesh::inline v1
