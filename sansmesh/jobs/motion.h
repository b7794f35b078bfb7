// A body of tetrahedra that moved: its positions at moments, and the surface that it carries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/dynamics/tet_embedding.h"
#include "sansmesh/note.h"
#include "sansmesh/tet_mesh.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// What is kept of a motion beside the moments of its frames.
struct KeptMotion {
  bool positions = true, velocities = true;
};

/// Positions and velocities of all vertices at moments, in the unit of the body's file.
class Motion {
 public:
  Motion(std::shared_ptr<const TetMesh> rest, const KeptMotion& kept);
  /// What so many frames take in memory.
  double bytes(std::size_t frames) const;
  /// Positions and velocities in metres; `unit`: metres of the file's unit.
  void add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit);

  const TetMesh& rest() const { return *rest_; }
  std::size_t frames() const { return times_.size(); }
  /// Seconds.
  double time(std::size_t frame) const { return times_[frame]; }
  std::vector<Vec3> positions(std::size_t frame) const;
  const std::vector<Vec3f>& velocities(std::size_t frame) const { return velocities_[frame]; }
  /// Middle of the body at rest.
  const Vec3& origin() const { return origin_; }

 private:
  std::shared_ptr<const TetMesh> rest_;
  Vec3 origin_;
  KeptMotion kept_;
  std::vector<double> times_;
  std::vector<std::vector<Vec3f>> positions_;  ///< from the origin
  std::vector<std::vector<Vec3f>> velocities_;
};

/// A surface that the tetrahedra carry: their own boundary, or one that lies in them.
class CarriedSurface {
 public:
  explicit CarriedSurface(const TetMesh& rest);
  /// Throws DataError where a vertex is not finite.
  CarriedSurface(const TetMesh& rest, TriangleMesh surface);
  TriangleMesh at(const Motion& motion, std::size_t frame) const;
  /// "outside": vertices that lie in no tetrahedron.
  std::vector<Note> notes() const;

 private:
  TriangleMesh surface_;
  std::vector<std::uint32_t> sources_;  ///< of the boundary
  std::optional<TetEmbedding> embedding_;
  std::vector<Vec3> normals_;
};

}  // namespace sansmesh::inline v1
