// Changes of a cloud under which its reconstruction must not change.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"
#include "support/clouds.h"

namespace sansmesh::test {

enum class CloudChange {
  none,
  rotated,        ///< about a skew axis
  reflected,      ///< x -> -x
  scaled,         ///< by 0.37
  shifted,        ///< by a million spacings; the origin keeps the positions exact
  nudged,         ///< by a third of a spacing: other roundings, other cells
  shuffled,       ///< in random order
  jittered,       ///< by 0.001 spacings
  thinned,        ///< a random percent of the samples is missing
  one_missing,    ///< one random sample is missing
  stray,          ///< one sample a hundred diagonals away
  strays,         ///< ten samples up to a hundred diagonals away
  tripled,        ///< every sample three times
  cluttered,      ///< 10 % more samples anywhere in the box
  second_object,  ///< a ball of 2000 samples beside it
};

struct NamedChange {
  CloudChange change;
  std::string_view name;
};

inline constexpr std::array<NamedChange, 15> kCloudChanges{{{CloudChange::none, "as it is"},
                                                            {CloudChange::rotated, "rotated"},
                                                            {CloudChange::reflected, "reflected"},
                                                            {CloudChange::scaled, "scaled"},
                                                            {CloudChange::shifted, "shifted"},
                                                            {CloudChange::nudged, "nudged"},
                                                            {CloudChange::shuffled, "shuffled"},
                                                            {CloudChange::jittered, "jittered"},
                                                            {CloudChange::thinned, "thinned"},
                                                            {CloudChange::one_missing, "one missing"},
                                                            {CloudChange::stray, "stray"},
                                                            {CloudChange::strays, "ten strays"},
                                                            {CloudChange::tripled, "tripled"},
                                                            {CloudChange::cluttered, "clutter"},
                                                            {CloudChange::second_object, "second object"}}};

/// Rotation by 0.7 rad about (1, 2, 3).
inline Vec3f turned(const Vec3f& p, double angle = 0.7) {
  const Vec3 axis = normalized(Vec3{1, 2, 3}), x(p);
  const double c = std::cos(angle), s = std::sin(angle);
  return Vec3f(x * c + cross(axis, x) * s + axis * (dot(axis, x) * (1 - c)));
}

/// A changed cloud and the way back.
class PerturbedCloud {
 public:
  /// `spacing`: length. `seed`: of the random choices.
  PerturbedCloud(PointSet cloud, CloudChange change, double spacing, unsigned seed = 1)
      : points(std::move(cloud)), change_(change), origin_(points.origin) {
    std::mt19937 random(seed);
    std::normal_distribution<float> gauss(0, 1);
    const Box3f box = bounds(points);
    const float diagonal = static_cast<float>(box.diagonal()), one = static_cast<float>(spacing);
    const auto add = [&](const Vec3f& p) {
      points.positions.push_back(p);
      if (points.has_normals()) points.normals.push_back(normalized(p - box.center()));
    };
    const auto direction = [&] { return normalized(Vec3f{gauss(random), gauss(random), gauss(random)}); };
    switch (change) {
      case CloudChange::none:
        break;
      case CloudChange::rotated:
        for (Vec3f& p : points.positions) p = turned(p);
        for (Vec3f& n : points.normals) n = turned(n);
        break;
      case CloudChange::reflected:
        for (Vec3f& p : points.positions) p.x = -p.x;
        for (Vec3f& n : points.normals) n.x = -n.x;
        for (auto& t : points.triangles) std::swap(t[0], t[1]);
        break;
      case CloudChange::scaled:
        for (Vec3f& p : points.positions) p *= kScale;
        break;
      case CloudChange::shifted:
        points.origin += Vec3{1e6, -2e6, 5e5} * spacing;
        break;
      case CloudChange::nudged:
        nudge_ = Vec3f{0.31f, 0.22f, -0.17f} * one;
        for (Vec3f& p : points.positions) p += nudge_;
        break;
      case CloudChange::shuffled:
        shuffle(random);
        break;
      case CloudChange::jittered:
        for (Vec3f& p : points.positions) p += Vec3f{gauss(random), gauss(random), gauss(random)} * (1e-3f * one);
        break;
      case CloudChange::thinned:
        leave_out(std::max<std::size_t>(1, points.size() / 100), random);
        break;
      case CloudChange::one_missing:
        leave_out(1, random);
        break;
      case CloudChange::stray:
        add(box.center() + Vec3f{0.3f, -0.2f, 1.0f} * (100 * diagonal));
        break;
      case CloudChange::strays:
        for (int k = 0; k < 10; ++k)
          add(box.center() + direction() * (diagonal * std::pow(10.0f, 0.2f * static_cast<float>(k + 1))));
        break;
      case CloudChange::tripled: {
        const PointSet once = points;
        points = joined(joined(std::move(points), once), once);
        break;
      }
      case CloudChange::cluttered: {
        std::uniform_real_distribution<float> uniform(-0.6f, 0.6f);
        const std::size_t count = points.size() / 10;
        for (std::size_t k = 0; k < count; ++k) {
          const Vec3f size = box.size(), at{uniform(random), uniform(random), uniform(random)};
          points.positions.push_back(box.center() + Vec3f{size.x * at.x, size.y * at.y, size.z * at.z});
          if (points.has_normals()) points.normals.push_back(direction());
        }
        break;
      }
      case CloudChange::second_object:
        points.triangles.clear();
        points =
            joined(std::move(points), sphere(2000), one * static_cast<float>(std::sqrt(2000 / (4 * std::numbers::pi))),
                   box.center() + Vec3f{0, 0, 1} * (0.75f * diagonal + 13 * one));
        break;
    }
  }

  /// Moves a mesh of the changed cloud back.
  void undo(TriangleMesh& mesh) const {
    for (Vec3f& p : mesh.vertices) {
      if (change_ == CloudChange::rotated) p = turned(p, -0.7);
      if (change_ == CloudChange::reflected) p.x = -p.x;
      if (change_ == CloudChange::scaled) p *= 1 / kScale;
      if (change_ == CloudChange::nudged) p -= nudge_;
    }
    if (change_ == CloudChange::reflected)
      for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    if (change_ == CloudChange::shifted) mesh.origin += origin_ - points.origin;
  }
  /// Number of parts that the change adds.
  std::size_t parts() const { return change_ == CloudChange::second_object ? 1 : 0; }

  PointSet points;

 private:
  static constexpr float kScale = 0.37f;

  void shuffle(std::mt19937& random) {
    std::vector<std::uint32_t> order(points.size()), place(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), random);
    for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
    auto triangles = std::move(points.triangles);
    points = take_samples(points, order);
    for (auto& t : triangles)
      for (std::uint32_t& v : t) v = place[v];
    points.triangles = std::move(triangles);
  }
  void leave_out(std::size_t count, std::mt19937& random) {
    std::vector<std::uint8_t> mask(points.size());
    std::uniform_int_distribution<std::size_t> any(0, points.size() - 1);
    for (std::size_t k = 0; k < count; ++k) mask[any(random)] = 1;
    points.triangles.clear();
    remove_samples(points, mask);
  }

  CloudChange change_;
  Vec3 origin_;
  Vec3f nudge_;
};

}  // namespace sansmesh::test
