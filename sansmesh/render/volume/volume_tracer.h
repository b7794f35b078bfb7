// Emission and absorption along rays through a volume, front to back, for many rays together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/volume/traced_walk.h"
#include "sansmesh/render/volume/volume_cells.h"
#include "sansmesh/render/volume/volume_intervals.h"
#include "sansmesh/render/volume/volume_light.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// Linear light along a ray without the background, and the transmitted share of the light from behind.
struct TracedLight {
  Vec3f light;
  float left = 1;
  friend bool operator==(const TracedLight&, const TracedLight&) = default;
};

/// Scene of a tracer. All of it must outlive the tracer.
struct TracedVolume {
  const VolumeField* field = nullptr;    ///< one component: colours, iso-surfaces, and opacities without `opacity`
  const VolumeField* opacity = nullptr;  ///< opacities; may be null
  const ScalarField* gap = nullptr;      ///< positive in empty gaps; may be null
  bool bounded = false;                  ///< the intervals end at the boundary; otherwise the field's `inside` decides
  const VolumeIntervals* intervals = nullptr;
  const VolumeCells* cells = nullptr;
  std::vector<const PictureScene*> surfaces;  ///< in the picture's coordinates
  PictureFrame frame;
};

class VolumeTracer {
 public:
  VolumeTracer(const TracedVolume& volume, const Camera& camera, const TransferFunction& transfer,
               const VolumePictureOptions& options);

  /// Light along each of the camera's rays (near and far are ignored). The result of a ray does not depend on the
  /// others. Fastest with some hundreds of neighbouring rays per call. Returns the number of field evaluations.
  /// Thread-safe.
  std::size_t trace(const EyeRays& rays, std::span<TracedLight> lights) const;

 private:
  using TracedWalk = detail::TracedWalk;
  using TracedSample = detail::TracedSample;
  using IsoRoot = detail::IsoRoot;
  struct Layer;
  struct Scratch;

  void find_layers(const EyeRays& rays, Scratch& scratch) const;
  bool next_interval(TracedWalk& walk, const Scratch& scratch) const;
  bool advance(TracedWalk& walk, const Scratch& scratch) const;
  double step_at(std::size_t cell, double t) const { return std::max(steps_[cell], 0.5 * frame_.footprint(t)); }
  bool too_far(const TracedWalk& walk, const TracedSample& now) const;
  std::size_t evaluate(Scratch& scratch) const;
  void take_step(TracedWalk& walk, TracedSample& now, std::span<IsoRoot> roots) const;

  TracedVolume volume_;
  detail::TracedFrame frame_;
  detail::VolumeLight light_;
  const VolumePictureOptions& options_;
  bool separate_ = false;
  double value_range_ = 0, other_range_ = 0;  // ranges of the transfer function
  std::vector<std::uint8_t> clear_;           // per cell: 0, or 1 + the number of clear layers around it
  std::vector<double> steps_;                 // per cell: length of a step
};

}  // namespace sansmesh::inline v1
