#include "sansmesh/dataset/volume_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "io/io_test_tools.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/io/section_file.h"
#include "sansmesh/volume/methods/degree_field.h"
#include "support/any_threads.h"
#include "support/section_bytes.h"
#include "volume/volume_checks.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using Method = std::string;  // name of a method

double wavy(const Vec3& x) { return std::sin(3 * x.x + x.y) + 0.5 * std::cos(4 * x.y - 2 * x.z) * x.z; }

VolumeReconstructionOptions by(const Method& method) {
  VolumeReconstructionOptions options;
  options.method = method;
  return options;
}

/// Only the arrays of points or of cells.
GridData only(GridData data, Association of) {
  for (GridBlock& block : data.blocks) (of == Association::points ? block.cell_arrays : block.point_arrays).clear();
  return data;
}

struct EvaluatedField {
  std::vector<double> values, spacing;
  std::vector<Vec3> gradients;
  std::vector<std::uint8_t> inside, degrees;
  friend bool operator==(const EvaluatedField&, const EvaluatedField&) = default;
};

/// Answers at points inside and around the volume, without NaN, for comparison.
EvaluatedField evaluated(const VolumeField& field, const SampledVolume& volume) {
  std::vector<Vec3> x = points_within(volume, 150);
  const Box3 box = volume.bounds();
  for (int k = 0; k < 30; ++k) x.push_back(box.center() + (x[static_cast<std::size_t>(k)] - box.center()) * 2.5);
  const std::size_t n = x.size(), c = field.components();
  EvaluatedField a{std::vector<double>(n * c), std::vector<double>(n), std::vector<Vec3>(n * c),
                   std::vector<std::uint8_t>(n), std::vector<std::uint8_t>(n)};
  field.evaluate(x, {a.values, a.gradients, a.inside});
  if (const auto* const polynomials = dynamic_cast<const DegreeField*>(&field)) polynomials->degrees(x, a.degrees);
  field.spacing(x, a.spacing);
  return a;
}

class VolumeFile : public ::testing::Test {
 protected:
  VolumeDataset stored(const FittedVolume& fitted) {
    write_volume_file(folder_ / "f.smv", fitted);
    return VolumeDataset(read_volume_file(folder_ / "f.smv"));
  }

  void expect_same_field(const GridData& data, const VolumeReconstructionOptions& options) {
    Progress progress;
    VolumeDataset dataset(data);
    VolumeReconstructionReport report, again;
    const auto field = dataset.field({"f", {}, false}, options, progress, &report);
    const auto volume = dataset.volume("f", progress);
    VolumeDataset opened = stored(dataset.fit("f", options, false, progress));
    const auto same = opened.field({"f", {}, false}, options, progress, &again);
    EXPECT_EQ(opened.volume("f", progress)->size(), volume->size());
    EXPECT_TRUE(evaluated(*field, *volume) == evaluated(*same, *volume));
    EXPECT_EQ(report.by_degree, again.by_degree);
    EXPECT_EQ(report.notes, again.notes);
    EXPECT_EQ(report.options.epsilon, again.options.epsilon);
    EXPECT_EQ(report.options.degree, again.options.degree);
  }

  Folder folder_;
};

TEST_F(VolumeFile, AnswersTheSameToTheBitOnEveryGrid) {
  for (const test::NamedGrid& grid : all_grids(wavy))
    for (const Method method : {"mls-detail", "linear"}) {
      SCOPED_TRACE(grid.name + " " + method);
      expect_same_field(only(grid.data, grid.association), by(method));
    }
}

TEST_F(VolumeFile, AnswersTheSameToTheBitByAmls) {
  VolumeReconstructionOptions few = by("amls");
  few.iterations = 2, few.order = 4;
  for (const test::NamedGrid& grid : all_grids(wavy)) {
    SCOPED_TRACE(grid.name);
    expect_same_field(only(grid.data, grid.association), few);
  }
  expect_same_field(bent_grid({6, 7, 5}, wavy), by("amls"));  // shape and iterations chosen from the data
  expect_same_field(lattice_grid({6, 5, 7}, wavy), by("amls"));
}

