// What a simulated body did, frame by frame, and everything that is made of it: files of tetrahedra and meshes,
// pictures, an animation.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "sansmesh/data/image.h"
#include "sansmesh/data/tet_mesh.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/dynamics/soft_body_options.h"
#include "sansmesh/dynamics/tet_embedding.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/render/volume_options.h"
#include "volume_colors.h"
#include "volume_input.h"

namespace sansmesh::cli {

/// Positions and velocities of all vertices at moments, in the unit of the body's file.
class Motion {
 public:
  /// `with_positions`, `with_velocities`: whether these are wanted; otherwise only the times are kept.
  Motion(const TetMesh& rest, bool with_positions, bool with_velocities);
  /// What so many frames take in memory.
  double bytes(std::size_t frames) const;
  /// `unit`: metres of the file's unit, in which positions and velocities do not come.
  void add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit);

  const TetMesh& rest() const { return rest_; }
  std::size_t frames() const { return times_.size(); }
  double time(std::size_t frame) const { return times_[frame]; }
  std::vector<Vec3> positions(std::size_t frame) const;
  const std::vector<Vec3f>& velocities(std::size_t frame) const { return velocities_[frame]; }
  /// Middle of the body at rest.
  const Vec3& origin() const { return origin_; }

 private:
  const TetMesh& rest_;
  Vec3 origin_;
  bool with_positions_, with_velocities_;
  std::vector<double> times_;
  std::vector<std::vector<Vec3f>> positions_;  ///< from the origin
  std::vector<std::vector<Vec3f>> velocities_;
};

/// A surface that the tetrahedra carry: their own boundary, or one that lies in them.
class CarriedSurface {
 public:
  explicit CarriedSurface(const TetMesh& rest);
  CarriedSurface(const TetMesh& rest, TriangleMesh surface);
  TriangleMesh at(const Motion& motion, std::size_t frame) const;
  /// Its vertices that lie in no tetrahedron.
  std::size_t outside() const { return embedding_ ? embedding_->outside() : 0; }
  std::size_t vertices() const { return surface_.vertices.size(); }

 private:
  TriangleMesh surface_;
  std::vector<std::uint32_t> sources_;  ///< of the boundary
  std::optional<TetEmbedding> embedding_;
  std::vector<Vec3> normals_;
};

/// A volume that is seen through the tetrahedra.
struct CarriedVolume {
  VolumeInput input;
  VolumeColors colors;

  bool wanted() const { return !input.files.empty(); }
};

/// Pictures of all frames from one place, from which the whole motion is seen.
class MotionPictures {
 public:
  /// Opens the volume and checks all options, before there is any motion. What is passed must outlive it.
  MotionPictures(const Motion& motion, const CarriedSurface* surface, const CarriedVolume& volume,
                 const RenderOptions& options, Console& console);
  ~MotionPictures();
  /// When the motion is complete, before pictures are drawn; `scene` is in the unit of the body's file.
  void frame(const DynamicsScene& scene);
  Image draw(std::size_t frame, Progress& progress);

 private:
  struct Volume;
  const Motion& motion_;
  const CarriedSurface* surface_;
  RenderOptions options_;
  std::vector<Vec3> framed_;
  std::vector<TriangleMesh> obstacles_;
  std::unique_ptr<Volume> volume_;
};

/// NAME.vtu becomes NAME_0007.vtu.
std::string motion_frame_name(const std::string& output, std::size_t frame);

}  // namespace sansmesh::cli
