#include "sansmesh/mesh_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/mesh_size.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kQualityChunk = 16384;
constexpr double kLargestAspect = 1e6;
constexpr double kSmallAngle = 10;
constexpr double kDegrees = 180 / std::numbers::pi;

struct QualitySums {
  double n = 0, aspect = 0, aspect_squares = 0, aspect_max = 0, angles = 0, angle_min = 180, small = 0, edges = 0;
};

void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, QualitySums& sums) {
  const double area = triangle_area(a, b, c);
  const double x = norm(b - a), y = norm(c - b), z = norm(a - c);
  if (!(area > 0) || !std::isfinite(area)) return;
  const double aspect = std::min(kLargestAspect, std::max({x, y, z}) * (x + y + z) / (4 * std::numbers::sqrt3 * area));
  // The smallest angle is opposite the shortest edge; the tangent is accurate where the cosine is flat.
  const double shortest = std::min({x, y, z});
  const Vec3 u = shortest == x ? a - c : shortest == y ? b - a : c - b;
  const Vec3 v = shortest == x ? b - c : shortest == y ? c - a : a - b;
  const double angle = std::atan2(2 * area, dot(u, v)) * kDegrees;
  sums.n += 1;
  sums.aspect += aspect;
  sums.aspect_squares += aspect * aspect;
  sums.aspect_max = std::max(sums.aspect_max, aspect);
  sums.angles += angle;
  sums.angle_min = std::min(sums.angle_min, angle);
  sums.small += angle < kSmallAngle;
  sums.edges += x + y + z;
}

QualitySums combine_quality(QualitySums a, const QualitySums& b) {
  a.n += b.n;
  a.aspect += b.aspect;
  a.aspect_squares += b.aspect_squares;
  a.aspect_max = std::max(a.aspect_max, b.aspect_max);
  a.angles += b.angles;
  a.angle_min = std::min(a.angle_min, b.angle_min);
  a.small += b.small;
  a.edges += b.edges;
  return a;
}

}  // namespace

MeshQuality measure_quality(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  const QualitySums sums = parallel_reduce(
      mesh.triangles.size(), kQualityChunk, QualitySums{},
      [&](std::size_t first, std::size_t last) {
        QualitySums part;
        for (std::size_t i = first; i < last; ++i) {
          const Triangle& t = mesh.triangles[i];
          if (t[0] >= n || t[1] >= n || t[2] >= n) continue;
          add_triangle(Vec3(mesh.vertices[t[0]]), Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]), part);
        }
        return part;
      },
      combine_quality);
  MeshQuality result;
  const MeshSize size = measure_size(mesh);
  result.area = size.area;
  result.volume = size.volume;
  result.triangles = static_cast<std::size_t>(sums.n);
  if (sums.n == 0) return result;
  result.aspect_mean = sums.aspect / sums.n;
  result.aspect_deviation =
      std::sqrt(std::max(0.0, sums.aspect_squares / sums.n - result.aspect_mean * result.aspect_mean));
  result.aspect_max = sums.aspect_max;
  result.smallest_angle_mean = sums.angles / sums.n;
  result.smallest_angle = sums.angle_min;
  result.small_angle_share = sums.small / sums.n;
  result.edge_mean = sums.edges / (3 * sums.n);
  return result;
}

namespace {

constexpr ReportRow kMeshQualityRows[] = {
    reported<&MeshQuality::aspect_mean>({.text = "Mean aspect ratio of the triangles: 1 for equilateral ones"}),
    reported<&MeshQuality::aspect_deviation>({.text = "Standard deviation of the aspect ratios"}),
    reported<&MeshQuality::aspect_max>({.text = "Largest aspect ratio"}),
    reported<&MeshQuality::smallest_angle_mean>(
        {.name = "smallest_angle_mean_deg", .text = "Mean of the triangles' smallest angles", .unit = "degrees"}),
    reported<&MeshQuality::smallest_angle>(
        {.name = "smallest_angle_deg", .text = "Smallest angle of all", .unit = "degrees"}),
    reported<&MeshQuality::small_angle_share>(
        {.name = "below_10_deg", .text = "Share of the triangles with an angle below 10°", .unit = "share"}),
    reported<&MeshQuality::edge_mean>({.text = "Mean length of the edges", .unit = "length"}),
    reported<&MeshQuality::area>({.text = "Area", .unit = "length²"})};

}  // namespace

const ReportSchema& MeshQuality::schema() {
  static constexpr ReportSchema schema{kMeshQualityRows};
  return schema;
}

}  // namespace sansmesh::inline v1
