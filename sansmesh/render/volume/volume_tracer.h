// Emission and absorption along rays through a volume, front to back, for many rays together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/volume/transfer_table.h"
#include "sansmesh/render/volume/volume_cells.h"
#include "sansmesh/render/volume/volume_stretches.h"
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
  bool bounded = false;                  ///< the stretches end at the boundary; otherwise the field's `inside` decides
  const VolumeStretches* stretches = nullptr;
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
  struct Sample;
  struct Walk;
  struct Root;
  struct Layer;
  struct Scratch;

  void find_layers(const EyeRays& rays, Scratch& scratch) const;
  bool next_stretch(Walk& walk, const Scratch& scratch) const;
  bool next_place(Walk& walk, const Scratch& scratch) const;
  double footprint(double t) const;  ///< width of a pixel at distance t
  double step_at(std::size_t cell, double t) const;
  bool too_far(const Walk& walk, const Sample& now) const;
  std::size_t evaluate(Scratch& scratch) const;
  std::size_t find_roots(Scratch& scratch) const;
  void shade(const Walk& walk, Sample& sample, bool surface) const;
  void go_through(Walk& walk, Sample& a, Sample& b, std::span<Root> roots) const;
  void absorb(Walk& walk, const Sample& a, const Sample& b, double from, double to) const;
  void lay(Walk& walk, const Vec3f& light, double opacity) const;
  void cut_face(Walk& walk, const Sample& sample) const;
  bool may_pass_face(const Walk& walk, const Sample& now) const;
  std::size_t find_faces(Scratch& scratch) const;
  void gap_face(Walk& walk, const Sample& sample) const;
  Vec3 world(const Walk& walk, double t) const;

  TracedVolume volume_;
  bool parallel_ = false;  // the camera's rays are parallel
  Lighting lighting_;
  TransferFunction transfer_;
  TransferTable colors_;  // with extinctions; colours only if opacities are of another array
  TransferTable depths_;
  const VolumePictureOptions& options_;
  bool separate_ = false;
  double extinction_ = 0;                     // per picture length, for extinction 1 per reference length
  double value_range_ = 0, other_range_ = 0;  // ranges of the transfer function
  double weak_ = 0;                           // gradient length (per picture length) at which a surface counts half
  float footprint_ = 0;                       // width of a pixel at distance 1, or of parallel rays at any distance
  std::optional<double> least_shown_;         // least value on faces of gaps, if only iso-surfaces are visible
  std::vector<std::uint8_t> clear_;           // per cell: 0, or 1 + the number of clear layers around it
  std::vector<Vec3f> iso_colors_;
};

}  // namespace sansmesh::inline v1
