// Pictures of a body of tetrahedra that moved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/render/volume_options.h"
#include "sansmesh/simulate.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// A volume that is seen through the tetrahedra.
struct CarriedVolume {
  std::shared_ptr<const VolumeField> field;  ///< of one component
  bool image = false;                        ///< its samples lie on a lattice
  VolumePictureOptions look;                 ///< its own part: what all pictures share is taken from their options
};

/// Pictures of all frames from one place, from which the whole motion is seen.
class MotionPictures {
 public:
  /// Checks all options before there is any motion. Without a surface there is a volume. Throws ArgumentError.
  MotionPictures(std::shared_ptr<const TetMesh> rest, std::shared_ptr<const CarriedSurface> surface,
                 std::optional<CarriedVolume> volume, const RenderOptions& options);
  /// "volume_ends": the volume does not reach everywhere in the tetrahedra.
  const std::vector<Note>& notes() const { return notes_; }
  /// To be called once, before pictures are drawn; obstacles of `scene` are drawn, its lengths in the unit of the
  /// body's file.
  void show(Motion motion, const DynamicsScene& scene);
  Image draw(std::size_t frame, Progress& progress);

 private:
  std::shared_ptr<const TetMesh> rest_;
  std::shared_ptr<const CarriedSurface> surface_;
  std::optional<CarriedVolume> volume_;
  RenderOptions options_;
  std::vector<Note> notes_;
  Motion motion_;
  std::vector<Vec3> framed_;
  std::vector<TriangleMesh> obstacles_;
  TriangleMesh boundary_;  ///< of the volume in the frame that is drawn
  std::vector<std::uint32_t> sources_;
};

}  // namespace sansmesh::inline v1
