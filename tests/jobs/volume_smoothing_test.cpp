// Smoothing of noisy volumes in jobs: files, fitted volumes, series.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "io/io_test_tools.h"
#include "jobs/volume_models.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/flow.h"
#include "sansmesh/io/grids/write_volume.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

double smooth_wave(const Vec3& x) { return std::sin(3 * x.x + x.y) + 0.5 * std::cos(2 * x.y - x.z); }

GridData noisy_wave(std::size_t n = 16) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  return lattice_grid({n, n, n}, [&](const Vec3& x) { return smooth_wave(x) + 0.1 * normal(random); });
}

TEST(SmoothVolume, FilesThatCannotHoldTheResultAreRefusedFirst) {
  const Folder folder;
  Progress progress;
  const auto check = [&](const VolumeModel& volume, const char* name, const SmoothVolumeOptions& options) {
    check_smoothed_writable(folder / name, volume, options, progress);
  };
  const VolumeModel lattice = model_of(with_vectors(noisy_wave(6)));
  for (const char* image : {"a.mhd", "a.mha", "a.nrrd"}) {
    EXPECT_NO_THROW(check(lattice, image, {}));
    EXPECT_THROW(check(lattice, image, {.deviations = true}), ArgumentError);
    EXPECT_THROW(check(lattice, image, {.all_arrays = true}), ArgumentError);
    const SmoothVolumeResult both = smooth_volume(lattice, {.deviations = true}, progress);
    EXPECT_THROW(write_smoothed(folder / image, both), ArgumentError);
  }
  for (const char* any : {"a.vti", "a.vtu"})
    EXPECT_NO_THROW(check(lattice, any, {.all_arrays = true, .deviations = true}));
  VolumeModelOptions of_cells;
  of_cells.array = "cell";
  GridData data = noisy_wave(6);
  data.blocks[0].point_arrays = {};
  data.blocks[0].cell_arrays.set("cell", std::vector<double>(125, 1.0));
  const VolumeModel cells = model_of(data, of_cells), bent = model_of(bent_grid({5, 5, 5}, smooth_wave));
  for (const VolumeModel* other : {&cells, &bent}) {
    EXPECT_THROW(check(*other, "a.vti", {}), ArgumentError);
    EXPECT_NO_THROW(check(*other, "a.vtu", {}));
  }
  EXPECT_THROW(check(lattice, "a.txt", {}), FileError);
}

TEST(SmoothVolume, ConstantValuesHaveNoNoiseEvenOnRequest) {
  Progress progress;
  VolumeModelOptions options;
  options.reconstruction.smoothing = 1;
  const VolumeModel constant = model_of(lattice_grid({8, 8, 8}, [](const Vec3&) { return 2.5; }), options);
  const SmoothVolumeResult made = smooth_volume(constant, {}, progress);
  EXPECT_TRUE(has_note(made.notes, "no_noise"));
  EXPECT_NE(summary_of(made.report)[0].find("no noise found"), std::string::npos);
}

