// Prescribed motions and forces of a scene at each moment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// A vertex attached by a spring to a moving target.
struct PulledVertex {
  std::uint32_t vertex = 0;
  double stiffness = 0;  ///< N/m
};

class SceneDrive {
 public:
  /// A vertex i of the scene becomes place[i], an index into `rest`. Vertices in `loose` are held like fixed ones.
  SceneDrive(const DynamicsScene& scene, std::span<const Vec3> rest, std::span<const std::uint32_t> place,
             std::span<const std::uint32_t> loose);

  /// Vertices with prescribed motion: fixed ones and those of handles without stiffness.
  std::span<const std::uint32_t> held() const { return held_; }
  /// Their positions at time t, in that order.
  std::span<const Vec3> held_positions(double t);

  std::span<const PulledVertex> pulled() const { return pulled_; }
  std::span<const Vec3> targets(double t);

  /// Adds the scene's forces at time t.
  void add_forces(double t, std::span<Vec3> f) const;

 private:
  struct Handle {
    std::size_t first, count;  ///< range in held_ or pulled_
    bool rigid;
    Vec3 center;
    std::vector<HandleKey> keys;
  };
  struct Force {
    std::vector<std::uint32_t> vertices;
    Vec3 force;
    double from, until;
  };
  void follow(bool rigid, double t, std::span<const Vec3> rest, std::span<Vec3> x) const;

  std::vector<std::uint32_t> held_;
  std::vector<PulledVertex> pulled_;
  std::vector<Handle> handles_;
  std::vector<Force> forces_;
  std::vector<Vec3> held_rest_, held_now_, pulled_rest_, pulled_now_;
};

}  // namespace sansmesh::inline v1
