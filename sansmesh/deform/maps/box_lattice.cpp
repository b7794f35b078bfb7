#include "sansmesh/deform/maps/box_lattice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

void BoxLattice::validate(const char* user) const {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(box.upper[k] > box.lower[k]) || !std::isfinite(box.upper[k] - box.lower[k]))
      throw ArgumentError(fmt::format("{} needs a box with a size along axis {}", user, k + 1));
    if (sizes[k] < 2 || sizes[k] > 4096)
      throw ArgumentError(fmt::format("{} needs 2 to 4096 points along each axis, not {}", user, sizes[k]));
  }
}

GridBlock BoxLattice::grid() const {
  GridBlock block;
  block.kind = GridKind::lattice;
  block.origin = box.lower;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < sizes[k]; ++i) block.axes[k].push_back(spacing[k] * static_cast<double>(i));
  return block;
}

BoxLattice::Index lattice_sizes(const Box3& box, std::size_t longest) {
  const Vec3 size = box.size();
  const double most = std::max({size.x, size.y, size.z});
  BoxLattice::Index sizes{2, 2, 2};
  for (std::size_t k = 0; k < 3 && most > 0; ++k)
    sizes[k] = std::max<std::size_t>(
        2, index_in<std::size_t>(std::round(static_cast<double>(longest - 1) * size[k] / most), 0, longest - 1) + 1);
  return sizes;
}

}  // namespace sansmesh::inline v1
