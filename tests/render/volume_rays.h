// Single rays through volumes.
#pragma once

#include <array>

#include "sansmesh/render/volume/volume_picture.h"

namespace sansmesh::test {

/// One opacity and one colour for all values; `length` in the unit of the data.
inline TransferFunction fog(double opacity, double length, const Vec3f& color = {1, 1, 1}) {
  TransferFunction f;
  f.colors = {{0, color}, {1, color}};
  f.opacities = {{0, opacity}, {1, opacity}};
  f.reference_length = length;
  return f;
}

/// A pinhole camera with one pixel: the ray from `from` along `direction`, both in coordinates of the picture.
inline Camera one_ray(const Vec3& from, const Vec3& direction) {
  Camera camera;
  camera.position = Vec3f(from);
  camera.backward = Vec3f(-normalized(direction));
  tangent_frame(camera.backward, camera.right, camera.up);
  camera.half_width = camera.half_height = 1e-4f;
  return camera;
}

inline VolumePictureOptions one_pixel(const TransferFunction& transfer) {
  VolumePictureOptions options;
  options.picture.view.width = options.picture.view.height = options.picture.quality.samples = 1;
  options.transfer = transfer;
  options.shading = false;
  options.least_light = 0;
  return options;
}

/// Light along a ray between two points of the world's unit cube, from well outside: red, green, blue, transmitted
/// share.
inline std::array<float, 4> along(const VolumeSubject& subject, const VolumePictureOptions& options, const Vec3& a,
                                  const Vec3& b) {
  Progress progress;
  const VolumePicture picture(subject, progress);
  const Vec3 d = normalized(b - a);
  const Vec3 from = (a - d * 2 - picture.frame().center) / picture.frame().size;
  return picture.light(one_ray(from, d), options, progress).at(0, 0);
}

}  // namespace sansmesh::test
