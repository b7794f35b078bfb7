// Pictures of volumes: whatever a field says between the samples, seen through.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// What there is to see. All of it must outlive the picture.
struct VolumeSubject {
  const VolumeField* field = nullptr;    ///< colours, iso-surfaces and opacities; one component
  const VolumeField* opacity = nullptr;  ///< opacities, where they come from another array; one component
  /// Closed, turned outwards. Null: `inside` of the field decides, in the box of the field, a step at a time. That is
  /// exact only where the volume is that box: of all others, lattices included whose directions are not the axes, the
  /// sides become ragged without a boundary (volume_boundary() has it).
  const TriangleMesh* boundary = nullptr;
  std::vector<PictureSurface> surfaces;  ///< in the same picture
  /// Known to be in the volume or on its boundary, such as its samples: where a volume fills so little of its box that
  /// hardly a point of a lattice hits it, values are looked for there. Without, the vertices of the boundary are taken.
  std::span<const Vec3> places = {};
  /// Points that the picture is to show all of; default: the boundary, or the box of the field.
  std::span<const Vec3> framed = {};
  /// Above 0 in gaps that cuts have opened in the volume, about the distance from their faces there and beside them, in
  /// the coordinates of the data. Nothing is seen in gaps, and rays find their faces exactly; where they look at one it
  /// shows its values in the light of the gap's gradient, as far as `clip_faces` says. Null: there are none.
  const ScalarField* gap = nullptr;
  /// Values may be those of an image (CT, MR): materials are looked for where the transfer function is to be suggested.
  bool image = true;
};

/// Built once for a volume; then pictures of it from anywhere, with any transfer function.
class VolumePicture {
 public:
  /// Throws ArgumentError for fields of other than one component, DataError where there is nothing to draw.
  VolumePicture(VolumeSubject subject, Progress& progress);
  ~VolumePicture();
  VolumePicture(const VolumePicture&) = delete;
  VolumePicture& operator=(const VolumePicture&) = delete;

  /// From now on these stand in the picture.
  void set_surfaces(std::vector<PictureSurface> surfaces);

  /// In perspective, framed by the boundary. Does not depend on the number of threads. `report` may be null;
  /// `check_steps` fills in the errors of the steps, which takes about a fiftieth of the time. Throws ArgumentError for
  /// bad options.
  Image render(const VolumePictureOptions& options, Progress& progress, VolumePictureReport* report = nullptr,
               bool check_steps = false) const;

  /// What is seen without anything behind it, for the camera given in coordinates of frame(): linear light,
  /// premultiplied, and the share of light from behind that comes through. One ray a pixel, options.samples² where
  /// neighbours differ.
  PixelMap<std::array<float, 4>> light(const Camera& camera, const VolumePictureOptions& options, Progress& progress,
                                       VolumePictureReport* report = nullptr) const;

  const PictureFrame& frame() const;
  Camera camera(const VolumePictureOptions& options) const;
  /// Of the field's values in the volume.
  const ValueHistogram& histogram() const;
  /// The transfer function that pictures with these options have.
  TransferFunction transfer(const VolumePictureOptions& options) const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// One picture.
Image render_volume(const VolumeSubject& subject, const VolumePictureOptions& options, Progress& progress,
                    VolumePictureReport* report = nullptr);

}  // namespace sansmesh::inline v1
