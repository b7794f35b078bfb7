// All that can be told of a cloud, a mesh or a function by itself.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/given_normals.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/sights.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct AttributeInfo {
  std::string name;
  std::string_view of = "point";  ///< what has it: "point", "triangle" or "cell"
  NumberType type = NumberType::f32;
  /// For each component the least and the largest finite number; nothing where there is none.
  std::vector<std::optional<std::pair<double, double>>> ranges;
  std::optional<std::size_t> not_finite = {};  ///< numbers; told of arrays of volumes

  static const ReportSchema& schema();
};

/// Lengths and places in the unit of the input.
struct CloudInfo {
  std::size_t points = 0;      ///< or vertices
  std::size_t duplicates = 0;  ///< in the place of another
  Box3 box;
  Vec3 size;          ///< of the box
  std::string spans;  ///< "a volume", "a plane", …, or how far its parts are apart
  double spacing = 0;
  NoiseEstimate noise;
  GivenNormals normals;
  OrientBy orient_by = OrientBy::automatic;  ///< from what normals would get their signs
  bool colors = false;
  std::size_t scanners = 0;  ///< whose positions are known
  std::vector<AttributeInfo> attributes;
  /// Points of each class (point_class_name); nothing where they have none.
  std::optional<std::array<std::size_t, 256>> classes;
  std::size_t triangles = 0;         ///< of the file
  std::optional<MeshTopology> mesh;  ///< of what has some, sewn where its borders lie on each other

  static const ReportSchema& schema();
};

/// Throws Cancelled.
CloudInfo info(const PointSet& points, Progress& progress);

struct FunctionInfo {
  std::size_t fits = 0;
  FitsOfDegree fits_of_degree{};
  std::size_t creased = 0;  ///< fits
  int depth = 0;            ///< deepest level of the tree
  /// Share of the surface that bounds no solid and ends with its samples.
  double open_share = 0;
  double behind = 1;        ///< mean winding number just behind the samples: 1 if the surface is closed
  std::size_t samples = 0;  ///< that were kept
  bool colors = false;      ///< of these
  Box3 cube;
  double spacing = 0;
  double deviation = 0;  ///< of the samples from the surface, root mean square
  double accuracy = 0;   ///< expected error of the surface
  std::vector<std::string> history;

  static const ReportSchema& schema();
};

FunctionInfo info(const SurfaceFunction& function);

/// "t (double × 3 a point): 0 to 1, 2 to 3, …".
std::string array_words(const AttributeInfo& array);
/// "from (0, 0, 0) to (1, 2, 3)", to ten digits.
std::string box_words(const Box3& box);
/// All of it in lines for people.
std::vector<std::string> summary_of(const CloudInfo& info);
std::vector<std::string> summary_of(const FunctionInfo& info);

}  // namespace sansmesh::inline v1
