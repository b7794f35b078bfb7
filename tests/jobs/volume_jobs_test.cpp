// Tests of jobs on volumes: automatic choices and reports.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "io/io_test_tools.h"
#include "jobs/volume_models.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/volume/reconstruction.h"
#include "sansmesh/volumes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

double hill(const Vec3& x) { return std::sin(3 * x.x + x.y) + 0.5 * std::cos(2 * x.y - x.z); }

double noise(const Vec3& /*x*/) {
  static std::mt19937 random(5);
  return static_cast<double>(random()) / 4294967296.0;
}

TEST(VolumeModel, ChoosesTheMethodThatSuitsTheDataAndSaysWhy) {
  Progress progress;
  std::vector<Note> notes;
  VolumeModel smooth = model_of(lattice_grid({16, 16, 16}, hill)), rough = model_of(lattice_grid({16, 16, 16}, noise));
  smooth.field(progress, notes), rough.field(progress, notes);
  EXPECT_EQ(smooth.report().options.method, "mls-detail");
  EXPECT_EQ(rough.report().options.method, "mls-detail");
  EXPECT_EQ(rough.report().options.smoothing, 1);
  EXPECT_EQ(rough.report().why, rough.recommended(progress).why);
  EXPECT_NE(rough.report().why.find("nois"), std::string::npos);
  // The default method is the same in the dataset and in the reconstruction itself.
  VolumeDataset dataset(lattice_grid({16, 16, 16}, noise));
  VolumeReconstructionReport of_dataset, alone;
  dataset.field({"f", {}, false}, {}, progress, &of_dataset);
  reconstruct_volume(rough.samples(progress), "f", {}, progress, &alone);
  EXPECT_EQ(of_dataset.options.method, "mls-detail");
  EXPECT_EQ(alone.options.method, "mls-detail");
  EXPECT_EQ(alone.why, rough.report().why);
}

TEST(VolumeModel, TakesTheMethodThatIsNamedAndItsOptionsNeedOne) {
  Progress progress;
  std::vector<Note> notes;
  VolumeModelOptions options;
  options.reconstruction = {.method = "cubic", .b = 1, .c = 0};
  VolumeModel volume = model_of(lattice_grid({8, 8, 8}, hill), options);
  volume.field(progress, notes);
  EXPECT_EQ(volume.report().options.b, 1);
  EXPECT_TRUE(volume.report().why.empty());
  VolumeModelOptions lonely;
  lonely.reconstruction.degree = 2;
  EXPECT_THROW(model_of(lattice_grid({4, 4, 4}, hill), lonely), ArgumentError);
  lonely.reconstruction = {.robust = false};
  EXPECT_THROW(lonely.validate(), ArgumentError);
  lonely.reconstruction = {.method = "amls", .order = 3};
  EXPECT_THROW(lonely.validate(), ArgumentError);
}

TEST(VolumeModel, OtherArraysGetTheMethodOfTheFirst) {
  Progress progress;
  std::vector<Note> notes;
  VolumeModelOptions options;
  options.array = "where:magnitude";
  VolumeModel volume = model_of(with_vectors(lattice_grid({16, 16, 16}, noise)), options);
  EXPECT_EQ(volume.array_name(), "where_magnitude");
  const auto length = volume.field(progress, notes);
  EXPECT_EQ(length->components(), 1u);
  EXPECT_EQ(volume.field(progress, notes), length) << "made once";
  EXPECT_EQ(volume.sample_value(0), 0);
  EXPECT_EQ(volume.report().options.method, volume.recommended(progress).method);
  EXPECT_EQ(volume.field(volume.scalar_choice("f", "color_by"), progress, notes)->components(), 1u);
  EXPECT_THROW(volume.scalar_choice("g", "color_by"), ArgumentError);
  EXPECT_THROW(volume.value_or_middle({}), ArgumentError);
  const VolumeModel component = model_of(with_vectors(lattice_grid({4, 4, 4}, noise)), {.array = "where:y"});
  EXPECT_EQ(component.value_or_middle({}), 0.5);
}

