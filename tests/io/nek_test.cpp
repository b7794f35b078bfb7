// Nek5000 fields, planar and spatial, in both byte orders and number sizes.
#include <fmt/format.h>

#include "sample_files.h"
#include "sansmesh/cell_list.h"
#include "support/places.h"
#include "volume_test_tools.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct NekLayout {
  std::array<int, 3> dims{4, 3, 1};  ///< points per element
  int real = 4;
  bool big = false;
  std::string fields = "XUPT";
  double time = 0.25;
  std::vector<int> elements{1, 2};  ///< their numbers in the file
  int all = 2, part = 0, parts = 1;

  int axes() const { return dims[2] > 1 ? 3 : 2; }
};

/// Point (i, j, k) of an element: elements are adjacent along x and have a common border.
Vec3 nek_place(const NekLayout& l, int element, int i, int j, int k) {
  const double u = i / double(l.dims[0] - 1);
  return {element + u * u, 0.5 * j + 0.125 * u, l.dims[2] > 1 ? 0.25 * k : 0.0};
}
/// Component c of a field at that point.
double nek_number(char field, const Vec3& x, int c) { return field + c + 2 * x.x - x.y + 4 * x.z; }

std::string nek_header(const NekLayout& l) {
  std::string h = fmt::format("#std {} {:2} {:2} {:2} {:10} {:10} {:20.13e} {:9} {:6} {:6} {}", l.real, l.dims[0],
                              l.dims[1], l.dims[2], l.elements.size(), l.all, l.time, 100, l.part, l.parts, l.fields);
  h.resize(132, ' ');
  return h + raw(6.54321f, l.big);
}

std::string nek_file(const NekLayout& l) {
  std::string bytes = nek_header(l);
  for (const int e : l.elements) bytes += raw(static_cast<std::uint32_t>(e), l.big);
  const auto add = [&](char field, int components) {
    for (const int e : l.elements)
      for (int c = 0; c < components; ++c)
        for (int k = 0; k < l.dims[2]; ++k)
          for (int j = 0; j < l.dims[1]; ++j)
            for (int i = 0; i < l.dims[0]; ++i) {
              const Vec3 x = nek_place(l, e, i, j, k);
              const double v = field == 'X' ? x[static_cast<std::size_t>(c)] : nek_number(field, x, c);
              bytes += l.real == 8 ? raw(v, l.big) : raw(static_cast<float>(v), l.big);
            }
  };
  for (const char field : l.fields) {
    if (field == 'X' || field == 'U') add(field, l.axes());
    if (field == 'P' || field == 'T') add(field, 1);
    if (field >= '1' && field <= '9')
      for (int s = 0; s < field - '0'; ++s) add(static_cast<char>('a' + s), 1);
  }
  return bytes;
}

void expect_nek_numbers(const GridData& data, const NekLayout& l) {
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  const std::size_t n = static_cast<std::size_t>(l.dims[0] * l.dims[1] * l.dims[2]);
  ASSERT_EQ(b.points.size(), n * static_cast<std::size_t>(l.all));
  const std::size_t pieces =
      static_cast<std::size_t>((l.dims[0] - 1) * (l.dims[1] - 1) * std::max(1, l.dims[2] - 1) * l.all);
  EXPECT_EQ(l.dims[2] > 1 ? b.cells.size() : b.flat_cells.size(), pieces);
  EXPECT_TRUE(l.dims[2] > 1 ? b.flat_cells.empty() : b.cells.empty());
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    const Vec3& x = b.points[i];
    for (int c = 0; c < l.axes(); ++c)
      EXPECT_NEAR(number(b.point_arrays, "Velocity", 3 * i + static_cast<std::size_t>(c)), nek_number('U', x, c), 1e-4);
    if (l.axes() == 2) {
      EXPECT_EQ(number(b.point_arrays, "Velocity", 3 * i + 2), 0);
    }
    EXPECT_NEAR(number(b.point_arrays, "Pressure", i), nek_number('P', x, 0), 1e-4);
    EXPECT_NEAR(number(b.point_arrays, "Temperature", i), nek_number('T', x, 0), 1e-4);
  }
  // The cells of an element fill it: their corners are consecutive along its axes.
  double size = 0;
  for (std::size_t c = 0; c < b.flat_cells.size(); ++c) {
    const auto at = [&](std::size_t k) { return b.points[b.flat_cells[c][k]]; };
    size += cross(at(2) - at(0), at(3) - at(1)).z / 2;
  }
  for (std::size_t c = 0; c < b.cells.size(); ++c)
    for (const CellFace& f : cell_faces(CellShape::hexahedron)) {
      const auto at = [&](std::size_t k) { return b.points[b.cells[c][f.corner[k]]]; };
      for (std::size_t k = 2; k < 4; ++k) size += dot(at(0), cross(at(k - 1), at(k))) / 6;
    }
  EXPECT_NEAR(size, l.all * 0.5 * (l.dims[1] - 1) * (l.dims[2] > 1 ? 0.25 * (l.dims[2] - 1) : 1), 1e-5);
}

