// Stream and path surfaces by advancing fronts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/flow/trace.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// Points and triangles; may include points without triangles.
struct FlowSheet {
  std::vector<FlowPoint> points;  ///< without normals where these are unknown
  std::vector<Triangle> triangles;
  FlowSurfaceReport report;
};

/// The front at the seeds and all fronts forward, backward or both, to their ends. `field` is steady for stream
/// surfaces; the options are valid and have a `start`.
FlowSheet advance_fronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

/// Time in which a particle of median speed moves by Δ₀ = `spacing`. Throws DataError if the flow is at rest.
double front_time(std::vector<double> speeds, double spacing);

/// Smallest distance of starting points (length) between which a particle is inserted. Below it, the integration error
/// decides the paths of separating particles. A fifth of the integrator's tolerance, or of its default.
double least_seed_distance(const VectorField& field, const TraceOptions& options);

}  // namespace sansmesh::inline v1
