// Where rays run inside a volume: from each entry through its boundary to the exit, convex or not.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// A part of a ray, as distances in the picture's coordinates.
struct RayStretch {
  double begin = 0, end = 0;
  bool begins_at_cut = false, ends_at_cut = false;
  friend bool operator==(const RayStretch&, const RayStretch&) = default;
};

struct VolumeRay {
  Vec3 origin, direction;  ///< direction: unit vector
};

/// The boundary of a volume, cut open. Built once, then asked from any thread.
class VolumeStretches {
 public:
  /// The field must outlive it. Without a boundary the box of the field takes its place.
  VolumeStretches(const VolumeField& field, const TriangleMesh* boundary, const PictureFrame& frame);

  /// Replaces `stretches` by those of all rays; those of ray i are first[i] up to first[i + 1]. Crossings in and out
  /// count; where they do not make sense (a ray along a face, through an edge that two triangles claim or none), the
  /// field is asked for the middle of each piece between two crossings whether it is inside. What cuts take away is
  /// left out.
  void find(std::span<const VolumeRay> rays, std::span<const VolumeCut> cuts, std::vector<RayStretch>& stretches,
            std::vector<std::uint32_t>& first) const;

 private:
  void between_crossings(std::span<const VolumeRay> rays, std::vector<std::vector<RayStretch>>& found) const;

  const VolumeField& field_;
  PictureFrame frame_;
  std::optional<RayScene> boundary_;
  Vec3 lower_, upper_;  // box in the picture's coordinates
};

}  // namespace sansmesh::inline v1
