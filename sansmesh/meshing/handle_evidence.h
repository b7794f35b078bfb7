// Evidence of the samples for or against a handle of a mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/mesh/repair/cut_handles.h"
#include "sansmesh/mesh/repair/handle_loops.h"
#include "sansmesh/point_set.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Compares a mesh with its samples before and after a cut. The misfit of a sample is its distance to the mesh,
/// increased by the angle between the normals, up to a reach of about a spacing. Queries but `change` are thread-safe.
class HandleEvidence {
 public:
  /// Lengths in the unit of the mesh. `samples` are those of `points`. All three must outlive the object.
  HandleEvidence(const TriangleMesh& mesh, const PointSet& points, const KdTree& samples, double spacing, double noise);

  /// Must be called after changes of the mesh.
  void mesh_changed() { vertices_.reset(); }

  /// Whether there are samples with normals.
  bool known() const { return points_.normals.size() == points_.size() && samples_.size() > 0; }

  /// Width (length) up to which a handle at x is narrow: two local spacings, or four standard deviations of the noise.
  double narrow_width(const Vec3& x) const;

  /// How well samples support the surface along the loop: 0 if none has a similar normal, 1 if the loop is in the
  /// tangent planes of samples within the reach.
  double support(const HandleClasses& classes, const HandleLoop& loop) const;

  struct Change {
    double gain = 0;                    ///< decrease of the samples' misfit, in samples without a surface
    std::size_t samples = 0;            ///< samples within the reach of the band or of the caps
    std::vector<std::uint32_t> around;  ///< triangles near the band and the caps
  };
  /// Change by a cut; the gain is negative if the handle fits better.
  Change change(const HandleClasses& classes, const HandleCut& cut) const;

  /// Whether samples are within the reach of at least this share of the area of each cap, with similar normals.
  bool covers(const HandleCut& cut, double share) const;

 private:
  struct Face {
    Vec3 a, b, c, normal;
  };
  double spacing_at(const Vec3& x) const;
  double reach(const Vec3& x) const;
  /// Appends a triangle unless it has no area.
  static void add_face(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Face>& faces);
  void add_face(std::uint32_t triangle, std::vector<Face>& faces) const;
  /// Triangles with a vertex in the ball, ascending.
  std::vector<std::uint32_t> triangles_around(const HandleClasses& classes, const Vec3& center, double radius) const;
  /// 1 less the misfit of a point of the surface, over the reach.
  double support(const Vec3& x, const Vec3& normal) const;
  std::vector<Face> faces_of(const HandleCap& cap) const;
  double misfit(std::uint32_t sample, const std::vector<Face>& faces, double reach) const;

  const TriangleMesh& mesh_;
  const PointSet& points_;
  const KdTree& samples_;
  mutable std::optional<KdTree> vertices_;  ///< tree of the mesh, made by the first query
  Vec3 shift_;                              ///< from the mesh's coordinates to the samples'
  double spacing_, noise_;
  mutable std::vector<double> spacing_of_;  ///< local spacing at each sample; negative until a query needs it
};

}  // namespace sansmesh::inline v1::detail
