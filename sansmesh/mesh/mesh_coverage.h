// Completeness and spurious parts of a mesh relative to a cloud, without a reference surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Distance beyond which a sample has no surface: two spacings, and four times the noise (lengths).
double lost_beyond(double spacing, double noise);

/// 1 for samples farther than `beyond` (length) from the mesh, and for all finite samples if it has no triangles;
/// otherwise 0.
std::vector<std::uint8_t> far_samples(const TriangleMesh& mesh, const PointSet& samples, double beyond);

/// Samples without a surface: farther from the mesh than lost_beyond. Tests at most `most` finite samples, at equal
/// steps. All are lost if the mesh has no triangles.
FarPoints find_lost(const TriangleMesh& mesh, const PointSet& samples, double spacing, double noise,
                    std::size_t most = std::numeric_limits<std::size_t>::max());

/// Surface without samples: farther than four spacings (length) from every sample. Tests `count` points, reproducibly
/// distributed over the area, so that the share is one of the area and large triangles count by their parts. Empty if
/// the mesh has no area.
FarPoints find_invented(const TriangleMesh& mesh, const PointSet& samples, double spacing, std::size_t count);

/// Both measures, with the estimated spacing and noise of the samples. Tests `count` (>= 1) points on the mesh and all
/// samples. Origins may differ. Independent of the number of threads. Throws DataError if no sample is finite,
/// ArgumentError that names `samples` for no points.
MeshCoverage measure_coverage(const TriangleMesh& mesh, const PointSet& samples, std::size_t count, Progress& progress);

}  // namespace sansmesh::inline v1
