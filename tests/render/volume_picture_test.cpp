#include "sansmesh/render/volume/volume_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "render/analytic_volumes.h"
#include "render/picture_levels.h"
#include "sansmesh/error.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/transfer_table.h"
#include "sansmesh/render/volume/volume_tracer.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::ball_volume;
using test::box_surface;
using test::constant_volume;
using test::FormulaVolume;
using test::linear_volume;

const double kDiagonal = std::sqrt(3.0);

/// One opacity and one colour for all values; `length` in the unit of the data.
TransferFunction fog(double opacity, double length, const Vec3f& color = {1, 1, 1}) {
  TransferFunction f;
  f.colors = {{0, color}, {1, color}};
  f.opacities = {{0, opacity}, {1, opacity}};
  f.reference_length = length;
  return f;
}

/// A pinhole whose one pixel is the ray from `from` along `direction`, both in coordinates of the picture.
Camera one_ray(const Vec3& from, const Vec3& direction) {
  Camera camera;
  camera.position = Vec3f(from);
  camera.backward = Vec3f(-normalized(direction));
  tangent_frame(camera.backward, camera.right, camera.up);
  camera.half_width = camera.half_height = 1e-4f;
  return camera;
}

VolumePictureOptions one_pixel(const TransferFunction& transfer) {
  VolumePictureOptions options;
  options.picture.view.width = options.picture.view.height = options.picture.quality.samples = 1;
  options.transfer = transfer;
  options.shading = false;
  options.least_light = 0;
  return options;
}

/// What a ray between two points of the world's unit cube sees, from well outside; red, green, blue, left.
std::array<float, 4> along(const VolumeSubject& subject, const VolumePictureOptions& options, const Vec3& a,
                           const Vec3& b) {
  Progress progress;
  const VolumePicture picture(subject, progress);
  const Vec3 d = normalized(b - a);
  const Vec3 from = (a - d * 2 - picture.frame().center) / picture.frame().size;
  return picture.light(one_ray(from, d), options, progress).at(0, 0);
}

VolumePictureOptions small_volume_picture(int size = 48) {
  VolumePictureOptions options;
  options.picture.view.width = options.picture.view.height = size;
  options.picture.quality.samples = 1;
  options.picture.look.background = Background::transparent();
  return options;
}

Image picture_of(const VolumeSubject& subject, const VolumePictureOptions& options) {
  Progress progress;
  return render_volume(subject, options, progress);
}

/// Mean and largest difference in levels, pixels premultiplied.
std::pair<double, double> differences(const Image& a, const Image& b) {
  double sum = 0, most = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const float pa = k < 3 ? a.pixels[i][k] * a.pixels[i][3] : a.pixels[i][3];
      const float pb = k < 3 ? b.pixels[i][k] * b.pixels[i][3] : b.pixels[i][3];
      const double d = 255 * std::abs(static_cast<double>(pa - pb));
      sum += d, most = std::max(most, d);
    }
  return {sum / static_cast<double>(4 * a.pixels.size()), most};
}

TEST(VolumePicture, HomogeneousCubeKeepsBackWhatTheIntegralSays) {
  const FormulaVolume field = constant_volume(0.5);
  const TriangleMesh boundary = box_surface({0, 0, 0}, {1, 1, 1});
  for (const bool bounded : {true, false}) {
    VolumeSubject subject{&field, nullptr, bounded ? &boundary : nullptr, {}};
    VolumePictureOptions options = one_pixel(fog(0.3, 0.25));
    for (const double step : {0.05, 0.3, 1.0, 4.0}) {
      options.step = step;
      const auto straight = along(subject, options, {0.4, 0.3, 0}, {0.4, 0.3, 1});
      EXPECT_NEAR(straight[3], std::pow(0.7, 4), 2e-6) << step;
      EXPECT_NEAR(straight[0], 1 - std::pow(0.7, 4), 2e-6) << step;
      const auto diagonal = along(subject, options, {0, 0, 0}, {1, 1, 1});
      EXPECT_NEAR(diagonal[3], std::pow(0.7, 4 * kDiagonal), 2e-6) << step;
    }
    options.opacity_factor = 2;
    EXPECT_NEAR(along(subject, options, {0.4, 0.3, 0}, {0.4, 0.3, 1})[3], std::pow(0.7, 8), 2e-6);
  }
}

