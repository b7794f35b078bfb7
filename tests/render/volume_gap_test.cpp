// Gaps in volumes: clear inside, with faces at their ends.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "render/analytic_volumes.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/volume/volume_picture.h"

namespace sansmesh::inline v1 {
namespace {

using test::constant_volume;
using test::FormulaVolume;

class FormulaGap final : public ScalarField {
 public:
  std::function<double(const Vec3&)> depth;
  std::function<Vec3(const Vec3&)> slope;

  Box3 bounds() const override { return {{0, 0, 0}, {1, 1, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = depth(x[i]);
      if (!gradients.empty()) gradients[i] = slope(x[i]);
    }
  }
};

/// |⟨n, x⟩ − at| < half.
FormulaGap slab(const Vec3& n, double at, double half) {
  FormulaGap gap;
  gap.depth = [=](const Vec3& x) { return half - std::abs(dot(n, x) - at); };
  gap.slope = [=](const Vec3& x) { return n * (dot(n, x) > at ? -1.0 : 1.0); };
  return gap;
}

VolumePictureOptions gap_pixel(double opacity, double length) {
  VolumePictureOptions options;
  options.picture.view.width = options.picture.view.height = options.picture.quality.samples = 1;
  TransferFunction f;
  f.colors = {{0, {1, 0, 0}}, {1, {0, 0, 1}}};
  f.opacities = {{0, opacity}, {1, opacity}};
  f.reference_length = length;
  options.transfer = f;
  options.shading = false;
  options.least_light = 0;
  return options;
}

std::array<float, 4> light_from(const VolumeSubject& subject, const VolumePictureOptions& options, const Vec3& from,
                                const Vec3& direction, double half_width, bool parallel) {
  Progress progress;
  const VolumePicture picture(subject, progress);
  Camera camera;
  camera.position = Vec3f((from - picture.frame().center) / picture.frame().size);
  camera.backward = Vec3f(-direction);
  tangent_frame(camera.backward, camera.right, camera.up);
  camera.half_width = camera.half_height = static_cast<float>(half_width);
  camera.parallel = parallel;
  return picture.light(camera, options, progress).at(0, 0);
}

std::array<float, 4> ray_along(const VolumeSubject& subject, const VolumePictureOptions& options, const Vec3& a,
                               const Vec3& b) {
  const Vec3 d = normalized(b - a);
  return light_from(subject, options, a - d * 2, d, 1e-4, false);
}

TEST(VolumeGap, NothingIsSeenInGaps) {
  const FormulaVolume field = constant_volume(0.5);
  for (const double half : {0.2, 0.03, 0.004}) {  // samples are 0.03 apart
    for (const Vec3& n : {Vec3{1, 0, 0}, normalized(Vec3{1, 0.4, -0.3})}) {
      const FormulaGap gap = slab(n, 0.5 * n.x + 0.4 * n.y + 0.3 * n.z, half);
      VolumeSubject subject{&field, nullptr, nullptr, {}};
      subject.gap = &gap;
      VolumePictureOptions options = gap_pixel(0.3, 0.25);
      options.clip_faces = false;
      for (const double step : {0.3, 1.0, 2.5}) {
        options.step = step;
        const double length = 1 - 2 * half / n.x;
        EXPECT_NEAR(ray_along(subject, options, {0, 0.4, 0.3}, {1, 0.4, 0.3})[3], std::pow(0.7, 4 * length), 2e-4)
            << half << ' ' << step;
      }
    }
  }
}

TEST(VolumeGap, SlicesBetweenGapsAreNotMissed) {
  const FormulaVolume field = constant_volume(0.5);
  FormulaGap gap;  // all but |x − 0.52| < 0.003
  gap.depth = [](const Vec3& x) { return std::abs(x.x - 0.52) - 0.003; };
  gap.slope = [](const Vec3& x) { return Vec3{x.x > 0.52 ? 1.0 : -1.0, 0, 0}; };
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  subject.gap = &gap;
  VolumePictureOptions options = gap_pixel(0.3, 0.005);
  options.clip_faces = false;
  EXPECT_NEAR(ray_along(subject, options, {0, 0.4, 0.3}, {1, 0.4, 0.3})[3], std::pow(0.7, 1.2), 5e-3);
}

TEST(VolumeGap, FacesShowTheirValuesInTheLightOfTheGap) {
  // Values increase along x: the colour of the face behind the gap shows its position.
  FormulaVolume field = test::linear_volume({1, 0, 0});
  VolumePictureOptions options = gap_pixel(0.01, 1);
  for (const double half : {0.1, 0.02}) {
    const FormulaGap gap = slab({1, 0, 0}, 0.4, half);
    VolumeSubject subject{&field, nullptr, nullptr, {}};
    subject.gap = &gap;
    const auto seen = ray_along(subject, options, {0, 0.4, 0.3}, {1, 0.4, 0.3});
    EXPECT_EQ(seen[3], 0);  // the face is opaque
    TransferFunction f = *options.transfer;
    const Vec3f at_face = linear_color(f.color(0.4 + half));
    EXPECT_NEAR(seen[0], at_face.x, 0.02);
    EXPECT_NEAR(seen[2], at_face.z, 0.02);
    // From the other side the other face is in front.
    const auto back = ray_along(subject, options, {1, 0.4, 0.3}, {0, 0.4, 0.3});
    EXPECT_NEAR(back[0], linear_color(f.color(0.4 - half)).x, 0.02);
  }
  // Lighting depends on the normal of the face, not on the gradient of the values.
  options.shading = true;
  const auto lit = [&](const Vec3& n) {
    const FormulaGap gap = slab(n, dot(n, Vec3{0.4, 0.4, 0.3}), 0.05);
    VolumeSubject subject{&field, nullptr, nullptr, {}};
    subject.gap = &gap;
    const auto light = ray_along(subject, options, {0, 0.4, 0.3}, {1, 0.4, 0.3});
    return light[0] + light[2];
  };
  EXPECT_GT(std::abs(lit({1, 0, 0}) - lit(normalized(Vec3{1, 1, 0}))), 0.02);
}

TEST(VolumeGap, FacesOfIsoSurfacesShowWhatIsNotBelowTheLeast) {
  FormulaVolume field = test::linear_volume({0, 1, 0});
  const FormulaGap gap = slab({1, 0, 0}, 0.4, 0.1);
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  subject.gap = &gap;
  VolumePictureOptions options = gap_pixel(0.3, 0.25);
  options.opacity_factor = 0;
  options.isos = {{0.5, {}, 1}};
  EXPECT_EQ(ray_along(subject, options, {0, 0.7, 0.3}, {1, 0.7, 0.3})[3], 0);
  EXPECT_EQ(ray_along(subject, options, {0, 0.3, 0.3}, {1, 0.3, 0.3})[3], 1);
  options.clip_faces = false;
  EXPECT_EQ(ray_along(subject, options, {0, 0.7, 0.3}, {1, 0.7, 0.3})[3], 1);
}

TEST(VolumeGap, ParallelRaysSeeTheSameFromAnyDistance) {
  // Pixels have a width of 0.001, samples a distance of 0.03. Rounding decides the side of a sample at a wall.
  const auto everywhere = [](const Vec3&) { return true; };
  const auto seen = [](const VolumeSubject& subject, const VolumePictureOptions& options, double distance) {
    return light_from(subject, options, {-distance, 0.45, 0.3}, {1, 0, 0}, 0.0005, true);
  };
  const auto expect_same = [&](const VolumeSubject& subject, const VolumePictureOptions& options) {
    const auto near = seen(subject, options, 1);
    for (const double distance : {20.0, 1000.0}) {
      const auto far = seen(subject, options, distance);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(far[k], near[k], 1e-3) << distance << ' ' << k;
    }
  };
  // An iso-surface in black fog, whose brightness shows its depth.
  FormulaVolume ball = test::ball_volume({0.5, 0.4, 0.4});
  ball.in = everywhere;
  VolumePictureOptions through = gap_pixel(0.9, 0.1);
  through.transfer->colors = {{0, {0, 0, 0}}, {1, {0, 0, 0}}};
  through.isos = {{0.3, Vec3f{1, 1, 1}, 1}}, through.step = 3;
  expect_same({&ball, nullptr, nullptr, {}}, through);
  // The face behind a gap by its colour, and a slice between two gaps.
  FormulaVolume ramp = test::linear_volume({1, 0, 0});
  ramp.in = everywhere;
  const FormulaGap gap = slab({1, 0, 0}, 0.4, 0.02);
  VolumeSubject subject{&ramp, nullptr, nullptr, {}};
  subject.gap = &gap;
  expect_same(subject, gap_pixel(0.01, 1));
  FormulaGap slice;  // all but |x − 0.52| < 0.003
  slice.depth = [](const Vec3& x) { return std::abs(x.x - 0.52) - 0.003; };
  slice.slope = [](const Vec3& x) { return Vec3{x.x > 0.52 ? 1.0 : -1.0, 0, 0}; };
  subject.gap = &slice;
  VolumePictureOptions sliced = gap_pixel(0.3, 0.005);
  sliced.clip_faces = false;
  expect_same(subject, sliced);
}

TEST(VolumeGap, WithoutAnyNothingChanges) {
  FormulaVolume field = test::ball_volume({0.3, 0.4, 0.5});
  FormulaGap gap;
  gap.depth = [](const Vec3&) { return -std::numeric_limits<double>::infinity(); };
  gap.slope = [](const Vec3&) { return Vec3{}; };
  VolumeSubject without{&field, nullptr, nullptr, {}}, with = without;
  with.gap = &gap;
  const VolumePictureOptions options = gap_pixel(0.3, 0.25);
  for (const double y : {0.1, 0.4, 0.8})
    EXPECT_EQ(ray_along(without, options, {0, y, 0.3}, {1, y, 0.6}),
              ray_along(with, options, {0, y, 0.3}, {1, y, 0.6}));
}

}  // namespace
}  // namespace sansmesh::inline v1
