// Line integral convolution on the surfaces of a picture (tejada2008, 5.3): streaks along a flow.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/option.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Flow texture of one picture: for each pixel and each sheet visible there, a solid noise is summed along the flow.
/// Steps in space have the width of a pixel. Each step leads to the pixel where its end is visible, if that pixel shows
/// the same sheet, and continues with the scene's vector there. (So the flow elsewhere in space has no effect, and in
/// unsteady flows each point uses the vector of its own time.) The result does not depend on the number of threads.
class FlowTexture {
 public:
  /// `camera` in the coordinates of the scene. Casts a ray through the centre of each pixel. `keep`: keeps the data for
  /// first_point().
  FlowTexture(const PictureScene& scene, const Camera& camera, int width, int height, bool keep = false);

  /// Computes the texture; another phase needs no new rays. Throws ArgumentError for bad options.
  void convolve(const FlowTextureOptions& options);

  /// Factor for the light of a point that the scene found along a ray of the camera: 1 on average and where there is no
  /// flow.
  float factor(const Vec3f& origin, const Vec3f& direction, const SurfacePoint& point) const;
  /// The scene's point at the centre of the pixel that a ray of the camera hits; its colour is multiplied by the
  /// factor.
  std::optional<SurfacePoint> first_point(const Vec3f& origin, const Vec3f& direction) const;

 private:
  /// A sheet in a pixel.
  struct Entry {
    float du = 0, dv = 0;  // a step along the flow: pixels to the right and down; both 0 without flow
    float depth = 0;       // from the camera, along its axis
    float noise = 0;       // mean 0, variance 1
  };
  /// Index of a pixel; pixels are numbered in blocks for locality.
  std::size_t slot(int x, int y) const;
  std::size_t slot(const Vec3f& origin, const Vec3f& direction) const;
  const Entry* nearest(std::size_t slot, float depth) const;
  Entry entry(const SurfacePoint& point, const Vec3f& position) const;
  void grain(double pixels);
  float sum(int x, int y, const Entry& from) const;

  Camera camera_;
  int width_, height_, across_;  // blocks in a row
  float footprint_;              // width of a pixel at depth 1
  std::vector<std::uint32_t> first_;
  std::vector<Entry> entries_;  // front to back; slot i has entries first_[i] to first_[i + 1]
  std::vector<Vec3f> positions_;
  std::vector<float> factors_;
  std::vector<SurfacePoint> points_;  // only with `keep`
  std::vector<float> kernel_;         // weights of steps, from the last against the flow to the last along it
  double grain_ = 0;
};

}  // namespace sansmesh::inline v1
