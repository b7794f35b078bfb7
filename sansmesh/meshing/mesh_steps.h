// Steps from a field to a finished mesh, shared by the meshing entry points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/meshing/narrow_handles.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1::detail {

/// A component is small if its samples (or, without samples, its area) are less than this fraction of the largest
/// component's.
constexpr double kSmallComponent = 0.015;

/// Polygonization options for a mean error of `mesh_error` (length of the field).
PolygonizeOptions meshing_options(const MeshOptions& options, double mesh_error, bool creases);

/// Whether cut_out skips simplification if it would gain little for a mesh of this many blocks.
bool may_skip_simplification(std::size_t blocks, const MeshOptions& options);

/// For each component the number of points nearest to it; at(i), i < n, is relative to the mesh's origin.
std::vector<std::size_t> count_nearest(const TriangleMesh& mesh, const MeshComponents& components, std::size_t n,
                                       const std::function<Vec3f(std::size_t)>& at);

/// Extracts the mesh and reports the number of blocks and, on request, the quality before enhancement.
TriangleMesh cut_out(const ScalarField& field, const BlockTree& blocks, const MeshOptions& options,
                     PolygonizeOptions meshing, Progress& progress, MeshReport& r);

/// 1 for the components that choose_components keeps. `open`: part of the surface ends where its samples end;
/// components are then judged by their samples alone, independent of the largest one's size.
std::vector<std::uint8_t> chosen_components(const TriangleMesh& mesh, const MeshComponents& components,
                                            const ComponentChoice& choice, const PointSet& points, double spacing,
                                            bool open);

/// Keeps the chosen components. Stray samples far from the shape can produce sheets larger than parts of it. The
/// criterion is therefore the area that samples support; `automatic` drops components that have little of it.
/// `left_out`, if not null, is replaced by them.
void choose_components(TriangleMesh& mesh, const ComponentChoice& choice, const PointSet& points, double spacing,
                       MeshReport& report, TriangleMesh* left_out = nullptr);

/// Vertices take the mean colour of the four nearest samples, weighted by inverse squared distance.
void carry_colors(TriangleMesh& mesh, const PointSet& points, const KdTree& samples);

/// Adds the attributes of `confidence` on demand; distances are converted from the field's to the input's coordinates.
/// Throws DataError if they were requested and there are no samples.
void mark_confidence(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, const LocalFrame& frame,
                     const MeshOptions& options, const MeshReport& r);

/// Code of the warning about samples without a surface.
inline constexpr std::string_view kLostSamples = "lost_samples";

/// Reports the samples without a surface, and warns if there are many. The remedy is named if the components that were
/// left out have a surface near them. `frame`: of mesh and points.
void report_lost(const TriangleMesh& mesh, const TriangleMesh& left_out, const PointSet& points, double spacing,
                 double noise, const LocalFrame& frame, MeshReport& report);

/// That warning; null without it.
Note* lost_samples(MeshReport& report);

/// Warning about a mesh of more triangles than requested.
Note too_many_triangles(std::size_t made, std::size_t requested);

/// Copies the handles' figures, and warns about narrow ones. `frame`: of the mesh.
void report_handles(const NarrowHandles& handles, const LocalFrame& frame, MeshReport& report);

/// Chooses the components, closes handles, transfers the colours and computes the report. `frame`: of mesh and points.
/// Throws DataError if nothing is left.
void finish_mesh(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, double mesh_error,
                 const LocalFrame& frame, const MeshOptions& options, MeshReport& r);

}  // namespace sansmesh::inline v1::detail
