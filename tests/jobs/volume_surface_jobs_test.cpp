// Tests of jobs that make surfaces and pictures of volumes, and of advice.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "io/io_test_tools.h"
#include "jobs/volume_models.h"
#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/error.h"
#include "sansmesh/isosurfaces.h"
#include "sansmesh/jobs/volumes/volume_series.h"
#include "sansmesh/volume/reconstruction.h"
#include "sansmesh/volume_pictures.h"
#include "sansmesh/volumes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

const double kBall = 4.0 / 3 * std::numbers::pi * std::pow(0.3, 3);

VolumeModelOptions linear() {
  VolumeModelOptions options;
  options.reconstruction.method = "linear";
  return options;
}

VolumeModel ball_model() { return model_of(with_vectors(lattice_grid({21, 21, 21}, soft_ball)), linear()); }

TEST(IsosurfaceJob, TakesTheMiddleOfTheRangeAndCarriesArraysAlong) {
  Progress progress;
  VolumeModel volume = ball_model();
  const VolumeIsosurfaceResult made = isosurface(volume, {}, progress);
  EXPECT_NEAR(made.report.value, 0.5, 0.01);
  EXPECT_NEAR(made.report.mesh.area, 4 * std::numbers::pi * 0.09, 0.03);
  ASSERT_NE(made.mesh.attributes.find("where"), nullptr);
  EXPECT_EQ(made.mesh.attributes.find("where")->components, 3u);
  const VolumeIsosurfaceResult closed =
      isosurface(volume, {.value = 0.25, .carry = "none", .mesh = {.closed = true}}, progress);
  EXPECT_EQ(closed.mesh.attributes.find("where"), nullptr);
  EXPECT_GT(closed.report.mesh.volume.value_or(0), kBall);
}

TEST(IsosurfaceJob, SaysWhatCannotBeCarriedOrFound) {
  Progress progress;
  GridData huge = lattice_grid({9, 9, 9}, soft_ball);
  huge.blocks[0].point_arrays.set("far", std::vector<double>(9 * 9 * 9, 1e300));
  VolumeModel volume = model_of(std::move(huge), {.array = "f"});
  EXPECT_TRUE(has_note(isosurface(volume, {}, progress).notes, "not_carried"));
  EXPECT_THROW(isosurface(volume, {.carry = "nothing"}, progress), ArgumentError);
  EXPECT_THROW(isosurface(volume, {.mesh = {.triangles = 2}}, progress), ArgumentError);
  try {
    isosurface(volume, {.value = 7}, progress);
    FAIL() << "a value that there is not";
  } catch (const DataError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 10), "made.vti: ");
  }
  VolumeModel vectors = model_of(with_vectors(lattice_grid({5, 5, 5}, soft_ball)), {.array = "where"});
  EXPECT_THROW(isosurface(vectors, {}, progress), ArgumentError) << "no value";
  EXPECT_THROW(isosurface(vectors, {.value = 0.5}, progress), ArgumentError) << "no component";
}

/// A ball that grows.
VolumeSeries growing() {
  VolumeSeries series;
  series.name = "ball_0.vti and 2 other files";
  for (const double radius : {0.2, 0.3, 0.4}) {
    series.steps.push_back(model_of(lattice_grid({13, 13, 13},
                                                 [&](const Vec3& x) {
                                                   return radius - norm(x - Vec3{0.5, 0.5, 0.5});
                                                 }),
                                    linear()));
    series.times.push_back(static_cast<double>(series.times.size()));
  }
  return series;
}

