#include "sansmesh/render/volume/volume_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "render/analytic_volumes.h"
#include "render/picture_levels.h"
#include "render/volume_rays.h"
#include "sansmesh/error.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/render/volume/volume_tracer.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::ball_volume;
using test::box_surface;
using test::constant_volume;
using test::fog;
using test::FormulaVolume;
using test::linear_volume;
using test::one_ray;

const double kDiagonal = std::sqrt(3.0);

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
  const Image mesh = picture_of({&nothing, nullptr, nullptr, {scene_factory(sphere, options.picture)}}, options);
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
  options.picture.view.direction.azimuth -= 90;  // the rotated one has in −x what this has in z
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

// Flat values say nothing about a layer as thin as the spacing that follows.
TEST(VolumePicture, LayersBetweenFlatValuesAreSeen) {
  FormulaVolume field = test::constant_volume(0);  // samples are 1/32 apart
  Progress progress;
  const TriangleMesh boundary = box_surface({0, 0, 0}, {1, 1, 1});
  for (int shift = 0; shift < 8; ++shift) {
    const double at = 0.4 + shift / 8.0 / 32, width = 0.6 / 32;
    field.value = [=](const Vec3& x) { return std::exp(-(x.z - at) * (x.z - at) / (width * width)); };
    field.gradient = [=](const Vec3& x) {
      return Vec3{0, 0, -2 * (x.z - at) / (width * width) * std::exp(-(x.z - at) * (x.z - at) / (width * width))};
    };
    const VolumePicture picture({&field, nullptr, &boundary, {}}, progress);
    TransferFunction layer = fog(0, 0.01);
    layer.opacities = {{0, 0}, {0.5, 0}, {0.6, 1}, {1, 1}};
    VolumePictureOptions options = test::one_pixel(layer);
    options.least_light = 0;
    const Camera camera = one_ray({0.02, 0.03, 2}, {0, 0, -1});
    const auto light = picture.light(camera, options, progress).at(0, 0);
    options.step = 0.05;
    const auto exact = picture.light(camera, options, progress).at(0, 0);
    EXPECT_LT(exact[3], 0.1f);
    EXPECT_NEAR(light[3], exact[3], 0.1f) << shift;
  }
}

TEST(VolumePicture, LittleMoreThanARayPerPixelGivesNearlyTheDensePicture) {
  const FormulaVolume field = blobs(false);
  VolumePictureOptions options = blob_picture(96);
  options.picture.quality.samples = 5;
  options.pixel_error = 0;
  const VolumeSubject subject{&field, nullptr, nullptr, {}};
  const Image dense = picture_of(subject, options);
  Progress progress;
  VolumePictureReport report;
  options.picture.quality.samples = 3;
  options.pixel_error = VolumePictureOptions{}.pixel_error;
  const Image image = render_volume(subject, options, progress, &report);
  EXPECT_LT(differences(image, dense).first, 0.3);
  EXPECT_LT(differences(image, dense).second, 16);
  EXPECT_LT(report.rays, 96u * 96u * 3 / 2);
}

TEST(VolumePicture, SameForAnyThreads) {
  const FormulaVolume field = blobs(false);
  const TriangleMesh boundary = box_surface({0, 0, 0}, {1, 1, 1});
  VolumePictureOptions options = blob_picture(72);
  options.picture.quality.samples = 3;
  options.clips = {volume_cut_of("x>0.62")};
  test::expect_equal_for_any_threads([&] { return picture_of({&field, nullptr, &boundary, {}}, options).pixels; });
}

TEST(VolumeCells, KnowHowManyAroundAreClear) {
  const FormulaVolume field = blobs(false);
  Progress progress;
  const VolumeCells cells(field, nullptr, progress);
  const auto n = cells.counts();
  std::vector<std::uint8_t> clear(cells.size());
  for (std::size_t c = 0; c < clear.size(); ++c) clear[c] = c * 2654435761u % 997 < 994;  // only a few are not clear
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
  const VolumeIntervals intervals(field, &boundary, frame);
  const VolumePictureOptions options = blob_picture();
  TracedVolume volume;
  volume.field = &field, volume.bounded = true, volume.intervals = &intervals, volume.cells = &cells;
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
