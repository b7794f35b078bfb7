// Light along rays through a volume: emission and absorption from front to back, many rays at a time.
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

/// Light that comes along a ray (linear, without what is behind), and the share of what is behind that comes through.
struct TracedLight {
  Vec3f light;
  float left = 1;
  friend bool operator==(const TracedLight&, const TracedLight&) = default;
};

/// What tracing looks at. All of it must outlive the tracer.
struct TracedVolume {
  const VolumeField* field = nullptr;    ///< one component: colours, iso-surfaces, and opacities unless
  const VolumeField* opacity = nullptr;  ///< there is one for them
  const ScalarField* gap = nullptr;      ///< above 0 where nothing is; may be null
  bool bounded = false;                  ///< the stretches end at the boundary; else the field is asked what is inside
  const VolumeStretches* stretches = nullptr;
  const VolumeCells* cells = nullptr;
  std::vector<const PictureScene*> surfaces;  ///< in the picture's coordinates
  PictureFrame frame;
};

class VolumeTracer {
 public:
  VolumeTracer(const TracedVolume& volume, const Camera& camera, const TransferFunction& transfer,
               const VolumePictureOptions& options);

  /// Light along each of the rays of the camera (whose near and far do not count); as many answers. What a ray finds
  /// does not depend on the others: neighbours in neighbouring slots, some hundreds at a time, go fastest. Returns the
  /// number of places at which the field was evaluated. Safe from several threads.
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
  double footprint(double t) const;  ///< of a pixel at distance t
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
  bool parallel_ = false;  // rays
  Lighting lighting_;
  TransferFunction transfer_;
  TransferTable colors_;  // with extinctions; or colours alone where opacities are of another array
  TransferTable depths_;
  const VolumePictureOptions& options_;
  bool separate_ = false;
  double extinction_ = 0;                     // per picture length, of extinction 1 in reference lengths
  double value_range_ = 0, other_range_ = 0;  // of the transfer function
  double weak_ = 0;      // gradients (per picture length) that say as little about a surface as they say much
  float footprint_ = 0;  // of a pixel at distance 1, or of parallel rays at any
  std::optional<double> least_shown_;  // of values on faces of gaps, where only iso-surfaces are seen
  std::vector<std::uint8_t> clear_;    // of each cell: 0, or 1 + so many around it in each direction are clear, too
  std::vector<Vec3f> iso_colors_;
};

}  // namespace sansmesh::inline v1
