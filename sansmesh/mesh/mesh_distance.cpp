#include "sansmesh/mesh/mesh_distance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kDistanceChunk = 2048;  // samples per chain of hints: fixed, for reproducibility

struct Samples {
  std::vector<Vec3> positions;  ///< relative to the mesh's origin
  std::vector<Vec3f> normals;   ///< empty if unknown
};

Samples sample_mesh(const TriangleMesh& mesh, std::size_t count) {
  Samples samples;
  for (const FaceSample& s : sample_triangles(mesh.vertices, mesh.triangles, count)) {
    samples.positions.push_back(s.position);
    samples.normals.push_back(s.normal);
  }
  return samples;
}

Samples all_points(const TriangleMesh& points) {
  Samples samples;
  for (std::size_t i = 0; i < points.vertices.size(); ++i) {
    if (!is_finite(points.vertices[i])) continue;
    samples.positions.emplace_back(points.vertices[i]);
    if (!points.normals.empty()) samples.normals.push_back(points.normals[i]);
  }
  return samples;
}

std::vector<Vec3> used_vertices(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    if (has_valid_corners(mesh.vertices, t)) used[t[0]] = used[t[1]] = used[t[2]] = 1;
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) result.emplace_back(mesh.vertices[i]);
  return result;
}

/// Search structure of one side: triangles, or points if there are none.
class Target {
 public:
  explicit Target(const TriangleMesh& mesh) : mesh_(mesh), triangles_(mesh) {
    if (triangles_.empty()) points_ = std::make_unique<KdTree>(mesh.vertices);
  }
  bool empty() const { return points_ && points_->size() == 0; }
  bool is_points() const { return points_ != nullptr; }
  bool has_normals() const { return !points_ || !mesh_.normals.empty(); }

  struct Answer {
    double distance = 0;
    Vec3f normal;
  };
  Answer ask(const Vec3& p, bool want_normal, ClosestTriangle::Hit& hint) const {
    if (points_) {
      const auto found = points_->nearest(Vec3f(p));
      if (!found) return {};
      const Vec3 d = p - Vec3(mesh_.vertices[found->index]);
      return {norm(d), want_normal ? normalized(mesh_.normals[found->index]) : Vec3f{}};
    }
    hint = triangles_.closest(p, hint);
    const double distance = std::sqrt(hint.squared_distance);
    if (!want_normal || hint.triangle == ClosestTriangle::kNone) return {distance, {}};
    return {distance, Vec3f(normalized(doubled_area(mesh_.vertices, mesh_.triangles[hint.triangle])))};
  }

 private:
  const TriangleMesh& mesh_;
  ClosestTriangle triangles_;
  std::unique_ptr<KdTree> points_;
};

struct DistanceSums {
  double sum = 0, squares = 0, max = 0, angles = 0, signed_angles = 0, with_normal = 0;
};

DistanceSums combine_distances(DistanceSums a, const DistanceSums& b) {
  return {a.sum + b.sum,
          a.squares + b.squares,
          std::max(a.max, b.max),
          a.angles + b.angles,
          a.signed_angles + b.signed_angles,
          a.with_normal + b.with_normal};
}

void add_angle(const Vec3f& a, const Vec3f& b, DistanceSums& sums) {
  const double c = std::clamp(static_cast<double>(dot(a, b)), -1.0, 1.0);
  if (squared_norm(a) == 0 || squared_norm(b) == 0 || std::isnan(c)) return;
  // The sine is accurate for small angles: the arc cosine of a float near 1 is accurate only to a hundredth of a
  // degree.
  const double s = norm(cross(Vec3(a), Vec3(b)));
  sums.signed_angles += std::atan2(s, c);
  sums.angles += std::atan2(s, std::abs(c));
  sums.with_normal += 1;
}