TEST(IsosurfaceMoments, AreClosedMeshesFromTheFirstStepToTheLast) {
  Progress progress;
  VolumeSeries series = growing();
  std::vector<std::size_t> numbers;
  const IsosurfaceMomentsResult made = isosurface_moments(
      series, {.value = 0}, {.frames = 5},
      [&](std::size_t k, const TriangleMesh& mesh) {
        numbers.push_back(k);
        EXPECT_FALSE(mesh.triangles.empty());
      },
      progress);
  EXPECT_EQ(numbers, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  ASSERT_EQ(made.report.moments.size(), 5u);
  EXPECT_EQ(made.report.moments[4].time, 2);
  EXPECT_EQ(made.report.moments[1].time, 0.5);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_TRUE(made.report.moments[k].closed);
  EXPECT_GT(made.report.moments[4].volume, 4 * made.report.moments[0].volume);
  EXPECT_FALSE(has_note(made.notes, "no_surface"));
  EXPECT_EQ(moment_count(series, {}), 3u);
}

TEST(IsosurfaceMoments, SayWhereThereIsNoSurfaceAndWhatIsNotForThem) {
  Progress progress;
  VolumeSeries series = growing();
  const auto none = [](std::size_t, const TriangleMesh&) {};
  EXPECT_TRUE(has_note(isosurface_moments(series, {.value = 0.3}, {}, none, progress).notes, "no_surface"));
  EXPECT_TRUE(has_note(isosurface_moments(series, {.value = 0, .mesh = {.triangles = 8}}, {}, none, progress).notes,
                       "more_triangles"));
  EXPECT_THROW(check_moments({.carry = "none"}, {}), ArgumentError);
  EXPECT_THROW(check_moments({.mesh = {.closed = true}}, {}), ArgumentError);
  EXPECT_THROW(check_moments({}, {.frames = 1}), ArgumentError);
  EXPECT_THROW(check_moments({}, {.time_cell = 0}), ArgumentError);
  series.times = {0, 0, 1};
  EXPECT_THROW(isosurface_moments(series, {.value = 0}, {}, none, progress), DataError);
  EXPECT_THROW(times_of_series({0, 1, 2}, 5), ArgumentError);
  EXPECT_EQ(times_of_series({10, 2}, 3), (std::vector<double>{10, 12, 14}));
  EXPECT_EQ(times_of_series({}, 2), (std::vector<double>{0, 1}));
}

TEST(SurfaceInVolume, OfAValueOrOfHighGradient) {
  Progress progress;
  VolumeModel volume = ball_model();
  SurfaceInVolumeOptions steep;
  steep.surface.kind = VolumeSurfaceOptions::Kind::high_gradient;
  for (const SurfaceInVolumeOptions& options : {SurfaceInVolumeOptions(), steep}) {
    const SurfaceInVolume surface = surface_in_volume(volume, options, progress);
    EXPECT_GT(surface.report.samples, 100u);
    EXPECT_FALSE(has_note(surface.notes, "resolved")) << "a lattice";
    const MeshInVolume mesh = mesh_of_surface(surface, {}, progress);
    EXPECT_NEAR(mesh.report.volume.value_or(0), kBall, 0.1 * kBall);
  }
  EXPECT_NEAR(surface_in_volume(volume, {}, progress).value, 0.5, 0.01);
}

TEST(SurfaceInVolume, SaysThatItSmooths) {
  Progress progress;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto noisy = [&](double sigma) {
    return lattice_grid({25, 25, 25}, [&](const Vec3& x) { return soft_ball(x) + sigma * normal(random); });
  };
  const GridData data = noisy(0.15);
  const VolumeModel volume = model_of(data);
  const SurfaceInVolume smoothed = surface_in_volume(volume, {.value = 0.5}, progress);
  EXPECT_GT(smoothed.report.smoothed, 0);
  EXPECT_LE(smoothed.report.smoothed, 1);
  EXPECT_NE(summary_of(smoothed, volume, progress)[1].find("smoothed"), std::string::npos);
  VolumeModelOptions as_they_are;
  as_they_are.reconstruction.smoothing = 0;
  EXPECT_EQ(surface_in_volume(model_of(data, as_they_are), {.value = 0.5}, progress).report.smoothed, 0);
  const VolumeModel clean = model_of(noisy(0));
  const SurfaceInVolume same = surface_in_volume(clean, {.value = 0.5}, progress);
  EXPECT_EQ(same.report.smoothed, 0);
  EXPECT_EQ(summary_of(same, clean, progress)[1].find("smoothed"), std::string::npos);
}

TEST(SurfaceInVolume, SaysWhereAnIsosurfaceIsNearer) {
  Progress progress;
  VolumeModel smooth = model_of(tetrahedra_grid({9, 9, 9}, [](const Vec3& x) { return squared_norm(x); }));
  const SurfaceInVolume surface = surface_in_volume(smooth, {.value = 0.8}, progress);
  ASSERT_TRUE(has_note(surface.notes, "resolved"));
}

TEST(SurfaceInVolume, OptionsThatDoNotGoTogether) {
  SurfaceInVolumeOptions both;
  both.value = 1, both.surface.kind = VolumeSurfaceOptions::Kind::high_gradient;
  EXPECT_THROW(both.validate(), ArgumentError);
  SurfaceInVolumeOptions neither;
  neither.surface.predictor = neither.surface.corrector = false;
  EXPECT_THROW(neither.validate(), ArgumentError);
  SurfaceInVolumeOptions steep;
  steep.surface.local_maximum = false;
  EXPECT_THROW(steep.validate(), ArgumentError);
  steep = {};
  steep.surface.least_gradient = 1;
  EXPECT_THROW(steep.validate(), ArgumentError);
  SurfaceInVolumeLook look;
  look.color_range = 2;
  EXPECT_THROW(look.validate(), ArgumentError);
  look.color_by = "where";
  EXPECT_THROW(look.validate(), ArgumentError);
  look.color_by = "gaussian";
  EXPECT_NO_THROW(look.validate());
  EXPECT_EQ(look.curvature(), CurvatureQuantity::gaussian);
}

TEST(SurfaceInVolumePicturesJob, ColoursOfCurvatureAndOfArrays) {
  Progress progress;
  VolumeModel volume = ball_model();
  const SurfaceInVolume surface = surface_in_volume(volume, {}, progress);
  std::vector<Note> notes;
  const SurfaceInVolumePictures curved(surface, volume, {.color_by = "mean", .color_range = 5}, progress, notes);
  ASSERT_TRUE(curved.colors().has_value());
  EXPECT_NEAR(curved.colors()->range, 5, 1e-9);
  SurfaceRenderOptions look;
  look.picture.view.width = 40, look.picture.view.height = 30, look.plain = true;
  EXPECT_EQ(curved.render(look, progress).width, 40);
  EXPECT_GT(curved.counts().hits, 0u);
  const SurfaceInVolumePictures by_array(surface, volume, {.color_by = "where:x", .sharp = true}, progress, notes);
  const auto [lower, upper] = by_array.colors()->colors.range();
  EXPECT_GT(lower, 0.1);
  EXPECT_LT(upper, 0.9);
  EXPECT_THROW(SurfaceInVolumePictures(surface, volume, {.color_by = "none"}, progress, notes), ArgumentError);
}

TEST(VolumePicturesJob, ChoosesTheViewOfALayerAndTheTitle) {
  Progress progress;
  VolumePicturesOptions options;
  options.look.picture.view.width = 40, options.look.picture.view.height = 30;
  options.unit = "K";
  VolumeModel layer = model_of(with_vectors(one_block(lattice_block({20, 20, 2}, {0, 0, 0}, {1, 1, 0.001}), soft_ball)),
                               {.array = "where"});
  VolumePictures pictures(layer, options, {}, progress);
  EXPECT_EQ(pictures.look().color_title, "where (magnitude) [K]");
  EXPECT_NE(pictures.look().picture.view.direction.elevation, ViewDirection().elevation);
  EXPECT_GT(pictures.render(pictures.look().picture.view.direction, progress).width, 20);
  options.default_view = false;
  EXPECT_EQ(VolumePictures(layer, options, {}, progress).look().picture.view.direction.elevation,
            ViewDirection().elevation);
}

TEST(VolumePicturesJob, BakesForQuickPicturesAndSaysWhatIsNotThere) {
  Progress progress;
  VolumeModel volume = ball_model();
  VolumePicturesOptions options;
  options.look.picture.view.width = 24, options.look.picture.view.height = 18, options.baked = true,
  options.grid = true;
  options.look.isos = {{.value = 40, .color = {}, .opacity = 1}};
  VolumePictures pictures(volume, options, {}, progress);
  EXPECT_EQ(pictures.look().picture.quality.samples, 1);
  pictures.render(pictures.look().picture.view.direction, progress);
  ASSERT_NE(pictures.baked(), nullptr);
  EXPECT_GT(pictures.baked()->bricks, 0u);
  EXPECT_TRUE(has_note(pictures.notes(), "picture"));
  options.baked = false, options.bake_error = 0.1;
  EXPECT_THROW(options.validate(), ArgumentError);
  options = {};
  options.bar = false, options.unit = "K";
  EXPECT_THROW(options.validate(), ArgumentError);
}

TEST(VolumeAdvice, NamesArraysValuesAndSeeds) {
  Progress progress;
  VolumeModel volume = model_of(with_vectors(lattice_grid({12, 12, 12}, soft_ball)), {.array = "where"});
  const VolumeAdvice advice = advise(volume, progress);
  EXPECT_EQ(advice.array, "where:magnitude");
  EXPECT_EQ(advice.flow, "where");
  EXPECT_GT(advice.value, 0.5);
  ASSERT_TRUE(advice.seeds.has_value());
  EXPECT_TRUE(advice.offer.lattice);
  EXPECT_FALSE(advice.offer.body);
  EXPECT_EQ(advice.recommendations[0].aim, VolumeRecommendation::Aim::flow_picture);
}

/// The grid itself shows that its cells are a body, in a file of any name.
TEST(VolumeAdvice, CellsInNoOrderAreABodyFittedToo) {
  Progress progress;
  const auto aims_at_forces = [&](VolumeModel& volume) {
    for (const VolumeRecommendation& r : advise(volume, progress).recommendations)
      if (r.aim == VolumeRecommendation::Aim::forces) return true;
    return false;
  };
  GridData two = tetrahedra_grid({4, 4, 4}, soft_ball);
  two.blocks[0].cell_arrays = {};
  VolumeModel one = model_of(two, linear());
  EXPECT_TRUE(aims_at_forces(one));
  const Folder folder;
  write_fit(folder / "one.smv", fit_volume(one, {}, progress));
  VolumeModel fitted = open_volume({folder / "one.smv"}, {}, progress);
  EXPECT_TRUE(aims_at_forces(fitted));
  two.blocks.push_back(two.blocks[0]);
  for (Vec3& x : two.blocks[1].points) x.x += 5;
  VolumeModel several = model_of(two, linear());
  EXPECT_FALSE(aims_at_forces(several));
  GridData bare;
  bare.blocks.push_back(lattice_block({4, 4, 4}));
  VolumeModel lattice = model_of(bare, {.bare = true});
  EXPECT_THROW(advise(lattice, progress), DataError);
}

TEST(VolumeInfoJob, TellsWhatWasMended) {
  Progress progress;
  GridData data = tetrahedra_grid({4, 4, 4}, soft_ball);
  data.blocks[0].points[5].x = std::numeric_limits<double>::quiet_NaN();
  VolumeModel volume = model_of(std::move(data), linear());
  const VolumeInfo info = volume_info(volume, progress);
  EXPECT_TRUE(has_note(info.notes, "not_finite"));
  EXPECT_EQ(info.notes[0].severity, Note::Severity::information);
  VolumeModel fine = ball_model();
  EXPECT_TRUE(volume_info(fine, progress).notes.empty());
}

}  // namespace
}  // namespace sansmesh::test
