// Solids as Boolean expressions of solids with faces.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/csg/solid_node.h"
#include "sansmesh/data/boolean_expression.h"
#include "sansmesh/data/similarity.h"

namespace sansmesh::inline v1 {

/// Collects the faces of meshes and primitives and their expression, to which nodes of solids are added in turn.
class FaceBuilder {
 public:
  /// More faces of curved primitives cost more than a mesh of the function.
  static constexpr double kMostCurvedFaces = 2e6;

  /// Only examines the nodes: parts have no faces.
  FaceBuilder() = default;
  /// Faces of curved primitives are `mesh_error` away from them on average. Unbounded ones end beyond `region`, and the
  /// expression is intersected with it. `origin` is subtracted from all positions.
  FaceBuilder(double mesh_error, const Box3& region, const Vec3& origin);

  /// All of these return the index of a node of the expression.
  std::uint32_t mesh(std::shared_ptr<const TriangleMesh> mesh, bool overlaps, const Similarity& map);
  std::uint32_t ball(const Vec3& center, double radius, const Similarity& map);
  std::uint32_t box(const Vec3& lower, const Vec3& upper, const Similarity& map);
  std::uint32_t half_space(const Vec3& normal, double offset, const Similarity& map);
  std::uint32_t cylinder(const Vec3& center, const Vec3& axis, double radius, const Similarity& map);
  std::uint32_t frustum(const Vec3& center, const Vec3& axis, double bottom, double top, double half_height,
                        const Similarity& map);
  std::uint32_t ring(const Vec3& center, const Vec3& axis, double ring, double tube, const Similarity& map);
  std::uint32_t rod(const Vec3& from, const Vec3& to, double radius, const Similarity& map);
  /// A union (sign 1) or intersection (−1).
  std::optional<std::uint32_t> combine(const std::vector<NodePtr>& members, double sign, const Similarity& map);
  /// For nodes without faces: a noun that explains it.
  std::nullopt_t refuse(const char* what);

  BooleanExpression expression;
  std::vector<SolidFaces> parts;
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  ///< mesh of each part; null for primitives
  std::string obstacle;                                     ///< a part without faces; empty: there is none
  bool curved = false;                                      ///< whether faces approximate a primitive
  bool unbounded = false;
  double curved_faces = 0;  ///< number of faces of curved primitives; if too many (kMostCurvedFaces), they have none

 private:
  template <class Make>
  std::uint32_t add(const Similarity& map, const Make& make);
  template <class Make>
  std::uint32_t add_curved(const Similarity& map, std::size_t sides, double count, const Make& make);
  std::uint32_t push(SolidFaces faces, std::shared_ptr<const TriangleMesh> mesh, const Similarity& map);
  /// In the units of the primitive.
  double error(const Similarity& map) const { return mesh_error_ / map.scale; }
  void reach(const Similarity& map, Vec3& center, double& radius) const;

  bool build_ = false;
  double mesh_error_ = 1;
  Box3 region_;
  Vec3 origin_;
  std::multimap<std::uint64_t, std::uint32_t> by_key_;  ///< parts by a hash of their faces
};

/// Faces and expression of a solid.
struct SolidOfFaces {
  BooleanExpression expression;
  std::vector<SolidFaces> parts;                            ///< relative to `origin`
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  ///< mesh of each part; null for primitives
  Vec3 origin;
  bool curved = false;    ///< whether faces approximate primitives
  bool too_many = false;  ///< curved primitives need more faces than FaceBuilder::kMostCurvedFaces, and have none
};

/// Whether a solid has faces.
struct FaceSurvey {
  std::string obstacle;  ///< a part that has none; empty: all have faces
  bool curved = false;   ///< whether faces approximate primitives
  bool meshes = false;   ///< whether there are meshes
  std::size_t parts = 0;
};
FaceSurvey survey_faces(const SolidNode& root);

/// `region` contains the solid. The origin is that of the first mesh. The solid has no obstacle.
SolidOfFaces faces_of(const SolidNode& root, double mesh_error, const Box3& region);

}  // namespace sansmesh::inline v1
