// Pictures of volumes by direct volume rendering of fields.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
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

/// Content of a picture. All of it must outlive the picture.
struct VolumeSubject {
  const VolumeField* field = nullptr;    ///< colours, iso-surfaces and opacities; one component
  const VolumeField* opacity = nullptr;  ///< opacities if they come from another array; one component
  /// Closed, oriented outwards. Null: the field's `inside` decides within its box, at each step. That is exact only if
  /// the volume is that box; the sides of others (also of lattices not parallel to the axes) become ragged.
  /// volume_boundary() computes a boundary.
  const TriangleMesh* boundary = nullptr;
  std::vector<SceneFactory> surfaces;  ///< in the same picture
  /// Points known to be in the volume or on its boundary, usually its samples. If the volume fills so little of its box
  /// that few lattice points hit it, the histogram uses these. Default: the vertices of the boundary.
  std::span<const Vec3> samples = {};
  /// Range of the samples' values, if known: ranges of colours and reports do not leave it.
  std::optional<ValueRange> values = {};
  /// Points that the picture must show; default: the boundary, or the box of the field.
  std::span<const Vec3> framed = {};
  /// Positive in gaps that cuts have opened in the volume, about the distance to their faces there and nearby, in the
  /// coordinates of the data. Gaps are clear, and rays find their faces exactly. With `clip_faces`, a visible face
  /// shows its values, lit by the gap's gradient. Null: no gaps.
  const ScalarField* gap = nullptr;
  /// Values may be those of an image (CT, MR): suggestions of a transfer function look for materials.
  bool image = true;
};

/// Built once per volume, for pictures from any direction with any transfer function.
class VolumePicture {
 public:
  /// Throws ArgumentError for fields with several components, DataError if there is nothing to draw.
  VolumePicture(VolumeSubject subject, Progress& progress);
  ~VolumePicture();
  VolumePicture(const VolumePicture&) = delete;
  VolumePicture& operator=(const VolumePicture&) = delete;

  /// Replaces the surfaces in the picture.
  void set_surfaces(std::vector<SceneFactory> surfaces);

  /// Perspective picture, framed by the boundary. Does not depend on the number of threads. `report` may be null;
  /// `check_steps` estimates the errors of the steps, which takes about a fiftieth of the time. Throws ArgumentError
  /// for bad options.
  Image render(const VolumePictureOptions& options, Progress& progress, VolumePictureReport* report = nullptr,
               bool check_steps = false) const;

  /// Light without a background, for a camera in coordinates of frame(): linear premultiplied light, and the
  /// transmitted share of the light from behind, as pixel_means().
  PixelMap<std::array<float, 4>> light(const Camera& camera, const VolumePictureOptions& options, Progress& progress,
                                       VolumePictureReport* report = nullptr) const;

  const PictureFrame& frame() const;
  Camera camera(const VolumePictureOptions& options) const;
  /// Histogram of the field's values in the volume.
  const ValueHistogram& histogram() const;
  /// The transfer function of pictures with these options.
  TransferFunction transfer(const VolumePictureOptions& options) const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// Renders one picture.
Image render_volume(const VolumeSubject& subject, const VolumePictureOptions& options, Progress& progress,
                    VolumePictureReport* report = nullptr);

}  // namespace sansmesh::inline v1
