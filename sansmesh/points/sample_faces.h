// Samples of the faces of a mesh or polygon soup: where vertices alone do not describe a surface, its faces do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A place on a triangle (a, b, c): (1 − u − v) a + u b + v c.
struct FaceSample {
  Vec3 position;
  Vec3f normal;  ///< unit, of the triangle
  std::uint32_t triangle = 0;
  float u = 0, v = 0;
};

/// `count` samples spread evenly over the area of the triangles: it is cut into equal parts in their order, with one
/// sample at random in each, so that neighbouring samples are neighbours in space too. Placed by a fixed rule: the same
/// on every run, for any number of threads. Triangles with a corner that does not exist or is not finite, and such
/// without area, get none; empty where all are such.
std::vector<FaceSample> sample_triangles(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                         std::size_t count);

/// The normal of a triangle times twice its area; zero for those whose corners are not there or not finite.
Vec3 doubled_area(std::span<const Vec3f> vertices, const Triangle& triangle);

/// A cloud of `count` samples of the faces with the normals of the faces; colours and attributes of the vertices are
/// interpolated, those of the triangles taken over (where no vertex attribute has the name).
PointSet sample_faces(const PointSet& mesh, std::size_t count);

/// For each vertex the area-weighted mean of the normals of the faces around it, of length 1; zero without faces.
std::vector<Vec3f> normals_from_faces(const PointSet& mesh);

/// Replaces the normals by these.
void set_normals_from_faces(PointSet& mesh);

}  // namespace sansmesh::inline v1
