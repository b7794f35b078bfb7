// Surfaces of particles under construction.
#pragma once

#include <vector>

#include "sansmesh/flow/trace.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// Points and triangles; may include points without triangles.
struct FlowSheet {
  std::vector<FlowPoint> points;  ///< without normals where these are unknown
  std::vector<Triangle> triangles;
  FlowSurfaceReport report;
};

/// Time in which a particle of median speed moves by Δ₀ = `spacing`. Throws DataError if the flow is at rest.
double front_time(std::vector<double> speeds, double spacing);

/// Smallest distance of starting points (length) between which a particle is inserted. Below it, the integration error
/// decides the paths of separating particles. A fifth of the integrator's tolerance, or of its default.
double least_seed_distance(const VectorField& field, const TraceOptions& options);

}  // namespace sansmesh::inline v1
