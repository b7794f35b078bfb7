// Elliptical splats, rasterised into what each pixel of a picture sees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Points of a surface, each a Gaussian on its tangent plane, in coordinates of the picture. Arrays have the same
/// length.
struct EllipticSplats {
  std::vector<Vec3f> centers, normals;  ///< unit
  std::vector<Vec3f> major, minor;      ///< tangential, at right angles, as long as the standard deviations
  std::vector<float> areas;             ///< of the surface that each stands for
  std::vector<Vec3f> colors;            ///< linear light
  bool closed = false;                  ///< they bound a body: nothing of it is ever seen from behind, unless clipped
};

/// A sheet of the surface in a pixel.
struct SplatLayer {
  float distance = 0;  ///< along the ray through the pixel's middle
  float share = 0;     ///< of the pixel, what lies in front of it left out
  Vec3f normal;        ///< unit, on the viewer's side
  Vec3f color;         ///< linear light
  float width = 0;     ///< standard deviation of the splats
};

struct SplatRasterOptions {
  int width = 0, height = 0;  ///< of the picture, pixels
  int rim = 0;                ///< pixels beyond its borders on each side
  float filter = 0.5f;        ///< standard deviation of what a pixel is the mean of, pixels
  std::optional<Box3f> clip;  ///< only what lies in this box
};

/// Surface splatting (Zwicker et al. 2001) with crisp borders. Weights are normalised by the areas, so that they sum up
/// to about 1 all over a sheet, seen from near or far, and where the sheet ends, that sum and its slope tell how much
/// of the pixel it covers. Sheets behind fill what is left, so that borders in front of something are no worse than
/// others.
class SplatLayers {
 public:
  /// In tiles, in parallel; does not depend on the number of threads.
  SplatLayers(const EllipticSplats& splats, const Camera& camera, const SplatRasterOptions& options);
  /// Front to back; pixels of the rim have negative coordinates, or such beyond the picture.
  std::span<const SplatLayer> at(int x, int y) const;

 private:
  int left_ = 0, top_ = 0, width_ = 0, height_ = 0;
  std::vector<std::size_t> first_;
  std::vector<SplatLayer> layers_;
};

}  // namespace sansmesh::inline v1