TEST_F(VolumeFile, AnswersTheSameToTheBitByMethodsWithoutCoefficients) {
  for (const VolumeMethod* const info : VolumeMethod::registry().all()) {
    SCOPED_TRACE(info->name);
    expect_same_field(lattice_grid({7, 6, 5}, wavy), by(std::string(info->name)));
  }
  VolumeReconstructionOptions spline = by("cubic");
  spline.b = 1, spline.c = 0;
  expect_same_field(lattice_grid({7, 6, 5}, wavy), spline);
  VolumeReconstructionOptions wide = by("shepard");
  wide.radius = 3;
  expect_same_field(bent_grid({6, 7, 5}, wavy), wide);
}

TEST_F(VolumeFile, UsesStoredCoefficientsInsteadOfAFit) {
  // Adding a half to each coefficient adds a half everywhere where linear interpolation, which uses the unchanged
  // values in the file, has no share.
  Progress progress;
  VolumeDataset dataset(bent_grid({6, 7, 5}, wavy));
  write_volume_file(folder_ / "f.smv", dataset.fit("f", by("amls"), false, progress));
  const auto answers_with = [&](double more, const std::string& name) {
    std::vector<RawSection> sections = unpacked(slurp(folder_ / "f.smv"));
    for (RawSection& s : sections) {
      for (std::size_t at = 0; s.name == "CONSTANT" && at < s.bytes.size(); at += 8)
        put_number(s.bytes, at, number_at<double>(s.bytes, at) + more);
      for (std::size_t at = 0; s.name == "TRUST" && at < s.bytes.size(); at += 4) put_number(s.bytes, at, 1.0f);
    }
    VolumeDataset opened(read_volume_file(folder_.put(name, packed(sections, "SMV", 0))));
    const auto volume = opened.volume("f", progress);
    return evaluated(*opened.field({"f", {}, false}, by("amls"), progress), *volume);
  };
  const auto before = answers_with(0, "same.smv"), after = answers_with(0.5, "more.smv");
  for (std::size_t i = 0; i < before.values.size(); ++i) EXPECT_NEAR(after.values[i], before.values[i] + 0.5, 1e-5);
}

TEST_F(VolumeFile, IsDeterministicAndRewritesIdentically) {
  const auto bytes = [&] {
    Progress progress;
    VolumeDataset dataset(three_overlapping_blocks(6, wavy));
    write_volume_file(folder_ / "t.smv", dataset.fit("f", by("mls-detail"), true, progress));
    return slurp(folder_ / "t.smv");
  };
  expect_equal_for_any_threads(bytes);
  const std::string once = bytes();
  write_volume_file(folder_ / "again.smv", read_volume_file(folder_ / "t.smv"));
  EXPECT_TRUE(slurp(folder_ / "again.smv") == once);
  Progress progress;
  VolumeDataset opened(read_volume_file(folder_ / "t.smv"));
  write_volume_file(folder_ / "fit.smv", opened.fit("f", by("mls-detail"), true, progress));
  EXPECT_TRUE(slurp(folder_ / "fit.smv") == once);
}

TEST_F(VolumeFile, MayBeGzipped) {
  Progress progress;
  VolumeDataset dataset(two_level_amr(8, wavy));
  const FittedVolume fitted = dataset.fit("f", by("mls-detail"), false, progress);
  write_volume_file(folder_ / "f.smv", fitted);
  write_volume_file(folder_ / "f.smv.gz", fitted);
  EXPECT_TRUE(is_volume_file("a/F.SMV.gz"));
  EXPECT_FALSE(is_volume_file("a/f.smf"));
  EXPECT_LT(slurp(folder_ / "f.smv.gz").size(), slurp(folder_ / "f.smv").size());
  write_volume_file(folder_ / "unpacked.smv", read_volume_file(folder_ / "f.smv.gz"));
  EXPECT_TRUE(slurp(folder_ / "unpacked.smv") == slurp(folder_ / "f.smv"));
}

/// Two point arrays, one with three components and an unknown value, and one cell array.
GridData several_arrays() {
  GridData data = bent_grid({5, 6, 4}, wavy);
  data.format = "made grid";
  data.notes = {"one note"};
  data.time = 0.25;
  GridBlock& block = data.blocks[0];
  std::vector<float> where;
  for (const Vec3& x : block.points)
    for (std::size_t k = 0; k < 3; ++k) where.push_back(static_cast<float>(x[k]));
  where[7] = std::nanf("");
  block.point_arrays.set("where", std::move(where), 3);
  block.cell_arrays.set("ids", std::vector<std::int16_t>(4 * 5 * 3, 3));
  return data;
}

