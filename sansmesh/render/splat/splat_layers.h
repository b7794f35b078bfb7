// Rasterises elliptical splats to the visible layers of each pixel.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Surface points, each a Gaussian on its tangent plane, in coordinates of the picture. Arrays have the same length.
struct EllipticSplats {
  std::vector<Vec3f> centers, normals;  ///< unit normals
  std::vector<Vec3f> major, minor;      ///< tangential, perpendicular, with the lengths of the standard deviations
  std::vector<float> areas;             ///< surface area of each splat
  std::vector<Vec3f> colors;            ///< linear light
  bool closed = false;                  ///< they bound a body, so that unclipped back sides are never visible
};

/// A sheet of the surface in a pixel.
struct SplatLayer {
  float distance = 0;  ///< along the ray through the pixel's centre
  float share = 0;     ///< visible share of the pixel: not hidden by layers in front
  Vec3f normal;        ///< unit, on the viewer's side
  Vec3f color;         ///< linear light
  float width = 0;     ///< standard deviation of the splats
};

struct SplatRasterOptions {
  int width = 0, height = 0;  ///< size of the picture, pixels
  int rim = 0;                ///< extra pixels beyond its borders on each side
  float filter = 0.5f;        ///< standard deviation of the pixel filter, pixels
  std::optional<Box3f> clip;  ///< only the part inside this box
};

/// Surface splatting (Zwicker et al. 2001) with crisp borders. Weights are normalised by area and sum to about 1 on a
/// sheet at any distance. At the border of a sheet this sum and its slope determine the covered share of the pixel.
/// Sheets behind fill the rest, so that borders in front of other sheets are as crisp.
class SplatLayers {
 public:
  /// Works on tiles in parallel; does not depend on the number of threads.
  SplatLayers(const EllipticSplats& splats, const Camera& camera, const SplatRasterOptions& options);
  /// Layers from front to back. Pixels of the rim have negative coordinates or coordinates beyond the picture.
  std::span<const SplatLayer> at(int x, int y) const;

 private:
  int left_ = 0, top_ = 0, width_ = 0, height_ = 0;
  std::vector<std::size_t> first_;
  std::vector<SplatLayer> layers_;
};

}  // namespace sansmesh::inline v1