TEST(Nek5000, FieldsInAllLayouts) {
  const Folder folder;
  for (const int nz : {1, 3})
    for (const int real : {4, 8})
      for (const bool big : {false, true}) {
        NekLayout l;
        l.dims[2] = nz, l.real = real, l.big = big;
        const GridData data = read_volume(folder.put("flow0.f00001", nek_file(l)));
        expect_nek_numbers(data, l);
        EXPECT_EQ(data.blocks[0].point_arrays.find("Pressure")->type(), real == 8 ? NumberType::f64 : NumberType::f32);
        EXPECT_EQ(data.time, 0.25);
        EXPECT_TRUE(data.notes.empty());
      }
}

TEST(Nek5000, ScalarsAndBoundsBehindThemAreRead) {
  const Folder folder;
  NekLayout l;
  l.fields = "XUPTS02";
  const std::string bytes = nek_file(l);
  const GridData data = read_volume(folder.put("a0.f00007", bytes));
  expect_nek_numbers(data, l);
  for (std::size_t i = 0; i < data.blocks[0].points.size(); ++i) {
    EXPECT_NEAR(number(data.blocks[0].point_arrays, "S01", i), nek_number('a', data.blocks[0].points[i], 0), 1e-4);
    EXPECT_NEAR(number(data.blocks[0].point_arrays, "S02", i), nek_number('b', data.blocks[0].points[i], 0), 1e-4);
  }
  // The least and greatest value of each of the 8 numbers per point, for each element.
  EXPECT_TRUE(read_volume(folder.put("a0.f00007", bytes + std::string(2 * 8 * 8, '\0'))).notes.empty());
  EXPECT_EQ(read_volume(folder.put("a0.f00007", bytes + "?")).notes.size(), 1u);
}

TEST(Nek5000, SeriesTakeCoordinatesFromBefore) {
  const Folder folder;
  NekLayout l;
  folder.put("flow0.f00003", nek_file(l));
  l.fields = "UPT", l.elements = {2, 1}, l.time = 0.5;
  folder.put("flow0.f00004", nek_file(l));
  const std::string series =
      folder.put("flow.nek5000", "filetemplate: flow%01d.f%05d\nfirsttimestep: 3\nnumtimesteps: 2\n");
  for (const std::size_t step : {0u, 1u}) {
    VolumeReadOptions options;
    options.time_step = step;
    const GridData data = read_volume(series, options);
    expect_nek_numbers(data, l);
    EXPECT_EQ(data.times, (std::vector<double>{0.25, 0.5}));
    EXPECT_EQ(data.time, data.times[step]);
  }
  VolumeReadOptions beyond;
  beyond.time_step = 2;
  EXPECT_THROW(read_volume(series, beyond), ArgumentError);
  EXPECT_TRUE(is_volume_name("flow.nek5000"));
  EXPECT_TRUE(is_volume_name("flow0.f00001"));
  EXPECT_FALSE(is_volume_name("flow.fifth"));
  // An interrupted run has fewer files than its series announces.
  const GridData stopped =
      read_volume(folder.put("more.nek5000", "filetemplate: flow%01d.f%05d\nfirsttimestep: 3\nnumtimesteps: 5\n"));
  EXPECT_EQ(stopped.times.size(), 2u);
  EXPECT_EQ(stopped.notes.size(), 1u);
}

