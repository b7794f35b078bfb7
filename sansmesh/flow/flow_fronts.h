// Stream and path surfaces by fronts that advance.
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

/// Points and triangles; points that no triangle has are left in.
struct FlowSheet {
  std::vector<FlowPoint> points;  ///< without normals where they are not known
  std::vector<Triangle> triangles;
  FlowSurfaceReport report;
};

/// The seeds' front, and those forward, backward or both from it to their ends. `field` is steady for stream surfaces;
/// the options have been checked and have a `start`.
FlowSheet advance_fronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

/// Time in which a particle of median speed goes as far as Δ₀ = `spacing`. Throws DataError where the flow stands
/// still.
double front_time(std::vector<double> speeds, double spacing);

/// Particles that begin nearer to each other (length) have nothing between them: where they part it is the error of the
/// integration that tells which goes where. A fifth of its tolerance, or of what that would be.
double least_seed_distance(const VectorField& field, const TraceOptions& options);

}  // namespace sansmesh::inline v1
