// Pictures of a body of tetrahedra that moved.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "sansmesh/simulate.h"
#include "sansmesh/tet_mesh.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// A volume that is seen through the tetrahedra.
struct CarriedVolume {
  std::shared_ptr<const VolumeField> field = {};  ///< of one component
  bool image = false;                             ///< its samples lie on a lattice
  VolumePictureOptions look = {};                 ///< its own part: what all pictures share is taken from their options
};

/// Pictures of all frames from one place, from which the whole motion is seen.
class SANSMESH_API MotionPictures {
 public:
  /// Checks all options before there is any motion. Without a surface there is a volume. Throws ArgumentError.
  MotionPictures(std::shared_ptr<const TetMesh> rest, std::shared_ptr<const CarriedSurface> surface,
                 std::optional<CarriedVolume> volume, const RenderOptions& options);
  ~MotionPictures();
  MotionPictures(MotionPictures&&) noexcept;             ///< moves
  MotionPictures& operator=(MotionPictures&&) noexcept;  ///< moves

  /// "volume_ends": the volume does not reach everywhere in the tetrahedra.
  const std::vector<Note>& notes() const;
  /// To be called once, before pictures are drawn; obstacles of `scene` are drawn, its lengths in the unit of the
  /// body's file.
  void show(Motion motion, const DynamicsScene& scene);
  /// The picture of a frame of the motion, from 0 on. Not from several threads. Throws DataError where there is nothing
  /// to draw, Cancelled.
  Image draw(std::size_t frame, Progress& progress);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