TEST(Nek5000, StepsMayHaveSeveralParts) {
  const Folder folder;
  NekLayout l;
  l.parts = 2;
  for (const int part : {0, 1}) {
    l.part = part, l.elements = {2 - part};
    std::filesystem::create_directories(folder / ("A0" + std::to_string(part)));
    folder.put("flow" + std::to_string(part) + ".f00001", nek_file(l));
    folder.put("A0" + std::to_string(part) + "/flow0" + std::to_string(part) + ".f00001", nek_file(l));
  }
  const std::string rest = "\nfirsttimestep: 1\nnumtimesteps: 1\n";
  expect_nek_numbers(read_volume(folder.put("a.nek5000", "filetemplate: flow%01d.f%05d" + rest)), l);
  expect_nek_numbers(read_volume(folder.put("b.nek5000", "filetemplate: A%02d/flow%02d.f%05d" + rest)), l);
  expect_no_volume(folder / "flow0.f00001", "one of several parts");
  const std::string one = folder.put("c.nek5000", "filetemplate: flow0.f%05d" + rest);
  expect_no_volume(one, "no number for them");
}

TEST(Nek5000, PartsOfAStepHaveTheSameFieldsAndAllElements) {
  const Folder folder;
  const std::string series =
      folder.put("a.nek5000", "filetemplate: flow%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 1\n");
  const auto put = [&](const char* first, const char* second, std::vector<int> elements, int parts) {
    NekLayout l;
    l.parts = 2, l.fields = first, l.elements = {1};
    folder.put("flow0.f00001", nek_file(l));
    l.part = 1, l.parts = parts, l.fields = second, l.elements = std::move(elements);
    folder.put("flow1.f00001", nek_file(l));
  };
  const auto refused = [&](const char* file, const char* why) {
    expect_file_error(folder / file, why, [&] { read_volume(series); });
  };
  put("XPS02", "XPS02", {2}, 2);
  EXPECT_EQ(read_volume(series).blocks[0].points.size(), 24u);
  // As many numbers per point, of other fields.
  put("XPS02", "XPTS01", {2}, 2);
  refused("flow1.f00001", "has another layout");
  put("XP", "XT", {2}, 2);
  refused("flow1.f00001", "has another layout");
  put("XU", "XPT", {2}, 2);
  refused("flow1.f00001", "has another layout");
  put("XP", "XP", {2}, 3);
  refused("flow1.f00001", "has another layout");
  put("XP", "XP", {1}, 2);
  refused("flow0.f00001", "holds 1 of 2 elements");
  NekLayout one;
  one.elements = {2};
  expect_no_volume(folder.put("flow0.f00002", nek_file(one)), "holds 1 of 2 elements");
}

TEST(Nek5000, StepsThatAreNotAskedForMayBeDamaged) {
  const Folder folder;
  NekLayout l;
  folder.put("flow0.f00001", nek_file(l));
  folder.put("flow0.f00002", "no step");
  l.time = 0.75;
  // Truncated after its header: unused data are not read.
  folder.put("flow0.f00003", nek_file(l).substr(0, 136));
  folder.put("flow0.f00004", gzip(nek_file(l)));
  const std::string series =
      folder.put("a.nek5000", "filetemplate: flow%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 4\n");
  const GridData data = read_volume(series);
  expect_nek_numbers(data, l);
  ASSERT_EQ(data.times.size(), 4u);
  EXPECT_EQ(data.times[0], 0.25);
  EXPECT_TRUE(std::isnan(data.times[1]));
  EXPECT_EQ(data.times[2], 0.75);
  EXPECT_EQ(data.times[3], 0.75);
  EXPECT_EQ(data.notes.size(), 1u);
  VolumeReadOptions options;
  options.time_step = 1;
  expect_file_error(folder / "flow0.f00002", "#std", [&] { read_volume(series, options); });
  options.time_step = 2;
  expect_file_error(folder / "flow0.f00003", "truncated", [&] { read_volume(series, options); });
  options.time_step = 3;
  expect_nek_numbers(read_volume(series, options), l);
}