TEST(VolumePicture, RampKeepsBackWhatTheIntegralSays) {
  const FormulaVolume field = linear_volume({0, 0, 0.9});
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  TransferFunction f = fog(0, 0.5);
  f.opacities = {{0, 0}, {0.9, 0.9}};
  VolumePictureOptions options = one_pixel(f);
  // Extinction −ln(1 − 0.9 z) / 0.5 along z.
  const double depth = (0.1 * std::log(0.1) + 0.9) / 0.9 / 0.5;
  for (const double step : {0.1, 1.0, 4.0}) {
    options.step = step;
    EXPECT_NEAR(along(subject, options, {0.5, 0.5, 0}, {0.5, 0.5, 1})[3], std::exp(-depth), 1e-5) << step;
    EXPECT_NEAR(along(subject, options, {0.5, 0.5, 1}, {0.5, 0.5, 0})[3], std::exp(-depth), 1e-5) << step;
  }
}

TEST(VolumePicture, OneColourOfTinyValuesIsLit) {
  const FormulaVolume field = linear_volume({0, 0, 1e-190}, 1e-190);
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  TransferFunction f = fog(0, 0.25);
  f.colors = {{1e-190, {1, 1, 1}}}, f.opacities = {{1e-190, 0.9}};
  VolumePictureOptions options = one_pixel(f);
  options.shading = true;
  const float light = along(subject, options, {0.4, 0.3, 1}, {0.4, 0.3, 0})[0];
  EXPECT_GT(light, 0.1f);
  EXPECT_LT(light, 10.0f);
}

TEST(VolumePicture, ThinLayersAreNotMissedByLongSteps) {
  const FormulaVolume field = linear_volume({0, 0, 1});
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  // Opaque only for values of 0.5 ± 0.0025, a tenth of a step.
  TransferFunction f = fog(0, 1);
  f.opacities = {{0, 0}, {0.4975, 0}, {0.4975, 0.99999}, {0.5025, 0.99999}, {0.5025, 0}, {1, 0}};
  f.reference_length = 0.005;
  VolumePictureOptions options = one_pixel(f);
  for (const double step : {0.25, 1.0, 4.0}) {
    options.step = step;
    EXPECT_NEAR(along(subject, options, {0.2, 0.7, 0}, {0.2, 0.7, 1})[3], 1e-5, 1e-6) << step;
  }
}

TEST(VolumePicture, LayersAtWallsAreFollowedWhereGradientsTellOfThem) {
  // e^(−z / 0.004): an eighth of the spacing; values of a layer that ends at the wall.
  constexpr double kThick = 0.004;
  FormulaVolume field = constant_volume(0);
  field.value = [](const Vec3& x) { return std::exp(-x.z / kThick); };
  field.gradient = [](const Vec3& x) { return Vec3{0, 0, -std::exp(-x.z / kThick) / kThick}; };
  const VolumeSubject subject{&field, nullptr, nullptr, {}};
  TransferFunction f = fog(0, 0.004);
  f.opacities = {{0, 0}, {1, 0.6}};
  VolumePictureOptions options = one_pixel(f);
  // ∫ −ln(1 − 0.6 e^(−z/h)) dz / h = Li₂(0.6), the dilogarithm.
  double depth = 0;
  for (int k = 200; k > 0; --k) depth += std::pow(0.6, k) / (static_cast<double>(k) * k);
  for (const double where : {0.0, 0.013, 0.031}) {  // wherever the samples fall
    const Vec3 a{0.5, 0.5 - where, 1}, b{0.5 + where, 0.5, 0};
    const double length = norm(b - a);
    EXPECT_NEAR(-std::log(along(subject, options, a, b)[3]), depth * length, 0.08 * depth) << where;
  }
}

TEST(VolumePicture, FirstColourCoversTheSecond) {
  // Red in front, blue behind, both opaque: from the other side it is the other way round.
  const FormulaVolume field = linear_volume({1, 0, 0});
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  TransferFunction f = fog(0.9, 0.02);
  f.mixing = ColorMixing::step;
  f.colors = {{0, {1, 0, 0}}, {0.5, {0, 0, 1}}, {1, {0, 0, 1}}};
  const VolumePictureOptions options = one_pixel(f);
  const auto front = along(subject, options, {0, 0.5, 0.5}, {1, 0.5, 0.5});
  EXPECT_GT(front[0], 0.99f);
  EXPECT_LT(front[2], 0.01f);
  const auto back = along(subject, options, {1, 0.5, 0.5}, {0, 0.5, 0.5});
  EXPECT_LT(back[0], 0.01f);
  EXPECT_GT(back[2], 0.99f);
}

