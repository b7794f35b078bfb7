// Parts of rays inside a volume, convex or not.
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
struct RayInterval {
  double begin = 0, end = 0;
  bool begins_at_cut = false, ends_at_cut = false;
  friend bool operator==(const RayInterval&, const RayInterval&) = default;
};

struct VolumeRay {
  Vec3 origin, direction;  ///< unit direction
};

/// The boundary of a volume with cuts. Built once; queries are thread-safe.
class VolumeIntervals {
 public:
  /// The field must outlive it. Without a boundary the field's box is used.
  VolumeIntervals(const VolumeField& field, const TriangleMesh* boundary, const PictureFrame& frame);

  /// Replaces `intervals` by those of all rays; ray i has first[i] to first[i + 1]. They follow from the crossings of
  /// the boundary. If crossings are inconsistent (a ray along a face, or through an edge that two triangles or none
  /// count), the field's `inside` at the middle between two crossings decides. Parts inside cuts are removed.
  void find(std::span<const VolumeRay> rays, std::span<const VolumeCut> cuts, std::vector<RayInterval>& intervals,
            std::vector<std::uint32_t>& first) const;

 private:
  void between_crossings(std::span<const VolumeRay> rays, std::vector<std::vector<RayInterval>>& found) const;

  const VolumeField& field_;
  PictureFrame frame_;
  std::optional<RayScene> boundary_;
  Vec3 lower_, upper_;  // box in the picture's coordinates
};

}  // namespace sansmesh::inline v1
