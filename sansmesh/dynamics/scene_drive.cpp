#include "sansmesh/dynamics/scene_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

HandleKey key_at(const std::vector<HandleKey>& keys, double t) {
  if (t <= keys.front().time) return keys.front();
  if (t >= keys.back().time) return keys.back();
  const auto next =
      std::upper_bound(keys.begin(), keys.end(), t, [](double at, const HandleKey& k) { return at < k.time; });
  const HandleKey &a = *(next - 1), &b = *next;
  const double s = (t - a.time) / (b.time - a.time);
  return {t, a.displacement * (1 - s) + b.displacement * s, a.turn * (1 - s) + b.turn * s};
}

/// d rotated by a rotation vector (Rodrigues).
Vec3 turned(const Vec3& d, const Vec3& turn) {
  const double angle = norm(turn);
  if (!(angle > 0)) return d;
  const Vec3 axis = turn / angle;
  return d * std::cos(angle) + cross(axis, d) * std::sin(angle) + axis * (dot(axis, d) * (1 - std::cos(angle)));
}

}  // namespace

SceneDrive::SceneDrive(const DynamicsScene& scene, std::span<const Vec3> rest, std::span<const std::uint32_t> place,
                       std::span<const std::uint32_t> loose) {
  for (const std::uint32_t v : scene.fixed) held_.push_back(place[v]);
  std::sort(held_.begin(), held_.end());
  held_.erase(std::unique(held_.begin(), held_.end()), held_.end());
  std::vector<std::uint8_t> taken(rest.size(), 0);
  for (const std::uint32_t v : held_) taken[v] = 1;
  for (const PulledHandle& h : scene.handles) {
    Handle handle{h.stiffness ? pulled_.size() : held_.size(), h.vertices.size(), !h.stiffness, {}, h.keys};
    for (const std::uint32_t v : h.vertices) {
      const std::uint32_t i = place[v];
      taken[i] = 1;
      handle.center += rest[i] / static_cast<double>(h.vertices.size());
      if (h.stiffness) {
        pulled_.push_back({i, *h.stiffness});
      } else {
        held_.push_back(i);
      }
    }
    if (h.center) handle.center = *h.center;
    handles_.push_back(std::move(handle));
  }
  for (const std::uint32_t v : loose) {
    if (!taken[place[v]]) held_.push_back(place[v]);
  }
  for (const std::uint32_t v : held_) held_rest_.push_back(rest[v]);
  for (const PulledVertex& p : pulled_) pulled_rest_.push_back(rest[p.vertex]);
  held_now_ = held_rest_, pulled_now_ = pulled_rest_;
  for (const VertexForce& f : scene.forces) {
    Force force{{}, f.force, f.from, f.until};
    for (const std::uint32_t v : f.vertices) force.vertices.push_back(place[v]);
    forces_.push_back(std::move(force));
  }
}

void SceneDrive::follow(bool rigid, double t, std::span<const Vec3> rest, std::span<Vec3> x) const {
  for (const Handle& h : handles_) {
    if (h.rigid != rigid) continue;
    const HandleKey key = key_at(h.keys, t);
    for (std::size_t k = h.first; k < h.first + h.count; ++k) {
      x[k] = h.center + turned(rest[k] - h.center, key.turn) + key.displacement;
    }
  }
}

std::span<const Vec3> SceneDrive::held_positions(double t) {
  follow(true, t, held_rest_, held_now_);
  return held_now_;
}

std::span<const Vec3> SceneDrive::targets(double t) {
  follow(false, t, pulled_rest_, pulled_now_);
  return pulled_now_;
}

void SceneDrive::add_forces(double t, std::span<Vec3> f) const {
  for (const Force& force : forces_) {
    if (t < force.from || t >= force.until) continue;
    for (const std::uint32_t v : force.vertices) f[v] += force.force;
  }
}

}  // namespace sansmesh::inline v1