OneWayDistance measure(const Samples& samples, const std::vector<Vec3>& vertices, const Vec3& shift,
                       const Target& target, Progress& progress) {
  OneWayDistance result;
  const std::size_t n = samples.positions.size();
  result.samples = n;
  if (n == 0) return result;
  const bool normals = !samples.normals.empty() && target.has_normals();
  std::vector<double> distances(n);
  const DistanceSums sums = parallel_reduce(
      n, kDistanceChunk, DistanceSums{},
      [&](std::size_t first, std::size_t last) {
        DistanceSums part;
        ClosestTriangle::Hit hint;
        for (std::size_t i = first; i < last; ++i) {
          const auto [distance, normal] = target.ask(samples.positions[i] + shift, normals, hint);
          distances[i] = distance;
          part.sum += distance;
          part.squares += distance * distance;
          part.max = std::max(part.max, distance);
          if (normals) add_angle(samples.normals[i], normal, part);
        }
        progress.advance(last - first);
        return part;
      },
      combine_distances);
  const double farthest = parallel_reduce(
      vertices.size(), kDistanceChunk, 0.0,
      [&](std::size_t first, std::size_t last) {
        double max = 0;
        ClosestTriangle::Hit hint;
        for (std::size_t i = first; i < last; ++i)
          max = std::max(max, target.ask(vertices[i] + shift, false, hint).distance);
        progress.advance(last - first);
        return max;
      },
      [](double a, double b) { return std::max(a, b); });
  const auto count = static_cast<double>(n);
  result.mean = sums.sum / count;
  result.rms = std::sqrt(sums.squares / count);
  result.max = std::max(sums.max, farthest);
  result.p95 = nth_smallest(distances, static_cast<std::size_t>(static_cast<double>(n) * 0.95));
  if (normals && sums.with_normal > 0) {
    result.angle = sums.angles / sums.with_normal * 180 / std::numbers::pi;
    result.signed_angle = sums.signed_angles / sums.with_normal * 180 / std::numbers::pi;
  }
  return result;
}

struct Side {
  Target target;
  Samples samples;
  std::vector<Vec3> vertices;  ///< used only for the maximum
};

Side prepare(const TriangleMesh& mesh, const DistanceOptions& options, const char* name) {
  Side side{Target(mesh), {}, {}};
  if (side.target.empty()) throw DataError(std::string("the ") + name + " has no finite points");
  if (!side.target.is_points()) {
    side.samples = sample_mesh(mesh, options.samples);
    side.vertices = used_vertices(mesh);
  }
  if (!side.samples.positions.empty()) return side;
  // Points, or only triangles without area.
  side.samples = side.target.is_points() ? all_points(mesh) : Samples{std::move(side.vertices), {}};
  side.vertices.clear();
  return side;
}

}  // namespace

void DistanceOptions::validate() const {
  if (samples < 1 || samples > (std::size_t{1} << 31))
    throw ArgumentError("`samples` must lie in 1.." + std::to_string(std::size_t{1} << 31));
}

SurfaceDistance measure_distance(const TriangleMesh& surface, const TriangleMesh& reference,
                                 const DistanceOptions& options, Progress& progress) {
  options.validate();
  progress.begin("prepare distances");
  const Side a = prepare(surface, options, "surface"), b = prepare(reference, options, "reference");

  SurfaceDistance result;
  Box3f box;  // box of used vertices only
  for (const auto* list : {&b.samples.positions, &b.vertices})
    for (const Vec3& p : *list) box.extend(Vec3f(p));
  result.diagonal = norm(Vec3(box.size()));

  const Vec3 shift = surface.origin - reference.origin;
  const auto work = [](const Side& side) { return side.samples.positions.size() + side.vertices.size(); };
  progress.begin("distances to the reference", work(a));
  result.to_reference = measure(a.samples, a.vertices, shift, b.target, progress);
  progress.begin("distances from the reference", work(b));
  result.from_reference = measure(b.samples, b.vertices, -shift, a.target, progress);
  progress.finish();
  return result;
}

namespace {

constexpr ReportRow kOneWayDistanceRows[] = {
    reported<&OneWayDistance::samples>({.text = "Number of measured samples"}),
    reported<&OneWayDistance::mean>({.text = "Mean distance", .unit = "length"}),
    reported<&OneWayDistance::rms>({.text = "Root mean square of the distances", .unit = "length"}),
    reported<&OneWayDistance::p95>({.text = "95 % quantile of the distances", .unit = "length"}),
    reported<&OneWayDistance::max>({.text = "Largest distance", .unit = "length"}),
    reported<&OneWayDistance::angle>(
        {.name = "angle_deg", .text = "Mean angle between the planes of normals, 0..90", .unit = "degrees"}),
    reported<&OneWayDistance::signed_angle>(
        {.name = "signed_angle_deg", .text = "Mean angle between normals, 0..180", .unit = "degrees"})};

}  // namespace

const ReportSchema& OneWayDistance::schema() {
  static constexpr ReportSchema schema{kOneWayDistanceRows};
  return schema;
}

std::string distance_words(const OneWayDistance& d, const SurfaceDistance& both) {
  const auto percent = [&](double x) { return fmt::format("{} ({:.4f} %)", length_words(x), both.percent(x)); };
  return fmt::format("mean {}, rms {}, 95 % below {}, max {}{}", percent(d.mean), percent(d.rms), percent(d.p95),
                     percent(d.max), d.angle ? fmt::format(", normals {:.2f}° off", *d.angle) : "");
}

}  // namespace sansmesh::inline v1