TEST(VolumeModel, BareGridsAreAnErrorUnlessTheyMayBe) {
  GridData bare;
  bare.blocks.push_back(lattice_block({4, 4, 4}));
  bare.notes = {"its arrays are elsewhere"};
  try {
    model_of(bare);
    FAIL() << "a volume without arrays";
  } catch (const DataError& error) {
    EXPECT_EQ(std::string(error.what()),
              "made.vti: has no arrays: there is nothing to reconstruct; its arrays are elsewhere");
  }
  Progress progress;
  VolumeModel may_be = model_of(bare, {.bare = true});
  EXPECT_EQ(may_be.samples(progress)->size(), 64u);
  EXPECT_TRUE(has_note(may_be.notes(), "volume"));
}

TEST(VolumeModel, FilesOfOneFittedVolumeSayTheRestThemselves) {
  const Folder folder;
  Progress progress;
  VolumeModelOptions options;
  options.reconstruction = {.method = "cubic", .b = 1, .c = 0};
  VolumeModel volume = model_of(lattice_grid({8, 8, 8}, hill), options);
  write_fit(folder / "f.smv", fit_volume(volume, {}, progress));
  EXPECT_THROW(write_fit(folder / "f.vti", fit_volume(volume, {}, progress)), FileError);
  VolumeModel opened = open_volume({folder / "f.smv"}, {}, progress);
  std::vector<Note> notes;
  opened.field(progress, notes);
  EXPECT_EQ(opened.report().options.method, "cubic");
  EXPECT_EQ(opened.report().options.b, 1);
  EXPECT_TRUE(opened.report().why.empty());
  EXPECT_THROW(open_volume({folder / "f.smv", folder / "f.smv"}, {}, progress), FileError);
  EXPECT_THROW(open_volume({folder / "f.smv"}, {.read = {.time_step = 1}}, progress), ArgumentError);
  VolumeModelOptions raw;
  raw.read.raw.dims = {8, 8, 8};
  EXPECT_THROW(open_volume({folder / "f.smv"}, raw, progress), ArgumentError);
  EXPECT_THROW(open_volume({folder / "none.mhd"}, {}, progress), FileError);
  EXPECT_EQ(volume_name({"a.vtu", "b.vtu", "c.vtu"}), "a.vtu and 2 other files");
}

TEST(VolumeModelOptions, AreReadFromWords) {
  VolumeReadOptions read;
  const auto set = [&](const char* name, const OptionValue& value) {
    for_each_option(VolumeReadOptions::schema(), &read, [&](const OptionRow& row, void* owner) {
      if (row.name == name) set_option(row, owner, value);
    });
  };
  set("dims", std::string("8x9x10")), set("type", std::string("float"));
  set("fill_value", std::vector<std::string>{"none", "-999"});
  EXPECT_EQ(read.raw.dims[2], 10u);
  EXPECT_EQ(read.raw.type, NumberType::f32);
  EXPECT_FALSE(read.fill.usual);
  EXPECT_EQ(read.fill.values, std::vector<double>{-999});
  EXPECT_NO_THROW(read.validate());
  EXPECT_THROW(set("dims", std::string("8x9")), ArgumentError);
  EXPECT_THROW(set("dims", std::string("8x0x1")), ArgumentError);
  EXPECT_THROW(set("fill_value", std::vector<std::string>{"many"}), ArgumentError);
  read.raw.dims = {};
  EXPECT_THROW(read.validate(), ArgumentError) << "a type without numbers of values";
}