TEST(VolumePicture, IsoSurfaceOfABallLiesWhereItIs) {
  const Vec3 center{0.5, 0.5, 0.5};
  const FormulaVolume field = ball_volume(center);
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  // Black fog that dims what lies behind it tells how far the surface is.
  VolumePictureOptions options = one_pixel(fog(0.5, 0.5, {0, 0, 0}));
  options.isos = {{0.3, Vec3f{1, 1, 1}, 1}};
  for (const double step : {0.5, 1.0, 3.0}) {
    options.step = step;
    for (const double aside : {0.0, 0.1, 0.2, 0.29}) {
      VolumePictureOptions clear = options;
      clear.opacity_factor = 0;
      const Vec3 a{0.5 + aside, 0.5, 0}, b{0.5 + aside, 0.5, 1};
      const double dim = along(subject, options, a, b)[0] / along(subject, clear, a, b)[0];
      const double depth = std::log(dim) / std::log(0.5) * 0.5;
      EXPECT_NEAR(depth, 0.5 - std::sqrt(0.09 - aside * aside), 1e-4) << step << ' ' << aside;
      EXPECT_EQ(along(subject, clear, a, b)[3], 0);
    }
    VolumePictureOptions clear = options;
    clear.opacity_factor = 0;
    EXPECT_EQ(along(subject, clear, {0.81, 0.5, 0}, {0.81, 0.5, 1})[3], 1) << "beside the ball";
    // Both sides of a translucent surface.
    clear.isos = {{0.3, Vec3f{1, 1, 1}, 0.25}};
    EXPECT_NEAR(along(subject, clear, {0.6, 0.5, 0}, {0.6, 0.5, 1})[3], 0.75 * 0.75, 1e-6);
  }
}

TEST(VolumePicture, IsoSurfaceLooksLikeTheSurfaceItself) {
  const Vec3 center{0.5, 0.5, 0.5};
  const FormulaVolume field = ball_volume(center), nothing = constant_volume(0);
  TriangleMesh sphere = test::octasphere(6);
  sphere.origin = center;
  for (Vec3f& v : sphere.vertices) v = v * 0.4f;
  VolumePictureOptions options = small_volume_picture(96);
  options.transfer = fog(0, 1);
  options.opacity_factor = 0;
  VolumePictureOptions with_iso = options;
  with_iso.isos = {{0.4, options.picture.look.surface_color, 1}};
  const Image iso = picture_of({&field, nullptr, nullptr, {}}, with_iso);
  const Image mesh = picture_of({&nothing, nullptr, nullptr, {surface_in_picture(sphere, options.picture)}}, options);
  double most = 0;
  std::size_t both = 0, one = 0;
  for (std::size_t i = 0; i < iso.pixels.size(); ++i) {
    const bool a = iso.pixels[i][3] > 0.5f, b = mesh.pixels[i][3] > 0.5f;
    one += a != b;
    if (!a || !b) continue;
    ++both;
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max(most, 255 * std::abs(static_cast<double>(iso.pixels[i][k] - mesh.pixels[i][k])));
  }
  EXPECT_GT(both, 1000u);
  EXPECT_LE(one, 12u);  // pixels of the rim
  EXPECT_LT(most, 3);
}

TEST(VolumePicture, SurfacesHideWhatIsBehindThem) {
  const FormulaVolume field = constant_volume(0.5);
  TriangleMesh wall = box_surface({0.1, 0.1, 0.4}, {0.9, 0.9, 0.5});
  VolumePictureOptions options = one_pixel(fog(0.3, 0.1, {0, 0, 0}));
  VolumeSubject subject{&field, nullptr, nullptr, {surface_in_picture(wall, options.picture)}};
  VolumePictureOptions clear = options;
  clear.opacity_factor = 0;
  const Vec3 a{0.5, 0.5, 0}, b{0.5, 0.5, 1};
  const auto hidden = along(subject, options, a, b);
  EXPECT_EQ(hidden[3], 0);
  EXPECT_NEAR(hidden[0] / along(subject, clear, a, b)[0], std::pow(0.7, 4), 2e-3);
  const auto beside = along(subject, options, {0.05, 0.5, 0}, {0.05, 0.5, 1});
  EXPECT_NEAR(beside[3], std::pow(0.7, 10), 1e-5);
}

