#include "sansmesh/data/point_set.h"

#include <algorithm>
#include <string>

#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

template <class T>
void keep_unmarked(std::vector<T>& values, const std::vector<std::uint8_t>& mask) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (!mask[i]) values[kept++] = values[i];
  values.resize(kept);
}

}  // namespace

void remove_samples(PointSet& points, const std::vector<std::uint8_t>& mask) {
  if (mask.size() != points.size())
    throw ArgumentError("remove_samples: a mask of " + std::to_string(mask.size()) + " entries for " +
                        std::to_string(points.size()) + " samples");
  points.attributes.check_rows(points.size(), "samples");  // before anything is changed
  points.triangle_attributes.check_rows(points.triangles.size(), "triangles");
  const auto touched = [&](const auto& t) { return mask[t[0]] || mask[t[1]] || mask[t[2]]; };
  if (!points.triangle_attributes.empty()) {
    std::vector<std::uint8_t> gone(points.triangles.size());
    for (std::size_t i = 0; i < gone.size(); ++i) gone[i] = touched(points.triangles[i]);
    points.triangle_attributes.remove_rows(gone);
  }
  std::erase_if(points.triangles, touched);
  if (!points.triangles.empty()) {
    std::vector<std::uint32_t> new_index(mask.size());
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) new_index[i] = mask[i] ? 0 : kept++;
    for (auto& t : points.triangles)
      for (std::uint32_t& corner : t) corner = new_index[corner];
  }
  keep_unmarked(points.normals, mask);
  keep_unmarked(points.colors, mask);
  points.attributes.remove_rows(mask);
  keep_unmarked(points.scan_of_point, mask);
  keep_unmarked(points.grid_normals, mask);
  keep_unmarked(points.positions, mask);
}

}  // namespace sansmesh