TEST(ProbeVolume, ValuesGradientsAndWhatIsInside) {
  Progress progress;
  VolumeModel volume = model_of(with_vectors(lattice_grid({8, 8, 8}, linear_function)));
  const std::vector<Vec3> x = {{0.5, 0.5, 0.5}, {3, 0, 0}};
  const ProbeResult probed = probe_volume(volume, x, progress);
  EXPECT_NEAR(probed.values[0], linear_function(x[0]), 1e-6);
  EXPECT_NEAR(probed.gradients[0].z, kLinearGradient.z, 1e-5);
  EXPECT_EQ(probed.inside, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(probed.report.inside, 1u);
  EXPECT_FALSE(has_note(probed.notes, "outside"));
  EXPECT_TRUE(has_note(probe_volume(volume, std::vector<Vec3>{x[1]}, progress).notes, "outside"));
  EXPECT_EQ(probe_volume(volume, std::vector<Vec3>{{NAN, 0, 0}}, progress).report.inside, 0u);
  EXPECT_EQ(probe_table(probed).substr(0, 34), "x,y,z,f,f_dx,f_dy,f_dz,inside\n0.5,");
}

TEST(ProbeVolume, NamesComponents) {
  Progress progress;
  VolumeModel volume = model_of(with_vectors(lattice_grid({6, 6, 6}, hill)), {.array = "where"});
  const ProbeResult probed = probe_volume(volume, std::vector<Vec3>{{0.25, 0.5, 0.75}}, progress);
  EXPECT_EQ(probed.names, (std::vector<std::string>{"where_0", "where_1", "where_2"}));
  EXPECT_NEAR(probed.values[2], 0.75, 1e-6);
}

TEST(ResampleJob, ReportsTheShareInside) {
  Progress progress;
  VolumeModel volume = model_of(lattice_grid({8, 8, 8}, linear_function));
  ResampleOptions options;
  options.size = {11, 3, 3};
  options.box = Box3{{0, 0, 0}, {2, 1, 1}};
  const ResampleResult made = resample(volume, options, progress);
  EXPECT_EQ(made.block.axes[0].size(), 11u);
  EXPECT_NEAR(made.report.inside, 6.0 / 11, 1e-12);
  EXPECT_TRUE(made.report.reconstruction.options.method.has_value());
  options.size = {1};
  EXPECT_THROW(resample(volume, options, progress), ArgumentError);
  options.size = {4, 4};
  EXPECT_THROW(resample(volume, options, progress), ArgumentError);
}

TEST(ResampleJob, OptionsAreReadFromWords) {
  ResampleOptions options;
  for_each_option(ResampleOptions::schema(), &options, [&](const OptionRow& row, void* owner) {
    if (row.name == "outside") set_option(row, owner, std::string("nan"));
    if (row.name == "size") {
      set_option(row, owner, std::vector<double>{4, 5, 6});
      EXPECT_THROW(set_option(row, owner, std::vector<double>{4.5}), ArgumentError);
    }
  });
  EXPECT_TRUE(std::isnan(options.outside));
  EXPECT_EQ(options.size, (std::vector<std::size_t>{4, 5, 6}));
  EXPECT_NO_THROW(options.validate());
}

TEST(FitVolume, KeepsOneArrayOrAllAndSaysWhereThereIsNothingToKeep) {
  Progress progress;
  VolumeModel volume = model_of(with_vectors(lattice_grid({12, 12, 12}, hill)));
  const FitVolumeResult one = fit_volume(volume, {}, progress),
                        all = fit_volume(volume, {.all_arrays = true}, progress);
  EXPECT_EQ(one.report.arrays, std::vector<std::string>{"f"});
  EXPECT_EQ(all.report.arrays.size(), 2u);
  const VolumeModel again(one.fitted, "kept");
  const auto held = volume_info(again, progress).fitted;
  ASSERT_TRUE(held);
  EXPECT_EQ(held->options.method, "mls-detail");
  EXPECT_EQ(held->by_degree, one.report.by_degree);
  EXPECT_FALSE(one.report.by_degree.empty());
  EXPECT_FALSE(has_note(one.notes, "no_coefficients"));
  VolumeModelOptions linear;
  linear.reconstruction.method = "linear";
  VolumeModel plain = model_of(lattice_grid({5, 5, 5}, hill), linear);
  EXPECT_TRUE(has_note(fit_volume(plain, {}, progress).notes, "no_coefficients"));
  VolumeModel component = model_of(with_vectors(lattice_grid({5, 5, 5}, hill)), {.array = "where:x"});
  EXPECT_THROW(fit_volume(component, {}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
