#include "sansmesh/point_set.h"

#include <string>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

template <class T>
void keep_unmarked(std::vector<T>& values, const std::vector<std::uint8_t>& mask) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (!mask[i]) values[kept++] = values[i];
  values.resize(kept);
}

template <class T>
std::vector<T> taken_rows(const std::vector<T>& values, std::span<const std::uint32_t> rows) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(rows.size());
  for (const std::uint32_t row : rows) result.push_back(values[row]);
  return result;
}

}  // namespace

PointSet take_samples(const PointSet& points, std::span<const std::uint32_t> rows) {
  PointSet result;
  result.origin = points.origin;
  result.reference = points.reference;
  result.positions = taken_rows(points.positions, rows);
  result.normals = taken_rows(points.normals, rows);
  result.colors = taken_rows(points.colors, rows);
  result.attributes = points.attributes.taken(rows);
  result.scan_of_point = taken_rows(points.scan_of_point, rows);
  result.scanners = points.scanners;
  result.scan_names = points.scan_names;
  result.grid_normals = taken_rows(points.grid_normals, rows);
  result.of_faces = points.of_faces;
  return result;
}

void remove_samples(PointSet& points, const std::vector<std::uint8_t>& mask) {
  if (mask.size() != points.size())
    throw ArgumentError("remove_samples: a mask of " + std::to_string(mask.size()) + " entries for " +
                        std::to_string(points.size()) + " samples");
  points.attributes.check_rows(points.size(), "samples");  // checks precede all changes
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

}  // namespace sansmesh::inline v1
