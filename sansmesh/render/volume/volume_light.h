// Emission, absorption and lighting along rays through a volume.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/volume/traced_walk.h"
#include "sansmesh/render/volume/transfer_table.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1::detail {

/// Adds light to walks.
class VolumeLight {
 public:
  /// `separate`: opacities are of another array than colours. `size`: length of 1 in picture coordinates. The options
  /// must outlive it.
  VolumeLight(const Camera& camera, const TransferFunction& transfer, const VolumePictureOptions& options,
              bool separate, double size);

  const Lighting& lighting() const { return lighting_; }
  /// Whether values that give opacities absorb nothing between the two.
  bool clear(double a, double b) const { return options_.opacity_factor == 0 || depths_.clear(a, b); }
  /// Least value on faces of gaps, if only iso-surfaces are visible.
  const std::optional<double>& least_shown() const { return least_shown_; }

  /// Adds a layer.
  void lay(TracedWalk& walk, const Vec3f& light, double opacity) const;
  void cut_face(TracedWalk& walk, const TracedSample& sample) const;
  /// Adds the face behind a gap, lit by the gradient of the gap.
  void gap_face(TracedWalk& walk, const TracedSample& sample) const;
  /// Proceeds from one sample to the next, through the iso-surfaces between them.
  void go_through(TracedWalk& walk, TracedSample& a, TracedSample& b, std::span<IsoRoot> roots) const;

 private:
  void shade(const TracedWalk& walk, TracedSample& sample, bool surface) const;
  void absorb(TracedWalk& walk, const TracedSample& a, const TracedSample& b, double from, double to) const;

  Lighting lighting_;
  TransferFunction transfer_;
  TransferTable colors_;  // with extinctions; colours only if opacities are of another array
  TransferTable depths_;
  const VolumePictureOptions& options_;
  bool separate_ = false;
  double extinction_ = 0;  // per picture length, for extinction 1 per reference length
  double weak_ = 0;        // gradient length (per picture length) at which a surface counts half
  std::optional<double> least_shown_;
  std::vector<Vec3f> iso_colors_;
};

}  // namespace sansmesh::inline v1::detail
