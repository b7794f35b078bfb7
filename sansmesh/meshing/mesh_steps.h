// The steps from a field to a finished mesh that the front doors share; not part of the public interface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1::detail {

/// A component of a mesh is small if its samples (or, without samples, its area) are less than this share of those of
/// the largest one.
constexpr double kSmallComponent = 0.015;

/// How to cut out a mesh that is `mesh_error` (length of the field) off on average.
PolygonizeOptions meshing_options(const MeshOptions& options, double mesh_error, bool creases);

/// Whether cut_out leaves a mesh of so many blocks alone that simplification would gain little for.
bool may_skip_simplification(std::size_t blocks, const MeshOptions& options);

/// For each component the number of places nearest to it: at(i), relative to the mesh's origin, for i < n.
std::vector<std::size_t> count_nearest(const TriangleMesh& mesh, const MeshComponents& components, std::size_t n,
                                       const std::function<Vec3f(std::size_t)>& at);

/// Cuts it out; fills in the number of blocks and, if asked for, the quality before enhancement.
TriangleMesh cut_out(const ScalarField& field, const BlockTree& blocks, const MeshOptions& options,
                     PolygonizeOptions meshing, Progress& progress, MeshReport& r);

/// 1 for the components that choose_components keeps. `open`: some of the surface ends where its samples do, where
/// parts are judged by their samples alone, however small they are beside the largest one.
std::vector<std::uint8_t> chosen_components(const TriangleMesh& mesh, const MeshComponents& components,
                                            const ComponentChoice& choice, const PointSet& points, double spacing,
                                            bool open);

/// Keeps the components chosen. Stray samples far from the shape can make sheets larger than parts of it, so what
/// counts is the area that samples stand for; automatically, components go that have little of it.
void choose_components(TriangleMesh& mesh, const ComponentChoice& choice, const PointSet& points, double spacing,
                       MeshReport& report);

/// Each vertex takes the mean colour of the four nearest samples, weighted by inverse squared distance.
void carry_colors(TriangleMesh& mesh, const PointSet& points, const KdTree& samples);

/// Fills in the attributes of `confidence`, if they are wanted; in the coordinates of the field, which lie so in the
/// input. Throws DataError if they were asked for and there are no samples.
void mark_confidence(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, const LocalFrame& frame,
                     const MeshOptions& options, const MeshReport& r);

/// Fills in which samples have no surface.
void report_lost(const TriangleMesh& mesh, const PointSet& points, double spacing, double noise, MeshReport& report);

/// What a warning says of them, if there are many; `most_lost` in the input.
std::string lost_samples(const MeshReport& report);

/// Chooses the components, carries the colours over, measures. Throws DataError if nothing is left.
void finish_mesh(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, double mesh_error,
                 const MeshOptions& options, MeshReport& r);

}  // namespace sansmesh::inline v1::detail