TEST(VolumePicture, TranslucentSheetsAreSeenInTheirOrder) {
  const FormulaVolume field = constant_volume(0.5);
  VolumePictureOptions options = one_pixel(fog(0.3, 0.1, {0, 0, 0}));
  const auto sheet = [&](float z, double opacity) {
    FlowSubject subject;
    subject.mesh.vertices = {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}};
    subject.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    subject.vectors.resize(4);
    return DrawnFlow(subject, options.picture).surface({std::nullopt, opacity, false});
  };
  const Vec3 a{0.5, 0.5, 0}, b{0.5, 0.5, 1};
  VolumePictureOptions clear = options;
  clear.opacity_factor = 0;
  const double own = along({&field, nullptr, nullptr, {sheet(0.4f, 1)}}, clear, a, b)[0];
  for (const bool swapped : {false, true}) {
    const PictureSurface near = sheet(0.4f, 0.5), far = sheet(0.7f, 0.25);
    VolumeSubject subject{&field, nullptr, nullptr, {swapped ? far : near, swapped ? near : far}};
    const auto seen = along(subject, options, a, b);
    EXPECT_NEAR(seen[3], std::pow(0.7, 10) * 0.5 * 0.75, 1e-4);
    EXPECT_NEAR(seen[0] / own, std::pow(0.7, 4) * 0.5 + std::pow(0.7, 7) * 0.5 * 0.25, 2e-3);
  }
}

TEST(VolumePicture, HolesOfABoundaryAreEmpty) {
  const FormulaVolume field = constant_volume(0.5);  // goes on in the hole
  const TriangleMesh ring = test::ring_surface();
  const VolumeSubject subject{&field, nullptr, &ring, {}};
  const VolumePictureOptions options = one_pixel(fog(0.3, 0.25));
  EXPECT_EQ(along(subject, options, {0.5, 0.5, 0}, {0.5, 0.5, 1})[3], 1);
  EXPECT_EQ(along(subject, options, {0.31, 0.69, 0}, {0.31, 0.69, 1})[3], 1);
  EXPECT_NEAR(along(subject, options, {0.2, 0.5, 0}, {0.2, 0.5, 1})[3], std::pow(0.7, 4), 1e-5);
  // In, out into the hole, in again, out.
  EXPECT_NEAR(along(subject, options, {0, 0.45, 0.5}, {1, 0.45, 0.5})[3], std::pow(0.7, 4 * 0.6), 1e-5);
  // Through the diagonals of the faces' triangles and through edges, where triangles may both claim the ray or none.
  EXPECT_NEAR(along(subject, options, {0, 0, 0.5}, {1, 1, 0.5})[3], std::pow(0.7, 4 * 0.6 * std::sqrt(2.0)), 1e-4);
  EXPECT_NEAR(along(subject, options, {0, 0.5, 0.5}, {1, 0.5, 0.5})[3], std::pow(0.7, 4 * 0.6), 1e-4);
  for (const double y : {0.0, 0.3, 0.7, 1.0}) {  // along faces: whichever side it counts to, a number
    const auto p = along(subject, options, {0, y, 0.5}, {1, y, 0.5});
    EXPECT_GE(p[3], std::pow(0.7, 4) - 1e-5);
    EXPECT_LE(p[3], 1);
  }
}

TEST(VolumePicture, WhereCrossingsMakeNoSenseTheFieldDecides) {
  // A boundary with a missing lid: rays that come in through the gap only ever leave.
  FormulaVolume field = constant_volume(0.5);
  TriangleMesh open = box_surface({0, 0, 0}, {1, 1, 1});
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);  // z = 1
  const VolumeSubject subject{&field, nullptr, &open, {}};
  const VolumePictureOptions options = one_pixel(fog(0.3, 0.25));
  const auto p = along(subject, options, {0.3, 0.4, 0}, {0.3, 0.4, 1});
  EXPECT_TRUE(std::isfinite(p[3]));
  EXPECT_GE(p[3], std::pow(0.7, 4) - 1e-5);
  EXPECT_NEAR(along(subject, options, {0, 0.4, 0.3}, {1, 0.4, 0.3})[3], std::pow(0.7, 4), 1e-5);
}

TEST(VolumePicture, WithoutABoundaryInsideIsWhatTheFieldSays) {
  FormulaVolume field = constant_volume(0.5);
  field.in = [](const Vec3& x) { return norm(x - Vec3{0.5, 0.5, 0.5}) < 0.4; };
  VolumePictureOptions options = one_pixel(fog(0.3, 0.25));
  options.step = 0.2;
  const VolumeSubject subject{&field, nullptr, nullptr, {}};
  const double chord = 2 * std::sqrt(0.16 - 0.04);
  // To two steps, at its ends.
  EXPECT_NEAR(std::log(along(subject, options, {0.7, 0.5, 0}, {0.7, 0.5, 1})[3]) / std::log(0.7) * 0.25, chord,
              2 * 0.2 / 32);
}

