// Light along single rays through volumes: integrals, layers, iso-surfaces, boundaries.
#include <gtest/gtest.h>

#include <cmath>

#include "render/analytic_volumes.h"
#include "render/volume_rays.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/volume/transfer_table.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::along;
using test::ball_volume;
using test::box_surface;
using test::constant_volume;
using test::fog;
using test::FormulaVolume;
using test::linear_volume;
using test::one_pixel;

const double kDiagonalOfCube = std::sqrt(3.0);

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
      EXPECT_NEAR(diagonal[3], std::pow(0.7, 4 * kDiagonalOfCube), 2e-6) << step;
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
  // e^(−z / 0.004), an eighth of the spacing: values of a layer that ends at the wall.
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
  for (const double where : {0.0, 0.013, 0.031}) {  // independent of the sample positions
    const Vec3 a{0.5, 0.5 - where, 1}, b{0.5 + where, 0.5, 0};
    const double length = norm(b - a);
    EXPECT_NEAR(-std::log(along(subject, options, a, b)[3]), depth * length, 0.08 * depth) << where;
  }
}

TEST(VolumePicture, FirstColourCoversTheSecond) {
  // Red in front, blue behind, both opaque; the reverse from the other side.
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
  // Black fog in front dims the surface according to its depth.
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

TEST(VolumePicture, SurfacesHideWhatIsBehindThem) {
  const FormulaVolume field = constant_volume(0.5);
  TriangleMesh wall = box_surface({0.1, 0.1, 0.4}, {0.9, 0.9, 0.5});
  VolumePictureOptions options = one_pixel(fog(0.3, 0.1, {0, 0, 0}));
  VolumeSubject subject{&field, nullptr, nullptr, {scene_factory(wall, options.picture)}};
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
    const SceneFactory near = sheet(0.4f, 0.5), far = sheet(0.7f, 0.25);
    VolumeSubject subject{&field, nullptr, nullptr, {swapped ? far : near, swapped ? near : far}};
    const auto seen = along(subject, options, a, b);
    EXPECT_NEAR(seen[3], std::pow(0.7, 10) * 0.5 * 0.75, 1e-4);
    EXPECT_NEAR(seen[0] / own, std::pow(0.7, 4) * 0.5 + std::pow(0.7, 7) * 0.5 * 0.25, 2e-3);
  }
}

TEST(VolumePicture, HolesOfABoundaryAreEmpty) {
  const FormulaVolume field = constant_volume(0.5);  // also defined in the hole
  const TriangleMesh ring = test::ring_surface();
  const VolumeSubject subject{&field, nullptr, &ring, {}};
  const VolumePictureOptions options = one_pixel(fog(0.3, 0.25));
  EXPECT_EQ(along(subject, options, {0.5, 0.5, 0}, {0.5, 0.5, 1})[3], 1);
  EXPECT_EQ(along(subject, options, {0.31, 0.69, 0}, {0.31, 0.69, 1})[3], 1);
  EXPECT_NEAR(along(subject, options, {0.2, 0.5, 0}, {0.2, 0.5, 1})[3], std::pow(0.7, 4), 1e-5);
  // In, out into the hole, in again, out.
  EXPECT_NEAR(along(subject, options, {0, 0.45, 0.5}, {1, 0.45, 0.5})[3], std::pow(0.7, 4 * 0.6), 1e-5);
  // Along the diagonals of the faces and through edges, where both or neither of two triangles may report the ray.
  EXPECT_NEAR(along(subject, options, {0, 0, 0.5}, {1, 1, 0.5})[3], std::pow(0.7, 4 * 0.6 * std::sqrt(2.0)), 1e-4);
  EXPECT_NEAR(along(subject, options, {0, 0.5, 0.5}, {1, 0.5, 0.5})[3], std::pow(0.7, 4 * 0.6), 1e-4);
  for (const double y : {0.0, 0.3, 0.7, 1.0}) {  // along faces: on either side, but finite
    const auto p = along(subject, options, {0, y, 0.5}, {1, y, 0.5});
    EXPECT_GE(p[3], std::pow(0.7, 4) - 1e-5);
    EXPECT_LE(p[3], 1);
  }
}

TEST(VolumePicture, WhereCrossingsMakeNoSenseTheFieldDecides) {
  // A boundary without a lid: rays that enter through the opening only leave.
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
  // Within two steps, at its ends.
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
  options.clips = {volume_cut_of("1,1,0>1")};  // at distance 1 along the unit vector: x + y < √2
  EXPECT_NEAR(along(subject, options, a, b)[3], std::pow(0.7, 4 * (std::sqrt(2.0) - 0.5)), 1e-5);
  options.clips = {volume_cut_of("x>-1")};
  EXPECT_EQ(along(subject, options, a, b)[3], 1);
  // The face has the colour of its value and is opaque.
  TransferFunction gray = fog(0.3, 0.25);
  gray.colors = {{0, {0, 0, 0}}, {1, {1, 1, 1}}};
  options.transfer = gray;
  options.clip_faces = true;
  options.clips = {volume_cut_of("x<0.75")};
  const auto face = along(subject, options, a, b);
  EXPECT_EQ(face[3], 0);
  EXPECT_NEAR(face[1], linear_color(gray.color(0.75)).y, 1e-4);
  // Values that the function makes clear stay clear.
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
  const std::vector<Vec3> points = specks.points();
  Progress progress;
  for (const bool given : {true, false}) {
    VolumeSubject subject{&specks.field, nullptr, &boundary, {}};
    if (given) subject.samples = points;
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
    for (const double near : {0.5, 0.01, 0.0005}) {  // the path is shorter near an edge
      EXPECT_NEAR(left({near, 0.3, -1}, {near, 0.3, 2}), std::pow(0.7, 4), 1e-5) << near;
      EXPECT_EQ(left({-near, 0.3, -1}, {-near, 0.3, 2}), 1) << near;
      EXPECT_NEAR(left({0, near, 0.4}, {near, 0, 0.4}), std::pow(0.7, 4 * near * std::sqrt(2.0)), 1e-5) << near;
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
