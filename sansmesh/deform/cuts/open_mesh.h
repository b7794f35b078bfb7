// Opens meshes along cuts, so that a deformation can separate the two sides.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct OpenMeshOptions {
  /// Triangles that a cut crosses other than between two points of their border, or between one and the end of the cut,
  /// are divided in four, up to this number of times; 0..12.
  int refinements = 6;
  /// Whether closed meshes are closed again by faces along the parts of half-planes and polygons inside them. Vertex
  /// normals are then dropped, because there are two at the edges of these faces.
  bool close = false;
  /// Largest edge length within these faces; > 0. Default: three times the mesh's mean edge length.
  std::optional<double> face_edges = {};

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Splits the edges and triangles that a cut crosses, and doubles the vertices on the cut except at its border, where
/// the slit ends: the two sides are then disconnected. Vertices within a thousandth of an edge from the cut are moved
/// onto it. Cuts are processed sequentially. Vertices do not move apart: copies coincide, and their attribute kCutSide
/// gives the offset at which the deformation is evaluated (deform_mesh). The origin moves near a mesh that is farther
/// from it than its size. Within a triangle the cut is taken as straight. Clouds need no opening: each point is on one
/// side.
TriangleMesh open_along_cuts(TriangleMesh mesh, std::span<const std::shared_ptr<const Occluder>> cuts,
                             const OpenMeshOptions& options = {}, OpenMeshReport* report = nullptr);

}  // namespace sansmesh::inline v1
