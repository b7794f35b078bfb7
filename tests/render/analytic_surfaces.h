// Analytic surfaces, and balls around samples of them.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::test {

/// Signed distance to spheres around the origin; with several, negative between the first and second, and so on.
class Spheres : public ScalarField {
 public:
  explicit Spheres(std::vector<double> radii) : radii_(std::move(radii)) {}
  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double r = norm(x[i]);
      std::size_t nearest = 0;
      for (std::size_t k = 1; k < radii_.size(); ++k)
        if (std::abs(r - radii_[k]) < std::abs(r - radii_[nearest])) nearest = k;
      const double sign = nearest % 2 == 0 ? 1 : -1;
      values[i] = sign * (r - radii_[nearest]);
      if (!gradients.empty()) gradients[i] = normalized(x[i]) * sign;
    }
  }

 private:
  std::vector<double> radii_;
};

/// Signed distance to the torus around z with radii 1 and 0.35.
class Torus : public ScalarField {
 public:
  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double ring = std::hypot(x[i].x, x[i].y), out = ring - 1, d = std::hypot(out, x[i].z);
      values[i] = d - 0.35;
      if (!gradients.empty()) gradients[i] = Vec3{x[i].x / ring * out, x[i].y / ring * out, x[i].z} / d;
    }
  }
};

/// Another field, defined only inside `domain`.
class Within : public ScalarField {
 public:
  Within(const ScalarField& field, std::function<bool(const Vec3&)> domain)
      : field_(field), domain_(std::move(domain)) {}
  Box3 bounds() const override { return field_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    field_.evaluate(x, values, gradients);
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    field_.evaluate(x, values, gradients);
    for (std::size_t i = 0; i < x.size(); ++i) {
      inside[i] = domain_(x[i]);
      if (!inside[i]) values[i] = 1e300;  // arbitrary values must have no effect
    }
  }

 private:
  const ScalarField& field_;
  std::function<bool(const Vec3&)> domain_;
};

/// The closest point of a sphere around the origin. With `rate` < 1 only that share of the distance, so that several
/// applications are needed.
class SphereProjection : public Projection {
 public:
  explicit SphereProjection(double radius, bool curvature = true, double rate = 1)
      : radius_(radius), curvature_(curvature), rate_(rate) {}
  Box3 bounds() const override { return {{-2, -2, -2}, {2, 2, 2}}; }
  void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double r = norm(x[i]);
      FootPoint& f = feet[i];
      f = {};
      f.position = x[i];
      if (!(r > 0.5 * radius_ && r < 2 * radius_)) continue;
      f.normal = x[i] / r;
      f.position = f.normal * (r + rate_ * (radius_ - r));
      if (curvature_) f.xx = f.yy = -1 / radius_;
      f.defined = true;
    }
  }

 private:
  double radius_;
  bool curvature_;
  double rate_;
};

/// Balls around evenly spread points of the sphere around the origin; radius: spacing times `reach`.
inline BallUnion sphere_balls(int count, double radius = 1, double reach = 1.5) {
  BallUnion balls;
  const double spacing = radius * std::sqrt(4 * std::numbers::pi / count);
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
    balls.centers.push_back(Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z} * radius));
    balls.radii.push_back(static_cast<float>(spacing * reach));
  }
  return balls;
}

/// Around random points of the torus.
inline BallUnion torus_balls(int count, double reach = 2) {
  BallUnion balls;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double spacing = std::sqrt(4 * std::numbers::pi * std::numbers::pi * 0.35 / count);
  while (static_cast<int>(balls.centers.size()) < count) {
    const double u = 2 * std::numbers::pi * uniform(random), v = 2 * std::numbers::pi * uniform(random);
    const double r = 1 + 0.35 * std::cos(v);
    if (uniform(random) * 1.35 > r) continue;  // uniform by area
    balls.centers.push_back(Vec3f(Vec3{r * std::cos(u), r * std::sin(u), 0.35 * std::sin(v)}));
    balls.radii.push_back(static_cast<float>(spacing * reach));
  }
  return balls;
}

/// Rays from random points at distance 3 towards random points in the ball of radius `spread`.
inline std::vector<CastRay> random_rays(int count, float spread) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(-spread, spread);
  std::vector<CastRay> rays;
  for (int i = 0; i < count; ++i) {
    const float x = normal(random), y = normal(random), z = normal(random);
    const float a = uniform(random), b = uniform(random), c = uniform(random);
    const Vec3f origin = normalized(Vec3f{x, y, z}) * 3.0f;
    rays.push_back({origin, normalized(Vec3f{a, b, c} - origin)});
  }
  return rays;
}

/// Distances along the ray to the sphere around the origin; both negative without an intersection.
struct SphereCrossings {
  double near = -1, far = -1, closest = 0;
  SphereCrossings(const CastRay& ray, double radius) {
    const Vec3 o(ray.origin), d = normalized(Vec3(ray.direction));
    const double middle = -dot(o, d);
    closest = norm(o + d * middle);
    const double square = radius * radius - closest * closest;
    if (square < 0) return;
    near = middle - std::sqrt(square), far = middle + std::sqrt(square);
  }
};

inline std::vector<CastHit> cast(const SurfaceCaster& caster, const std::vector<CastRay>& rays) {
  std::vector<CastHit> hits(rays.size());
  caster.cast(rays, hits);
  return hits;
}

}  // namespace sansmesh::test