TEST(Nek5000, WhatIsWrongIsSaidInOneLine) {
  const Folder folder;
  NekLayout l;
  const std::string whole = nek_file(l);
  for (std::size_t n = 5; n < whole.size(); n += 13)
    expect_no_volume(folder.put("flow0.f00001", whole.substr(0, n)), "");
  expect_no_volume(folder.put("flow0.f00001", whole.substr(0, whole.size() - 3)), "truncated: 3 bytes are missing");
  expect_no_volume(folder.put("flow0.f00001", "*" + whole.substr(1)), "#std");
  const auto with = [&](std::size_t at, const std::string& text) {
    std::string bytes = whole;
    bytes.replace(at, text.size(), text);
    return folder.put("flow0.f00001", bytes);
  };
  expect_no_volume(with(5, "3"), "not 4 or 8");
  expect_no_volume(with(7, " 1"), "elements of 1 x 3 x 1 points");
  expect_no_volume(with(10, " x"), "numbers are missing");
  expect_no_volume(with(132, "????"), "no byte order");
  l.fields = "XQ";
  expect_no_volume(folder.put("flow0.f00001", nek_file(l)), "'Q'");
  l.fields = "XS";
  expect_no_volume(folder.put("flow0.f00001", nek_file(l)), "no number of scalars");
  l.fields = "UPT";
  expect_no_volume(folder.put("flow0.f00001", nek_file(l)), "no coordinates");
  NekLayout many;
  std::string lies = nek_header(many);
  lies.replace(16, 10, "2000000000");
  expect_no_volume(folder.put("flow0.f00001", lies), "truncated");
  // Four times that exceeds 64 bits.
  const std::string too_many = fmt::format(" {}", std::uint64_t{1} << 62), behind = lies.substr(26);
  std::string overflowing = lies.substr(0, 15) + too_many + behind;
  overflowing.erase(127, overflowing.size() - lies.size());
  expect_no_volume(folder.put("flow0.f00001", overflowing), "an impossible number of values");

  const auto series = [&](const std::string& text) { return folder.put("a.nek5000", text); };
  expect_no_volume(series("nothing\n"), "filetemplate");
  expect_no_volume(series("filetemplate: flow%s\nfirsttimestep: 1\nnumtimesteps: 1\n"), "not of %d");
  expect_no_volume(series("filetemplate: flow\nfirsttimestep: 1\nnumtimesteps: 1\n"), "one to three numbers");
  expect_no_volume(series("filetemplate: flow%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: many\n"), "numtimesteps");
  const std::string gone = series("filetemplate: gone%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 1\n");
  expect_file_error(folder / "gone0.f00001", "", [&] { read_volume(gone); });
  NekLayout first, second;
  first.fields = "XU", second.fields = "U", second.elements = {1, 3};
  folder.put("b0.f00001", nek_file(first));
  folder.put("b0.f00002", nek_file(second));
  VolumeReadOptions options;
  options.time_step = 1;
  const std::string other = series("filetemplate: b%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 2\n");
  expect_no_volume(other, "same elements", options);
}

TEST(ExtraNek5000, EddyHasItsElements) {
  const std::string file = shared_points("../flow/eddy_uv/eddy_uv.nek5000");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no ../shared/data/flow beside the checkout";
  VolumeReadOptions options;
  options.time_step = 10;
  const GridData data = read_volume(file, options);
  EXPECT_EQ(data.times.size(), 11u);
  EXPECT_NEAR(*data.time, 0.1, 1e-9);
  EXPECT_EQ(data.blocks[0].points.size(), 256u * 64);
  EXPECT_EQ(data.blocks[0].flat_cells.size(), 256u * 49);
}

}  // namespace
}  // namespace sansmesh::inline v1
