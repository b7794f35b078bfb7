// What `convert` does to clouds and meshes between reading and writing, in the order of the command line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "sansmesh/core/box.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/data/triangle_mesh.h"

namespace sansmesh::cli {

class CommandLine;

/// A cloud, or a mesh.
struct CloudOrMesh {
  bool is_mesh = false;
  PointSet points;    ///< unless it is a mesh
  TriangleMesh mesh;  ///< if it is one
  /// Attributes of three reals that were not turned with everything else: nobody knows whether they are directions.
  std::vector<std::string> unturned;

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
  /// Its vertices alone.
  void make_points();
};

/// One of them, with what it was told. `run` changes the data and returns what is to be said, if anything; it throws
/// DataError.
struct ConvertStep {
  std::string flag;  ///< "--crop"
  std::function<std::string(CloudOrMesh& data)> run;
};

struct ConvertSteps {
  std::vector<ConvertStep> steps;
  std::optional<double> from_unit, to_unit;  ///< metres
  std::optional<Vec3> about;                 ///< fixed point of the rotations and scalings that follow
  bool about_center = false;
  bool about_waits = false;  ///< for a rotation or scaling after it

  /// Throws ArgumentError for options that do not fit together.
  void check() const;
  /// All, one after the other. Remarks are appended to `said`; returns what was done. Throws DataError where a step
  /// leaves nothing.
  Json run(CloudOrMesh& data, Progress& progress, std::vector<std::string>& said) const;
};

/// --transform, --translate, …, --drop
void add_convert_steps(CommandLine& command, ConvertSteps& steps);

}  // namespace sansmesh::cli
