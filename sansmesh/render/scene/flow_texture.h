// Line integral convolution on whatever a picture shows (METHODS §5.2): streaks that run along a flow.
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

/// The texture of one picture: a solid noise around the surface is summed along the flow, for each pixel and each layer
/// that is seen there. Steps are as long as a pixel is wide, in space; each leads to the pixel that it is seen in, as
/// long as this shows the same sheet, and on by the vector that the scene has there. (So the flow elsewhere in space
/// does not count, and of unsteady flows each place goes by the vector of its own time.) The same numbers for any
/// number of threads.
class FlowTexture {
 public:
  /// `camera` in the coordinates of the scene. Casts a ray through the middle of each pixel. `keep`: first_point() will
  /// be asked.
  FlowTexture(const PictureScene& scene, const Camera& camera, int width, int height, bool keep = false);

  /// Makes the texture; another phase costs no rays. Throws ArgumentError for bad options.
  void convolve(const FlowTextureOptions& options);

  /// What the light of a point that the scene found along a ray of the camera is multiplied by: 1 on average and where
  /// nothing flows.
  float factor(const Vec3f& origin, const Vec3f& direction, const SurfacePoint& point) const;
  /// What the scene showed in the middle of the pixel that a ray of the camera goes through, its colour times the
  /// factor.
  std::optional<SurfacePoint> first_point(const Vec3f& origin, const Vec3f& direction) const;

 private:
  /// A sheet in a pixel.
  struct Entry {
    float du = 0, dv = 0;  // a step along the flow: pixels to the right and down; both 0 where nothing flows
    float depth = 0;       // from the camera, along its axis
    float noise = 0;       // mean 0, variance 1
  };
  /// Pixels are numbered in blocks, in which neighbours are near each other.
  std::size_t slot(int x, int y) const;
  std::size_t slot(const Vec3f& origin, const Vec3f& direction) const;
  const Entry* nearest(std::size_t slot, float depth) const;
  Entry entry(const SurfacePoint& point, const Vec3f& place) const;
  void grain(double pixels);
  float sum(int x, int y, const Entry& from) const;

  Camera camera_;
  int width_, height_, across_;  // blocks in a row
  float footprint_;              // of a pixel at depth 1
  std::vector<std::uint32_t> first_;
  std::vector<Entry> entries_;  // of slot i first_[i] up to first_[i + 1], front to back
  std::vector<Vec3f> places_;
  std::vector<float> factors_;
  std::vector<SurfacePoint> points_;  // if kept
  std::vector<float> kernel_;         // weights of steps, from the last against the flow to the last along it
  double grain_ = 0;
};

}  // namespace sansmesh::inline v1