TEST(VolumePicture, CutsTakeAwayAndShowValues) {
  const FormulaVolume field = linear_volume({1, 0, 0});
  VolumeSubject subject{&field, nullptr, nullptr, {}};
  VolumePictureOptions options = one_pixel(fog(0.3, 0.25, {1, 1, 1}));
  options.clip_faces = false;
  const Vec3 a{0, 0.5, 0.5}, b{1, 0.5, 0.5};
  options.clips = {volume_cut_of("x>0.6")};
  EXPECT_NEAR(along(subject, options, a, b)[3], std::pow(0.7, 4 * 0.6), 1e-5);
  options.clips = {volume_cut_of("0.25<x<0.5"), volume_cut_of("x<0.1")};
  EXPECT_NEAR(along(subject, options, a, b)[3], std::pow(0.7, 4 * 0.65), 1e-5);
  options.clips = {volume_cut_of("1,1,0>1")};  // of distance 1 along the unit vector: x + y < √2
  EXPECT_NEAR(along(subject, options, a, b)[3], std::pow(0.7, 4 * (std::sqrt(2.0) - 0.5)), 1e-5);
  options.clips = {volume_cut_of("x>-1")};
  EXPECT_EQ(along(subject, options, a, b)[3], 1);
  // The face has the colour of its value, and nothing shines through.
  TransferFunction gray = fog(0.3, 0.25);
  gray.colors = {{0, {0, 0, 0}}, {1, {1, 1, 1}}};
  options.transfer = gray;
  options.clip_faces = true;
  options.clips = {volume_cut_of("x<0.75")};
  const auto face = along(subject, options, a, b);
  EXPECT_EQ(face[3], 0);
  EXPECT_NEAR(face[1], linear_color(gray.color(0.75)).y, 1e-4);
  // Values that the function leaves clear stay clear.
  gray.opacities = {{0, 0.5}, {0.7, 0.5}, {0.7, 0}, {1, 0}};
  options.transfer = gray;
  EXPECT_EQ(along(subject, options, a, b)[3], 1);
}

TEST(VolumePicture, VolumesThatFillLittleOfTheirBoxAreDrawn) {
  const test::TwoSpecks specks({1, 0, 0});
  const Vec3 r{specks.radius, specks.radius, specks.radius};
  TriangleMesh boundary = test::octasphere(3);
  const TriangleMesh ball = boundary;
  for (Vec3f& v : boundary.vertices) v = Vec3f(specks.centers[0] + Vec3(v) * specks.radius);
  for (std::array<std::uint32_t, 3> t : ball.triangles) {
    for (std::uint32_t& v : t) v += static_cast<std::uint32_t>(ball.vertices.size());
    boundary.triangles.push_back(t);
  }
  for (const Vec3f& v : ball.vertices) boundary.vertices.push_back(Vec3f(specks.centers[1] + Vec3(v) * specks.radius));
  const std::vector<Vec3> places = specks.places();
  Progress progress;
  for (const bool given : {true, false}) {
    VolumeSubject subject{&specks.field, nullptr, &boundary, {}};
    if (given) subject.places = places;
    const VolumePicture picture(subject, progress);
    EXPECT_NEAR(picture.histogram().least, specks.centers[0].x, specks.radius) << given;
    EXPECT_NEAR(picture.histogram().most, specks.centers[1].x, specks.radius) << given;
    for (const Vec3& c : specks.centers)
      EXPECT_NEAR(along(subject, one_pixel(fog(0.5, 2 * specks.radius)), c - r, c + r)[3], 0.5, 0.01) << given;
  }
}

TEST(VolumePicture, ColoursAndOpacitiesMayComeFromTwoFields) {
  const FormulaVolume colors = linear_volume({0, 1, 0}), opacities = linear_volume({0, 0, 0.9});
  TransferFunction f = fog(0, 0.5);
  f.colors = {{0, {0, 0, 0}}, {1, {1, 1, 1}}};
  f.opacities = {{0, 0}, {0.9, 0.9}};
  const VolumeSubject subject{&colors, &opacities, nullptr, {}};
  const VolumePictureOptions options = one_pixel(f);
  const auto p = along(subject, options, {0.5, 0.3, 0}, {0.5, 0.3, 1});
  EXPECT_NEAR(p[3], std::exp(-(0.1 * std::log(0.1) + 0.9) / 0.9 / 0.5), 1e-5);
  EXPECT_NEAR(p[0] / (1 - p[3]), linear_color(f.color(0.3)).x, 1e-3);
}

