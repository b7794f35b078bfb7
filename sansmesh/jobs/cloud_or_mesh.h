// A cloud or a mesh, and what can be done to either.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/affine_map.h"
#include "sansmesh/box.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The vertices of a mesh, with all that belongs to them.
PointSet vertices_of(TriangleMesh mesh);

/// A cloud, or a mesh.
struct CloudOrMesh {
  bool is_mesh = false;
  PointSet points;    ///< unless it is a mesh
  TriangleMesh mesh;  ///< if it is one
  /// Attributes of three reals that were not turned with everything else: nobody knows whether they are directions.
  std::vector<std::string> unturned;
  /// Edges of three triangles or more that welding has made.
  std::size_t nonmanifold_edges_of_weld = 0;

  /// As it was read: a mesh if it has triangles. Which file or scan each sample is of becomes an attribute, "source",
  /// if there are several.
  explicit CloudOrMesh(PointSet read);

  std::size_t size() const { return is_mesh ? mesh.vertices.size() : points.size(); }
  /// "1,234 points", or "1,234 vertices, 2,345 triangles".
  std::string size_words() const;
  const Vec3& origin() const { return is_mesh ? mesh.origin : points.origin; }
  /// In the coordinates of the file.
  Box3 bounds() const;
  const AttributeTable& attributes() const { return is_mesh ? mesh.attributes : points.attributes; }
  /// ", with normals, colours, intensity and 3 more": what there is but for what is lost.
  std::string belongings(const std::vector<std::string>& lost) const;
  /// Its vertices alone.
  void make_points();
};

// Each changes the data and returns what is to be said, if anything; throws DataError where that cannot be done.

/// Moves everything that is known to be a place or a direction.
std::string move_all(CloudOrMesh& data, const AffineMap& map);
/// What lies in the box, or outside of it; meshes are cut.
std::string crop_to_box(CloudOrMesh& data, const Box3& box, bool inside);
/// Makes one of vertices (or points) no farther apart than this.
std::string weld_places(CloudOrMesh& data, double distance);
/// Of a cloud points no two of which are closer than this.
std::string keep_apart(CloudOrMesh& data, double distance);
/// Of a cloud so many, drawn by chance.
std::string keep_count(CloudOrMesh& data, std::size_t count);
/// Of a cloud the first of every n.
std::string keep_every(CloudOrMesh& data, std::size_t n);
std::string flip_sides(CloudOrMesh& data, bool faces, bool normals);
/// Keeps or drops the normals, colours and attributes that the list names.
std::string choose_attributes(CloudOrMesh& data, const std::vector<std::string>& names, bool keep);

}  // namespace sansmesh::inline v1
