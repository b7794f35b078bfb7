// What rows and columns of points tell: the side from which they were seen.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Of points in rows and columns.
struct FrameView {
  /// Unit normals of the grid, on the side from which it was seen; zero where it has no point on either side.
  std::vector<Vec3f> normals;
  /// Whether the frame can have been seen from its viewpoint: then nothing in it is the wrong way round.
  bool seen_from_eye = false;
};

/// Of points that follow row by row, `width` in each; those that are not finite are not there. The side is that of the
/// viewpoint `eye`, or, where there is none or the frame cannot have been seen from there, the one from which rows run
/// from top to bottom and columns from left to right, as in a picture. Nothing where the points are in no order, so
/// that neither tells anything.
std::optional<FrameView> measure_frame(std::span<const Vec3f> points, std::size_t width,
                                       const std::optional<Vec3f>& eye);

}  // namespace sansmesh::inline v1::io