TEST(VolumePicture, PresetsTakeOpacitiesFromTheValuesOfTheOpacityField) {
  const FormulaVolume colors = linear_volume({0, 1, 0}), opacities = linear_volume({0, 0, 1000}, 5000);
  Progress progress;
  for (const char* preset : {"gray", "flow", "mr", "ct-soft-tissue", ""}) {
    VolumePictureOptions options = small_volume_picture(4);
    options.preset = preset;
    const auto used = [&](const VolumeSubject& subject) {
      VolumePictureReport report;
      render_volume(subject, options, progress, &report);
      return report.transfer;
    };
    const TransferFunction both = used({&colors, &opacities, nullptr, {}});
    EXPECT_EQ(both.colors, used({&colors, nullptr, nullptr, {}}).colors) << preset;
    EXPECT_EQ(both.opacities, used({&opacities, nullptr, nullptr, {}}).opacities) << preset;
  }
}

TEST(VolumePicture, ObliqueLatticesEndAtTheirBoundary) {
  for (const bool mirrored : {false, true}) {
    SampledVolume volume;
    Lattice& lattice = volume.lattice.emplace();
    Vec3 n = normalized(Vec3{1, -2, 0.7}), u, v;
    tangent_frame(n, u, v);
    lattice.directions = {u, mirrored ? -v : v, cross(u, v)};
    lattice.origin = {0.3, 0.2, 5};
    for (std::size_t k = 0; k < 3; ++k) lattice.axes[k] = {0, 0.5, 1}, lattice.upper[k] = 1;
    FormulaVolume field = constant_volume(0.5);
    field.in = [&lattice](const Vec3& x) { return Box3{{0, 0, 0}, {1, 1, 1}}.contains(lattice.to_axes(x)); };
    field.box = {};
    for (int c = 0; c < 8; ++c)
      field.box.extend(lattice.from_axes({static_cast<double>(c & 1), c & 2 ? 1.0 : 0.0, c & 4 ? 1.0 : 0.0}));
    const TriangleMesh boundary = volume_boundary(volume);
    const VolumeSubject subject{&field, nullptr, &boundary, {}};
    VolumePictureOptions options = one_pixel(fog(0.3, 0.25));
    options.step = 4;
    const auto left = [&](const Vec3& a, const Vec3& b) {
      return along(subject, options, lattice.from_axes(a), lattice.from_axes(b))[3];
    };
    for (const double near : {0.5, 0.01, 0.0005}) {  // the nearer to an edge, the shorter the way
      EXPECT_NEAR(left({near, 0.3, -1}, {near, 0.3, 2}), std::pow(0.7, 4), 1e-5) << near;
      EXPECT_EQ(left({-near, 0.3, -1}, {-near, 0.3, 2}), 1) << near;
      EXPECT_NEAR(left({0, near, 0.4}, {near, 0, 0.4}), std::pow(0.7, 4 * near * std::sqrt(2.0)), 1e-5) << near;
    }
  }
}

TEST(VolumePicture, NotesSayWhatMayNotBeAsWished) {
  const FormulaVolume field = linear_volume({0, 0, 1}, 3);
  Progress progress;
  VolumePictureOptions options = small_volume_picture(4);
  const auto notes = [&](const VolumeSubject& subject) {
    VolumePictureReport report;
    render_volume(subject, options, progress, &report);
    return report.notes;
  };
  options.isos = {{3.5, {}, 1}};
  EXPECT_TRUE(notes({&field, nullptr, nullptr, {}}).empty());
  options.isos.push_back({2, {}, 1});
  options.isos.push_back({17, {}, 1});
  const auto said = notes({&field, nullptr, nullptr, {}});
  ASSERT_EQ(said.size(), 2u);
  EXPECT_NE(said[0].find("iso-surface of 2 "), std::string::npos) << said[0];
  EXPECT_NE(said[1].find("iso-surface of 17 "), std::string::npos) << said[1];
  options.isos.clear();
  FormulaVolume wavy = constant_volume(0);
  wavy.value = [](const Vec3& x) { return std::sin(40 * x.x); };
  wavy.gradient = [](const Vec3& x) { return Vec3{40 * std::cos(40 * x.x), 0, 0}; };
  const BakedVolume flat(field, {}, progress), coarse(wavy, {}, 0, progress);
  EXPECT_TRUE(notes({&flat, &flat, nullptr, {}}).empty());
  EXPECT_EQ(notes({&coarse, &flat, nullptr, {}}).size(), 1u);
  EXPECT_EQ(notes({&flat, &coarse, nullptr, {}}).size(), 1u);
}

