#include "sansmesh/points/normals/sensor_directions.h"

#include <algorithm>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/normals/flight_lines.h"
#include "sansmesh/points/shape/height_field.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<Vec3f> directions_to_scanners(const PointSet& points) {
  if (points.scanners.empty() || points.scan_of_point.size() != points.size()) return {};
  const auto known = [&](std::uint16_t scan) { return scan < points.scanners.size(); };
  if (std::none_of(points.scan_of_point.begin(), points.scan_of_point.end(), known)) return {};
  std::vector<Vec3f> directions(points.size());
  parallel_for(0, points.size(), 1 << 14, [&](std::size_t i) {
    const std::uint16_t scan = points.scan_of_point[i];
    if (known(scan)) directions[i] = normalized(points.scanners[scan] - points.positions[i]);
  });
  return directions;
}

}  // namespace

std::string_view orientation_words(OrientBy by) {
  switch (by) {
    case OrientBy::automatic:
      return "by the best known source";
    case OrientBy::scanner:
      return "by scanner position";
    case OrientBy::rows:
      return "by rows and columns";
    case OrientBy::flight:
      return "by flight lines";
    case OrientBy::up:
      return "upward, as terrain";
    case OrientBy::propagation:
      return "by propagation";
  }
  return "";
}

std::vector<Vec3f> find_sensor_directions(const PointSet& points, OrientBy by) {
  switch (by) {
    case OrientBy::scanner:
      return directions_to_scanners(points);
    case OrientBy::rows:
      return points.grid_normals.size() == points.size() ? points.grid_normals : std::vector<Vec3f>{};
    case OrientBy::flight:
      return directions_to_flight(points);
    case OrientBy::up:
      return std::vector<Vec3f>(points.size(), Vec3f{0, 0, 1});
    case OrientBy::automatic:
    case OrientBy::propagation:
      break;
  }
  return {};
}

std::vector<Vec3f> find_own_sensor_directions(const PointSet& points, OrientBy by, double noise) {
  if (by == OrientBy::up && !is_height_field(measure_height_field(points, noise), is_survey_from_above(points)))
    return {};
  return find_sensor_directions(points, by);
}

OrientBy first_known_orientation(const PointSet& points, double noise) {
  for (const OrientBy by : kOrientationOrder)
    if (!find_own_sensor_directions(points, by, noise).empty()) return by;
  return OrientBy::propagation;
}

}  // namespace sansmesh::inline v1
