// What a mesh leaves out of a cloud and what it makes up, without a truth to compare with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Samples farther than this from a mesh have no surface there: two spacings, and four times the noise (lengths).
double lost_beyond(double spacing, double noise);

/// 1 for the samples farther than `beyond` (length) from the mesh, and for all if it has no triangles; 0 for such that
/// are not finite.
std::vector<std::uint8_t> far_samples(const TriangleMesh& mesh, const PointSet& samples, double beyond);

/// Samples without a surface: farther from the mesh than lost_beyond. Of a
/// large cloud every so manieth sample is asked, `most` of them at the utmost; such that are not finite are left out.
/// All of them are lost if the mesh has no triangles.
FarPlaces find_lost(const TriangleMesh& mesh, const PointSet& samples, double spacing, double noise,
                    std::size_t most = std::numeric_limits<std::size_t>::max());

/// Surface without samples: farther than four spacings (length) from every sample. Asked at `places` places that are
/// spread evenly over the area by a fixed rule, so the share is one of the area, and large triangles count by their
/// parts. None where the mesh has no area.
FarPlaces find_invented(const TriangleMesh& mesh, const PointSet& samples, double spacing, std::size_t places);

/// Both, with the spacing and noise that the samples have. `places` on the mesh, at least 1; every sample is asked.
/// Origins may differ. The same for any number of threads. Throws DataError if no sample is finite, ArgumentError
/// naming `samples` for no places.
MeshCoverage measure_coverage(const TriangleMesh& mesh, const PointSet& samples, std::size_t places,
                              Progress& progress);

}  // namespace sansmesh::inline v1
