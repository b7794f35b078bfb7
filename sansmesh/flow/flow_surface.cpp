#include "sansmesh/flow/flow_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/flow/flow_fronts.h"
#include "sansmesh/flow/released_sheet.h"
#include "sansmesh/mesh/repair/components.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kUsualSeeds = 256;
constexpr double kMostDiagonals = 5;  // default length of a surface without another end

bool is_nothing_beside(double start, double duration) { return start + duration == start || start - duration == start; }

[[noreturn]] void throw_that_moments_meet(double start, double duration) {
  if (is_nothing_beside(start, duration))
    throw ArgumentError(
        fmt::format("`duration` ({:g}) is too short for the magnitude of `start` ({:g})", duration, start));
  throw ArgumentError(
      std::isfinite(duration)
          ? fmt::format(
                "`duration` ({:g}) is so short for the magnitude of `start` ({:g}) that moments of fronts coincide",
                duration, start)
          : fmt::format("`start` ({:g}) is so large that the moments of a surface coincide", start));
}

bool is_released(FlowSurfaceKind kind) { return kind == FlowSurfaceKind::streak || kind == FlowSurfaceKind::time; }

/// A flow frozen at one moment.
class FlowAtOneMoment final : public VectorField {
 public:
  FlowAtOneMoment(const VectorField& field, double moment) : field_(field), moment_(moment) {}
  Box3 bounds() const override { return field_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian) const override {
    field_.evaluate(x, std::vector<double>(t.size(), moment_), vectors, inside, jacobian);
  }

 private:
  const VectorField& field_;
  double moment_;
};

/// Removes points without a triangle; missing normals are computed from the triangles, weighted by area.
void tidy_sheet(FlowSheet& sheet) {
  std::vector<std::uint32_t> number(sheet.points.size(), 0);
  std::vector<Vec3> normals(sheet.points.size());
  for (const Triangle& t : sheet.triangles) {
    const Vec3 &a = sheet.points[t[0]].position, &b = sheet.points[t[1]].position, &c = sheet.points[t[2]].position;
    const Vec3 normal = cross(b - a, c - a);
    for (const std::uint32_t v : t) number[v] = 1, normals[v] += normal;
  }
  std::size_t kept = 0;
  for (std::size_t v = 0; v < sheet.points.size(); ++v) {
    if (number[v] == 0) continue;
    FlowPoint& point = sheet.points[v];
    if (point.normal == Vec3{}) point.normal = normalized(normals[v]);
    number[v] = static_cast<std::uint32_t>(kept);
    sheet.points[kept++] = point;
  }
  sheet.points.resize(kept);
  for (Triangle& t : sheet.triangles)
    for (std::uint32_t& v : t) v = number[v];
}

TriangleMesh mesh_of(const FlowSheet& sheet) {
  const std::size_t n = sheet.points.size();
  TriangleMesh mesh;
  Box3 box;
  for (const FlowPoint& p : sheet.points) box.extend(p.position);
  mesh.origin = box.center();
  mesh.vertices.resize(n), mesh.normals.resize(n);
  std::vector<double> s(n), time(n);
  std::vector<float> speed(n);
  std::vector<std::int32_t> front(n);
  for (std::size_t i = 0; i < n; ++i) {
    const FlowPoint& p = sheet.points[i];
    mesh.vertices[i] = Vec3f(p.position - mesh.origin);
    mesh.normals[i] = Vec3f(p.normal);
    s[i] = p.s, time[i] = p.t, speed[i] = static_cast<float>(norm(p.velocity)), front[i] = p.front;
  }
  mesh.triangles = sheet.triangles;
  mesh.attributes.set("s", std::move(s));
  mesh.attributes.set("time", std::move(time));
  mesh.attributes.set("speed", std::move(speed));
  mesh.attributes.set("front", std::move(front));
  return mesh;
}

/// Duplicates vertices and points shared by several fans of triangles.
void separate_fans_of(FlowSurface& surface) {
  std::vector<std::uint32_t> number(surface.points.size());
  std::iota(number.begin(), number.end(), 0u);
  surface.mesh.attributes.set("point", std::move(number));
  separate_fans(surface.mesh);
  std::vector<FlowPoint> points;
  for (const std::uint32_t i : *surface.mesh.attributes.find<std::uint32_t>("point"))
    points.push_back(surface.points[i]);
  surface.points = std::move(points);
  surface.mesh.attributes.erase("point");
}

}  // namespace

FlowSurface flow_surface(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress) {
  options.validate();
  curve.validate();
  FlowSurfaceOptions known = options;
  known.seeds = options.seeds.value_or(kUsualSeeds);
  if (curve.closed && *known.seeds < 3) throw ArgumentError("`particles` on a closed curve must be at least 3");
  const FlowSurfaceKind kind = options.kind.value_or(FlowSurfaceKind::stream);
  known.kind = kind;
  double& duration = known.duration.emplace(options.duration.value_or(std::numeric_limits<double>::infinity()));
  const bool backward = options.direction == FlowDirection::backward;
  const TimeRange times = field.times();
  if (!known.start) {
    const double first = backward ? times.last : times.first;
    known.start = std::isfinite(first) ? first : 0;
  }
  if (!times.contains(*known.start)) throw ArgumentError("`start` must lie in the times of the flow");
  if (is_nothing_beside(*known.start, duration)) throw_that_moments_meet(*known.start, duration);
  FlowSurface surface;
  FlowSheet sheet;
  const auto end_somewhere = [&] {
    if (!known.length && !std::isfinite(duration)) known.length = kMostDiagonals * field.bounds().diagonal();
  };
  if (kind == FlowSurfaceKind::stream) {
    end_somewhere();
    const FlowAtOneMoment steady(field, *known.start);
    sheet = advance_fronts(steady, curve, known, progress);
  } else {
    const double later = times.last - *known.start, earlier = *known.start - times.first;
    const double left = options.direction == FlowDirection::both ? std::max(later, earlier)
                        : backward                               ? earlier
                                                                 : later;
    if (!(left > 0)) throw DataError("the flow has no moment beside `start`: only stream surfaces are possible");
    duration = std::min(duration, left);
    if (is_released(kind) && !std::isfinite(duration))
      throw ArgumentError("streak and time surfaces need a `duration`");
    if (!is_released(kind)) end_somewhere();
    sheet = is_released(kind) ? released_sheet(field, curve, known, progress)
                              : advance_fronts(field, curve, known, progress);
  }
  if (sheet.report.moments_meet && (sheet.triangles.empty() || is_released(kind)))
    throw_that_moments_meet(*known.start, duration);
  if (sheet.triangles.empty()) throw DataError("there is no surface: particles end or separate at once");
  tidy_sheet(sheet);
  surface.report = sheet.report;
  surface.mesh = mesh_of(sheet);
  surface.points = std::move(sheet.points);
  // Only torn sheets, and fronts that tear differently in both directions, have such vertices.
  if (is_released(kind) || options.direction == FlowDirection::both) separate_fans_of(surface);
  return surface;
}

}  // namespace sansmesh::inline v1
