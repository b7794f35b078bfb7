// Mean light of pixels from few rays: a quadtree over the picture, whose cells share the rays at their corners.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>

#include "sansmesh/image.h"
#include "sansmesh/render/volume/volume_tracer.h"

namespace sansmesh::inline v1 {

/// Traces the rays through points {x, y} of a picture, in pixels from its upper left corner.
using TracePoints = std::function<void(std::span<const std::array<float, 2>> points, std::span<TracedLight> lights)>;

/// Pixels of a picture: left <= x < right, top <= y < bottom.
struct PixelTile {
  int left = 0, top = 0, right = 0, bottom = 0;
};

struct PixelMeanOptions {
  /// Rays per pixel and direction: pixels where the picture is not smooth get at least 0.8 samples² rays. With 1 each
  /// pixel has the ray through its centre only.
  int samples = 3;
  /// Estimated error of a pixel's mean in levels of 255 above which it is divided; 0: all are divided.
  double error = 0.4;
};

/// Writes the mean light and the transmitted share of the light from behind for each pixel of a tile. A cell has rays
/// at its corners and at its centre, one of 2 × 2 pixels also at the middles of its edges, and so two estimates of its
/// mean, whose difference is three times the error of the better one. Cells of 2 × 2 pixels are divided into pixels,
/// and these into parts, where the difference is too large, and 2 × 2 pixels also where a neighbour shows details that
/// were missed by its own first rays. Results depend only on the tile. Returns the number of rays.
std::size_t pixel_means(const PixelTile& tile, const PixelMeanOptions& options, const TracePoints& trace,
                        PixelMap<std::array<float, 4>>& map);

/// Largest difference of a channel, in levels of 255, on a background of medium lightness.
float seen_difference(const std::array<float, 4>& a, const std::array<float, 4>& b);

}  // namespace sansmesh::inline v1