/// Blobs without any symmetry, in [0, 1]³.
FormulaVolume blobs(bool turned) {
  FormulaVolume v;
  const auto back = [turned](const Vec3& x) { return turned ? Vec3{1 - x.z, x.y, x.x} : x; };
  const auto forth = [turned](const Vec3& g) { return turned ? Vec3{g.z, g.y, -g.x} : g; };
  const std::vector<std::array<double, 4>> centers{{0.3, 0.4, 0.35, 60}, {0.65, 0.6, 0.3, 90}, {0.55, 0.3, 0.7, 40}};
  v.value = [=](const Vec3& x) {
    double sum = 0;
    for (const auto& c : centers) sum += std::exp(-c[3] * squared_norm(back(x) - Vec3{c[0], c[1], c[2]}));
    return sum;
  };
  v.gradient = [=](const Vec3& x) {
    Vec3 g;
    for (const auto& c : centers) {
      const Vec3 d = back(x) - Vec3{c[0], c[1], c[2]};
      g += d * (-2 * c[3] * std::exp(-c[3] * squared_norm(d)));
    }
    return forth(g);
  };
  return v;
}

VolumePictureOptions blob_picture(int size = 48) {
  VolumePictureOptions options = small_volume_picture(size);
  TransferFunction f = fog(0, 0.05);
  f.colors = {{0, {0.1f, 0.2f, 0.8f}}, {1, {0.9f, 0.8f, 0.2f}}};
  f.opacities = {{0, 0}, {0.15, 0}, {0.6, 0.2}, {1.2, 0.5}};
  options.transfer = f;
  options.isos = {{0.5, {}, 0.4}};
  return options;
}

TEST(VolumePicture, TurnsWithFieldAndCamera) {
  const FormulaVolume field = blobs(false), turned = blobs(true);
  VolumePictureOptions options = blob_picture();
  const Image a = picture_of({&field, nullptr, nullptr, {}}, options);
  options.picture.view.direction.azimuth -= 90;  // the turned one has in −x what this has in z
  const Image b = picture_of({&turned, nullptr, nullptr, {}}, options);
  options.picture.view.direction.azimuth += 180;
  const Image c = picture_of({&turned, nullptr, nullptr, {}}, options);
  const double d = std::min(differences(a, b).second, differences(a, c).second);
  EXPECT_LT(d, 1.5);
  EXPECT_GT(std::max(differences(a, b).second, differences(a, c).second), 20);
}

TEST(VolumePicture, LeapsOverEmptySpaceChangeNothing) {
  const FormulaVolume field = blobs(false);
  VolumePictureOptions options = blob_picture(64);
  options.step = 0.5;
  VolumePictureReport quick, slow;
  Progress progress;
  const Image a = render_volume({&field, nullptr, nullptr, {}}, options, progress, &quick);
  options.skip_empty = false;
  const Image b = render_volume({&field, nullptr, nullptr, {}}, options, progress, &slow);
  const auto [mean, most] = differences(a, b);
  EXPECT_LT(mean, 0.02);
  EXPECT_LT(most, 1);
  EXPECT_LT(quick.evaluations, slow.evaluations * 3 / 4);
}

TEST(VolumePicture, ErrorOfTheStepsIsReportedAndFalls) {
  const FormulaVolume field = blobs(false);
  VolumePictureOptions options = blob_picture(128);
  Progress progress;
  const VolumePicture picture({&field, nullptr, nullptr, {}}, progress);
  VolumePictureReport coarse, fine;
  options.step = 2;
  const Image a = picture.render(options, progress, &coarse, true);
  options.step = 0.5;
  const Image b = picture.render(options, progress, &fine, true);
  options.step = 0.1;
  const Image exact = picture.render(options, progress);
  EXPECT_LT(fine.step_error_mean, 0.5 * coarse.step_error_mean);
  EXPECT_LT(fine.step_error_mean, 0.2);
  EXPECT_LT(differences(b, exact).first, differences(a, exact).first);
}

TEST(VolumePicture, SameForAnyThreads) {
  const FormulaVolume field = blobs(false);
  const TriangleMesh boundary = box_surface({0, 0, 0}, {1, 1, 1});
  VolumePictureOptions options = blob_picture(72);
  options.picture.quality.samples = 2;
  options.clips = {volume_cut_of("x>0.62")};
  test::expect_equal_for_any_threads([&] { return picture_of({&field, nullptr, &boundary, {}}, options).pixels; });
}

TEST(VolumeCells, KnowHowManyAroundAreClear) {
  const FormulaVolume field = blobs(false);
  Progress progress;
  const VolumeCells cells(field, nullptr, progress);
  const auto n = cells.counts();
  std::vector<std::uint8_t> clear(cells.size());
  for (std::size_t c = 0; c < clear.size(); ++c) clear[c] = c * 2654435761u % 997 < 994;  // few are not
  std::vector<std::uint8_t> reach = clear;
  detail::clear_reach(cells, reach);
  const auto at = [&](int i, int j, int k) { return static_cast<std::size_t>(i + n[0] * (j + n[1] * k)); };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        int nearest = 255;
        for (int w = 0; w < n[2]; ++w)
          for (int v = 0; v < n[1]; ++v)
            for (int u = 0; u < n[0]; ++u)
              if (!clear[at(u, v, w)])
                nearest = std::min(nearest, std::max({std::abs(u - i), std::abs(v - j), std::abs(w - k)}));
        ASSERT_EQ(reach[at(i, j, k)], nearest);
      }
}