TEST(FittedVolume, KeepsItsSmoothedSamples) {
  const Folder folder;
  Progress progress;
  std::vector<Note> notes;
  const std::vector<Vec3> x = {{0.31, 0.52, 0.13}, {0.9, 0.2, 0.7}, {0, 0, 0}, {0.5, 1, 0.25}};
  const auto values_of = [&](const VolumeModel& volume, double* noise) {
    std::vector<double> values(x.size());
    volume.field(progress, notes)->evaluate(x, {values});
    EXPECT_EQ(volume.report().options.smoothing, 1);
    *noise = volume.report().noise;
    return values;
  };
  for (const char* method : {"mls-detail", "cubic"}) {
    VolumeModelOptions options;
    options.reconstruction.method = method;
    const VolumeModel volume = model_of(noisy_wave(), options);
    write_fit(folder / "f.smv", fit_volume(volume, {}, progress));
    double noise = 0, kept = 0;
    const std::vector<double> expected = values_of(volume, &noise);
    const VolumeModel opened = open_volume({folder / "f.smv"}, {}, progress);
    EXPECT_EQ(dataset_of(opened).fitted()->coefficients.smoothed.size(), 16u * 16 * 16) << method;
    EXPECT_EQ(values_of(opened, &kept), expected) << method;
    EXPECT_EQ(kept, noise) << method;
    const VolumeInfo info = volume_info(opened, progress);
    ASSERT_TRUE(info.fitted) << method;
    EXPECT_EQ(info.fitted->noise, noise) << method;
    EXPECT_EQ(info.fitted->options.smoothing, 1) << method;
    const std::vector<std::string> lines = summary_of(info);
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& l) { return l.starts_with("smoothed"); }))
        << method;
    // So do other methods; only without smoothing the samples are the file's.
    options.reconstruction = {.method = "linear"};
    EXPECT_EQ(values_of(open_volume({folder / "f.smv"}, options, progress), &kept),
              values_of(model_of(noisy_wave(), options), &noise));
    options.reconstruction.smoothing = 0;
    VolumeModel raw = open_volume({folder / "f.smv"}, options, progress);
    const auto field = raw.field(progress, notes);
    const auto samples = raw.samples(progress);
    std::vector<double> at(1);
    field->evaluate(std::vector<Vec3>{samples->position(77)}, {at});
    EXPECT_NEAR(at[0], raw.sample_value(77), 1e-9) << method;
  }
}

TEST(VolumeUse, NamesNoiseAndFieldsThatDoNotInterpolate) {
  Progress progress;
  std::vector<Note> notes;
  VolumeModelOptions options;
  options.reconstruction.method = "mls-detail";
  const VolumeModel smoothed = model_of(noisy_wave(), options);
  smoothed.field(progress, notes);
  EXPECT_EQ(volume_use(smoothed, progress).noise_kind, "white");
  EXPECT_EQ(volume_use(smoothed, progress).interpolate, true);
  EXPECT_NE(summary_of(smoothed, progress)[0].find("its white noise of"), std::string::npos);
  options.reconstruction.interpolate = false, options.reconstruction.smoothing = 0;
  const VolumeModel printed = model_of(noisy_wave(), options);
  printed.field(progress, notes);
  EXPECT_EQ(volume_use(printed, progress).interpolate, false);
  EXPECT_NE(summary_of(printed, progress)[0].find("not through the samples"), std::string::npos);
}

TEST(FlowModel, EachStepIsSmoothedByItsOwnNoise) {
  const Folder folder;
  Progress progress;
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::vector<std::string> files;
  std::vector<double> noisy;
  for (const double sigma : {0.0, 0.1}) {
    GridBlock block = noisy_wave().blocks[0];
    std::vector<double> vectors;
    for (std::size_t i = 0; i < block_point_count(block); ++i) {
      const Vec3 p = block_point(block, i);
      for (const double v : {1 + p.y, smooth_wave(p), p.x * p.z}) vectors.push_back(v + sigma * normal(random));
    }
    block.point_arrays = {}, block.cell_arrays = {};
    block.point_arrays.set("v", vectors, 3);
    files.push_back(folder / (sigma > 0 ? "1.mha" : "0.mha"));
    write_volume(files.back(), block);
    noisy = std::move(vectors);
  }
  const auto away = [&](std::optional<double> smoothing) {
    VolumeModelOptions options;
    options.reconstruction = {.method = "linear", .smoothing = smoothing};
    const FlowModel flow = open_flow(files, options, {.unsteady = true}, progress);
    const SampledVolume samples = *open_volume({files[1]}, {}, progress).samples(progress);
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < samples.size(); ++i) x.push_back(samples.position(i));
    std::vector<Vec3> found(x.size());
    std::vector<std::uint8_t> inside(x.size());
    flow.field().evaluate(x, std::vector<double>(x.size(), 1.0), found, inside);
    double most = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; inside[i] != 0 && k < 3; ++k)
        most = std::max(most, std::abs(found[i][k] - noisy[3 * i + k]));
    return most;
  };
  EXPECT_LT(away(0), 1e-5);
  EXPECT_GT(away({}), 0.1) << "the first step has no noise";
}

}  // namespace
}  // namespace sansmesh::test
