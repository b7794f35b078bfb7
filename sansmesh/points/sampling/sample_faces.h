// Samples the faces of a mesh or polygon soup, for meshes whose vertices do not describe the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Point (1 − u − v) a + u b + v c of a triangle (a, b, c).
struct FaceSample {
  Vec3 position;
  Vec3f normal;  ///< unit normal of the triangle
  std::uint32_t triangle = 0;
  float u = 0, v = 0;
};

/// `count` samples distributed evenly over the area of the triangles: the area is divided in triangle order into equal
/// parts with one random sample each, so that consecutive samples are close in space. Reproducible for any number of
/// threads. Skips triangles with a nonexistent or non-finite corner or without area; empty if there are no others.
std::vector<FaceSample> sample_triangles(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                         std::size_t count);

/// Cloud of `count` face samples with face normals. Interpolates colours and attributes of the vertices, and copies
/// those of the triangles (unless a vertex attribute has the same name).
PointSet sample_faces(const PointSet& mesh, std::size_t count);

/// Unit area-weighted mean of the face normals around each vertex; zero without faces.
std::vector<Vec3f> normals_from_faces(const PointSet& mesh);

/// Replaces the normals by normals_from_faces.
void set_normals_from_faces(PointSet& mesh);

}  // namespace sansmesh::inline v1
