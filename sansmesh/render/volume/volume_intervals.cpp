#include "sansmesh/render/volume/volume_intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

constexpr double kSame = 2e-6;  // crossings closer than this, in diagonals, may be one

Vec3 to_world(const PictureFrame& frame, const VolumeRay& ray, double t) {
  return frame.center + (ray.origin + ray.direction * t) * frame.size;
}

RayInterval in_box(const VolumeRay& ray, const Vec3& lower, const Vec3& upper) {
  RayInterval s{0, std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < 3; ++k) {
    double a = (lower[k] - ray.origin[k]) / ray.direction[k], b = (upper[k] - ray.origin[k]) / ray.direction[k];
    if (ray.direction[k] == 0) {
      if (ray.origin[k] < lower[k] || ray.origin[k] > upper[k]) return {0, 0};
      continue;
    }
    if (a > b) std::swap(a, b);
    s.begin = std::max(s.begin, a), s.end = std::min(s.end, b);
  }
  return s.end > s.begin ? s : RayInterval{0, 0};
}

/// Removes the part between two distances from a interval.
void take_away(const RayInterval& s, double from, double to, std::vector<RayInterval>& left) {
  if (to <= s.begin || from >= s.end) {
    left.push_back(s);
    return;
  }
  if (from > s.begin) left.push_back({s.begin, from, s.begins_at_cut, true});
  if (to < s.end) left.push_back({to, s.end, true, s.ends_at_cut});
}

}  // namespace

VolumeIntervals::VolumeIntervals(const VolumeField& field, const TriangleMesh* boundary, const PictureFrame& frame)
    : field_(field), frame_(frame) {
  const Box3 box = field.bounds();
  lower_ = (box.lower - frame.center) / frame.size, upper_ = (box.upper - frame.center) / frame.size;
  if (!boundary || boundary->triangles.empty()) return;
  std::vector<Vec3f> vertices(boundary->vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    vertices[v] = frame.to_picture(boundary->origin + Vec3(boundary->vertices[v]));
  boundary_ = RayScene::triangles(vertices, boundary->triangles);
}

void VolumeIntervals::between_crossings(std::span<const VolumeRay> rays,
                                        std::vector<std::vector<RayInterval>>& found) const {
  struct Doubt {
    std::size_t ray;
    RayInterval piece;
  };
  std::vector<Doubt> doubts;
  std::vector<RayCrossing> hits;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    boundary_->crossings(Vec3f(rays[i].origin), Vec3f(rays[i].direction), std::numeric_limits<float>::infinity(), hits);
    // Triangles with a common edge or corner may each report it.
    std::vector<RayCrossing> crossings;
    for (const RayCrossing& hit : hits)
      if (crossings.empty() || crossings.back().entering != hit.entering ||
          static_cast<double>(hit.distance - crossings.back().distance) > kSame)
        crossings.push_back(hit);
    if (crossings.empty()) continue;
    int depth = crossings.front().entering ? 0 : 1;  // the eye may be inside
    bool sound = true;
    double begin = 0;
    std::vector<RayInterval>& own = found[i];
    for (const RayCrossing& c : crossings) {
      const double t = static_cast<double>(c.distance);
      if (c.entering) {
        if (depth++ == 0) begin = t;
      } else if (--depth == 0) {
        if (t > begin) own.push_back({begin, t});
      } else if (depth < 0) {
        sound = false;
      }
    }
    if (sound && depth == 0) continue;
    own.clear();
    double last = 0;
    for (const RayCrossing& c : crossings) {
      const double t = static_cast<double>(c.distance);
      if (t - last > kSame) doubts.push_back({i, {last, t}});
      last = t;
    }
  }
  if (doubts.empty()) return;
  std::vector<Vec3> middles;
  middles.reserve(doubts.size());
  std::vector<std::uint8_t> inside(doubts.size());
  for (const Doubt& d : doubts) middles.push_back(to_world(frame_, rays[d.ray], 0.5 * (d.piece.begin + d.piece.end)));
  field_.evaluate(middles, {{}, {}, inside});
  for (std::size_t k = 0; k < doubts.size(); ++k)
    if (inside[k]) found[doubts[k].ray].push_back(doubts[k].piece);
}

void VolumeIntervals::find(std::span<const VolumeRay> rays, std::span<const VolumeCut> cuts,
                           std::vector<RayInterval>& intervals, std::vector<std::uint32_t>& first) const {
  intervals.clear();
  first.assign(1, 0);
  std::vector<std::vector<RayInterval>> found(rays.size());
  if (boundary_) {
    between_crossings(rays, found);
  } else {
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (const RayInterval s = in_box(rays[i], lower_, upper_); s.end > s.begin) found[i].push_back(s);
  }
  std::vector<RayInterval> left;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    std::vector<RayInterval>& own = found[i];
    for (const VolumeCut& cut : cuts) {
      const Vec3 n = normalized(cut.normal);
      const double along = dot(n, rays[i].direction) * frame_.size;
      const double from = dot(n, to_world(frame_, rays[i], 0)) - cut.offset;  // > 0: on the removed side
      constexpr double kFar = std::numeric_limits<double>::infinity();
      double begin = -kFar, end = kFar;  // removed part
      if (along == 0) {
        if (!(from > 0 && from < cut.thickness)) continue;
      } else {
        begin = -from / along, end = (cut.thickness - from) / along;
        if (begin > end) std::swap(begin, end);
      }
      left.clear();
      for (const RayInterval& s : own) take_away(s, begin, end, left);
      own.swap(left);
    }
    intervals.insert(intervals.end(), own.begin(), own.end());
    first.push_back(static_cast<std::uint32_t>(intervals.size()));
  }
}

}  // namespace sansmesh::inline v1
