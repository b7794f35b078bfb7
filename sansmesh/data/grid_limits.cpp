#include "sansmesh/data/grid_limits.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/length_limits.h"

namespace sansmesh::inline v1 {
namespace {

/// Bounding box of a lattice, or of all finite points.
Box3 box_of(const GridBlock& block) {
  Box3 box = finite_bounds(block.points);
  if (block.kind == GridKind::lattice) box.extend(lattice_box(block));
  return box;
}

}  // namespace

Box3 lattice_box(const GridBlock& block) {
  Box3 box;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    Vec3 p = block.origin;
    for (std::size_t k = 0; k < 3; ++k)
      if (!block.axes[k].empty())
        p += block.directions[k] * (corner >> k & 1 ? block.axes[k].back() : block.axes[k].front());
    box.extend(p);
  }
  return box;
}

std::string out_of_limits(const GridData& data) {
  Box3 box;
  for (const GridBlock& block : data.blocks) box.extend(box_of(block));
  if (box.empty()) return {};
  const Vec3 size = box.size();
  const double extent = std::max({size.x, size.y, size.z});
  double farthest = 0;
  for (std::size_t k = 0; k < 3; ++k) farthest = std::max({farthest, std::abs(box.lower[k]), std::abs(box.upper[k])});
  if (!(farthest <= kLargestOfVolume))
    return fmt::format("reaches to {:.3g}, and coordinates up to {:g} are supported: write them in a larger unit",
                       farthest, kLargestOfVolume);
  if (extent > 0 && extent < kSmallestOfVolume)
    return fmt::format("extends over {:.3g} only, and {:g} is needed: write its coordinates in a smaller unit", extent,
                       kSmallestOfVolume);
  return {};
}

}  // namespace sansmesh::inline v1