TEST_F(VolumeFile, KeepsArraysFactsAndNotes) {
  Progress progress;
  VolumeDataset dataset(several_arrays());
  VolumeDataset opened = stored(dataset.fit("where", by("linear"), true, progress));
  EXPECT_EQ(opened.default_array().name, "where");
  ASSERT_EQ(opened.arrays().size(), 2u);  // no cell arrays
  for (const DatasetArray& a : opened.arrays()) {
    const DatasetArray& b = dataset.array(a.name);
    EXPECT_EQ(a.of, Association::points);
    EXPECT_EQ(a.type, b.type);
    EXPECT_EQ(a.least, b.least);
    EXPECT_EQ(a.most, b.most);
    EXPECT_EQ(a.not_finite, b.not_finite);
  }
  EXPECT_EQ(opened.format(), "fitted volume of made grid");
  EXPECT_EQ(opened.notes(), dataset.notes());
  EXPECT_EQ(opened.time(), 0.25);
  const auto made = dataset.volume("where", progress), read = opened.volume("where", progress);
  EXPECT_EQ(read->facts.grid, made->facts.grid);
  EXPECT_EQ(read->facts.median_spacing, made->facts.median_spacing);
  EXPECT_EQ(read->facts.aspect, made->facts.aspect);
  EXPECT_EQ(read->positions, made->positions);
  EXPECT_EQ(read->stars.entries, made->stars.entries);
  EXPECT_EQ(read->cells.first, made->cells.first);
  EXPECT_EQ(*read->attributes.find("f"), *made->attributes.find("f"));
  EXPECT_THROW(opened.volume(Association::cells, progress), DataError);
}

TEST_F(VolumeFile, ReconstructsOtherRequestsAgain) {
  Progress progress;
  VolumeDataset dataset(several_arrays());
  VolumeReconstructionOptions planes = by("mls-detail");
  planes.degree = 1;
  VolumeDataset opened = stored(dataset.fit("f", planes, true, progress));
  const auto volume = dataset.volume("f", progress);
  const auto expect_same = [&](const char* array, const VolumeReconstructionOptions& options) {
    EXPECT_TRUE(evaluated(*dataset.field({array, {}, false}, options, progress), *volume) ==
                evaluated(*opened.field({array, {}, false}, options, progress), *volume))
        << array << " " << *options.method;
  };
  expect_same("where", by("mls-detail"));
  expect_same("f", by("linear"));
  VolumeReconstructionOptions cubics = by("mls-detail");
  cubics.degree = 3;
  expect_same("f", cubics);
  // Absent options match those of the file.
  VolumeReconstructionReport report;
  opened.field({"f", {}, false}, by("mls-detail"), progress, &report);
  EXPECT_EQ(report.options.degree, 1);
  EXPECT_EQ(report.by_degree[2] + report.by_degree[3], 0u);
}

TEST_F(VolumeFile, ErrorsNameItsArrays) {
  Progress progress;
  VolumeDataset dataset(several_arrays());
  VolumeDataset opened = stored(dataset.fit("f", by("linear"), false, progress));
  try {
    opened.choose("where");
    FAIL() << "there is no such array";
  } catch (const ArgumentError& error) {
    EXPECT_NE(std::string(error.what()).find("holds f"), std::string::npos) << error.what();
  }
  EXPECT_THROW(opened.field({"f", {}, false}, by("cubic"), progress), ArgumentError);  // no lattice
}

TEST_F(VolumeFile, FailedWritesLeaveNoFile) {
  Progress progress;
  VolumeDataset dataset(several_arrays());
  FittedVolume fitted = dataset.fit("f", by("mls-detail"), false, progress);
  const std::string missing = folder_ / "missing/f.smv", twice = folder_ / "twice.smv", none = folder_ / "none.smv";
  expect_file_error(missing, "", [&] { write_volume_file(missing, fitted); });
  fitted.arrays.push_back(fitted.arrays[0]);
  expect_file_error(twice, "two arrays f", [&] { write_volume_file(twice, fitted); });
  fitted.arrays.clear();
  expect_file_error(none, "cannot hold this volume", [&] { write_volume_file(none, fitted); });
  EXPECT_EQ(folder_.entries(), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