TEST(VolumeTracer, RaysDoNotDependOnEachOther) {
  const FormulaVolume field = blobs(false);
  const TriangleMesh boundary = test::ring_surface();
  Progress progress;
  const PictureFrame frame{{0.5, 0.5, 0.5}, kDiagonal};
  const VolumeCells cells(field, nullptr, progress);
  const VolumeStretches stretches(field, &boundary, frame);
  const VolumePictureOptions options = blob_picture();
  TracedVolume volume;
  volume.field = &field, volume.bounded = true, volume.stretches = &stretches, volume.cells = &cells;
  volume.frame = frame;
  Camera camera = one_ray({1.5, 0.4, 1.2}, {-1.5, -0.4, -1.2});
  camera.half_width = camera.half_height = 0.35f;
  const VolumeTracer tracer(volume, camera, *options.transfer, options);
  std::vector<Vec3f> directions;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x)
      directions.push_back(
          camera.direction(0.1f * static_cast<float>(x) - 0.95f, 0.1f * static_cast<float>(y) - 0.95f));
  std::vector<TracedLight> together(directions.size()), alone(directions.size());
  tracer.trace({{&camera.position, 1}, directions}, together);
  for (std::size_t i = 0; i < directions.size(); ++i)
    tracer.trace({{&camera.position, 1}, {&directions[i], 1}}, {&alone[i], 1});
  EXPECT_TRUE(together == alone);
}

TEST(VolumePicture, FineEdgesTakeSeveralRays) {
  const FormulaVolume field = ball_volume({0.5, 0.5, 0.5});
  VolumePictureOptions options = small_volume_picture(64);
  options.opacity_factor = 0;
  options.isos = {{0.4, Vec3f{1, 1, 1}, 1}};
  const auto soft = [&](const Image& image) {
    std::size_t count = 0;
    for (const Rgba& p : image.pixels) count += p[3] > 0.05f && p[3] < 0.95f;
    return count;
  };
  EXPECT_EQ(soft(picture_of({&field, nullptr, nullptr, {}}, options)), 0u);
  options.picture.quality.samples = 3;
  EXPECT_GT(soft(picture_of({&field, nullptr, nullptr, {}}, options)), 60u);
}

TEST(VolumePicture, BadRequestsAreNamed) {
  const auto refused = [](auto change) {
    VolumePictureOptions options;
    change(options);
    EXPECT_THROW(options.validate(), ArgumentError);
  };
  refused([](auto& o) { o.step = 0; });
  refused([](auto& o) { o.opacity_factor = -1; });
  refused([](auto& o) { o.preset = "bones"; });
  refused([](auto& o) { o.preset = "gray", o.transfer = fog(0, 1); });
  refused([](auto& o) { o.isos = {{std::nan(""), {}, 1}}; });
  refused([](auto& o) { o.isos = {{0, {}, 2}}; });
  refused([](auto& o) { o.clips = {{{0, 0, 0}, 1}}; });
  refused([](auto& o) { o.clips = {{{1, 0, 0}, 1, 0}}; });
  refused([](auto& o) { o.transfer = TransferFunction{}; });
  for (const char* text : {"", "x", "1:red", "1:#12345", "1:#123456:2", "nan", "1:#123456:1:1"})
    EXPECT_THROW(iso_surface_of(text), ArgumentError) << text;
  for (const char* text : {"", "x", "w>1", "x>", "0,0,0>1", "2<x<1", "x>1>2", "1,2>3"})
    EXPECT_THROW(volume_cut_of(text), ArgumentError) << text;
  const IsoSurface iso = iso_surface_of("-2.5:#ff0080:0.5");
  EXPECT_EQ(iso.value, -2.5);
  EXPECT_EQ(iso.opacity, 0.5);
  EXPECT_EQ(iso_surface_of("3::0.25").opacity, 0.25);
  EXPECT_FALSE(iso_surface_of("3::0.25").color);
  Progress progress;
  EXPECT_THROW(VolumePicture({}, progress), ArgumentError);
  FormulaVolume flat = constant_volume(1);
  flat.box = {{0, 0, 0}, {0, 0, 0}};
  EXPECT_THROW(VolumePicture({&flat, nullptr, nullptr, {}}, progress), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
