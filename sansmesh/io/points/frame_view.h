// Recovers the viewing side of scans stored in rows and columns.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// View of a scan in rows and columns.
struct FrameView {
  /// Unit normals of the grid on the visible side; zero at points without a complete cell around them.
  std::vector<Vec3f> normals;
  /// Whether the viewpoint is consistent with the frame: no part of it faces away.
  bool seen_from_eye = false;
};

/// Measures points stored row by row, `width` per row; non-finite points are absent. The visible side is that of the
/// viewpoint `eye`. If there is none or it is inconsistent with the frame, it is the side from which rows run from top
/// to bottom and columns from left to right, as in a picture. Empty if the points have no order, so that neither is
/// known.
std::optional<FrameView> measure_frame(std::span<const Vec3f> points, std::size_t width,
                                       const std::optional<Vec3f>& eye);

}  // namespace sansmesh::inline v1::io
