// PLOT3D in all of its layouts.
#include "volume_test_tools.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct Layout {
  bool marks, big, multi, iblank, flat, wide;
};

/// Numbers of a file: integers and reals, in records.
class P3dWriter {
 public:
  explicit P3dWriter(const Layout& layout) : l_(layout) {}
  void begin() { start_ = bytes.size(); }
  void whole(int v) { bytes += raw(static_cast<std::int32_t>(v), l_.big); }
  void real(double v) { bytes += l_.wide ? raw(v, l_.big) : raw(static_cast<float>(v), l_.big); }
  void end() {
    if (!l_.marks) return;
    const std::string mark = raw(static_cast<std::uint32_t>(bytes.size() - start_), l_.big);
    bytes.insert(start_, mark);
    bytes += mark;
  }
  std::string bytes;

 private:
  Layout l_;
  std::size_t start_ = 0;
};

using Dims = std::vector<std::array<int, 3>>;

void write_sizes(P3dWriter& w, const Layout& l, const Dims& dims, int functions = 0) {
  if (l.multi) w.begin(), w.whole(static_cast<int>(dims.size())), w.end();
  w.begin();
  for (const auto& d : dims) {
    for (int k = 0; k < (l.flat ? 2 : 3); ++k) w.whole(d[static_cast<std::size_t>(k)]);
    if (functions > 0) w.whole(functions);
  }
  w.end();
}

double coordinate(std::size_t grid, std::size_t i, int axis) {
  return static_cast<double>(grid) * 100 + static_cast<double>(i) * 0.5 + axis * 0.25;
}
int blank(std::size_t i) { return i % 5 == 2 ? 0 : i % 7 == 3 ? -4 : 1; }

std::string grid_file(const Layout& l, const Dims& dims) {
  P3dWriter w(l);
  write_sizes(w, l, dims);
  for (std::size_t g = 0; g < dims.size(); ++g) {
    const std::size_t n = static_cast<std::size_t>(dims[g][0] * dims[g][1] * dims[g][2]);
    w.begin();
    for (int k = 0; k < (l.flat ? 2 : 3); ++k) {
      for (std::size_t i = 0; i < n; ++i) w.real(coordinate(g, i, k));
    }
    for (std::size_t i = 0; i < n && l.iblank; ++i) w.whole(blank(i));
    w.end();
  }
  return w.bytes;
}

/// Density 2, momentum (i, 2, 3), energy such that the pressure is i.
std::string solution_file(const Layout& l, const Dims& dims) {
  P3dWriter w(l);
  write_sizes(w, l, dims);
  for (const auto& d : dims) {
    const std::size_t n = static_cast<std::size_t>(d[0] * d[1] * d[2]);
    w.begin();
    for (const double v : {0.5, 1.0, 1e6, 0.0}) w.real(v);
    w.end();
    w.begin();
    for (std::size_t i = 0; i < n; ++i) w.real(2);
    for (int k = 0; k < (l.flat ? 2 : 3); ++k) {
      for (std::size_t i = 0; i < n; ++i) w.real(k == 0 ? static_cast<double>(i) : k + 1);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double x = static_cast<double>(i);
      w.real(x / 0.4 + (x * x + 4 + (l.flat ? 0 : 9)) / 4);
    }
    w.end();
  }
  return w.bytes;
}

class EveryLayout : public ::testing::TestWithParam<int> {
 protected:
  Layout layout() const {
    const int b = GetParam();
    return {(b & 1) != 0, (b & 2) != 0, (b & 4) != 0, (b & 8) != 0, (b & 16) != 0, (b & 32) != 0};
  }
  Dims dims() const {
    const Layout l = layout();
    if (l.flat) return l.multi ? Dims{{6, 5, 1}, {3, 4, 1}} : Dims{{6, 5, 1}};
    return l.multi ? Dims{{4, 3, 5}, {2, 6, 3}, {3, 3, 2}} : Dims{{4, 3, 5}};
  }
};
INSTANTIATE_TEST_SUITE_P(Plot3d, EveryLayout, ::testing::Range(0, 64));

TEST_P(EveryLayout, GridAndSolutionAreReadBack) {
  const Folder folder;
  const Layout l = layout();
  const Dims sizes = dims();
  folder.put("flowq.bin", solution_file(l, sizes));
  const GridData data = read_volume(folder.put("flowxyz.bin", grid_file(l, sizes)));
  ASSERT_EQ(data.blocks.size(), sizes.size());
  for (std::size_t g = 0; g < sizes.size(); ++g) {
    const GridBlock& b = data.blocks[g];
    ASSERT_EQ(b.kind, GridKind::curvilinear);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(b.dims[k], static_cast<std::size_t>(sizes[g][k]));
    ASSERT_EQ(b.hidden_points.size(), l.iblank ? b.points.size() : 0u);
    for (std::size_t i = 0; i < b.points.size(); ++i) {
      EXPECT_EQ(b.points[i], (Vec3{coordinate(g, i, 0), coordinate(g, i, 1), l.flat ? 0 : coordinate(g, i, 2)}));
      if (l.iblank) EXPECT_EQ(b.hidden_points[i] != 0, blank(i) == 0);
      const double x = static_cast<double>(i), z = l.flat ? 0 : 3;
      EXPECT_EQ(number(b.point_arrays, "Density", i), 2);
      EXPECT_EQ(number(b.point_arrays, "Momentum", 3 * i), x);
      EXPECT_EQ(number(b.point_arrays, "Momentum", 3 * i + 2), z);
      EXPECT_EQ(number(b.point_arrays, "Velocity", 3 * i), x / 2);
      EXPECT_EQ(number(b.point_arrays, "Velocity", 3 * i + 1), 1);
      EXPECT_NEAR(number(b.point_arrays, "Pressure", i), x, 1e-5 * (1 + x * x));
    }
    EXPECT_EQ(b.point_arrays.find("StagnationEnergy")->type(), l.wide ? NumberType::f64 : NumberType::f32);
  }
}

TEST_P(EveryLayout, TruncatedAndGarbledFilesAreErrors) {
  const Folder folder;
  const std::string grid = grid_file(layout(), dims()), solution = solution_file(layout(), dims());
  folder.put("flowq.bin", solution);
  // Truncated files may match another layout, but never return numbers of the wrong array.
  for (std::size_t n = 1; n < grid.size(); n += 1 + n / 5)
    EXPECT_FALSE(volume_readable(folder.put("flowxyz.bin", grid.substr(0, grid.size() - n))));
  folder.put("flowxyz.bin", grid);
  for (std::size_t n = 1; n < solution.size(); n += 1 + n / 5) {
    folder.put("flowq.bin", solution.substr(0, solution.size() - n));
    expect_file_error(folder / "flowq.bin", "", [&] { read_volume(folder / "flowxyz.bin"); });
  }
  folder.put("flowq.bin", solution);
  std::mt19937 random(3);
  for (int k = 0; k < 20; ++k) {
    std::string garbled = grid;
    for (int j = 0; j < 3; ++j) garbled[random() % 40] = static_cast<char>(random() % 256);
    volume_readable(folder.put("flowxyz.bin", garbled));
  }
}

constexpr Layout kPlain{false, true, false, false, false, false};

TEST(Plot3d, Text) {
  const Folder folder;
  const std::string grid =
      folder.put("wing.xyz", "1\n 2 2 2\n 0 1 0 1, 0 1 0 1\n 2*0 2*1 2*0.0D+00 2*1.0d+0\n 4*0 4*1\n 8*1\n");
  folder.put("wing.q", "1\n2 2 2\n.5 0 1 0\n8*1\n8*2 8*0 8*0\n8*4\n");
  const GridData data = read_volume(grid);
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(b.points[i],
              (Vec3(static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2))));
    EXPECT_EQ(number(b.point_arrays, "Velocity", 3 * i), 2);
    EXPECT_NEAR(number(b.point_arrays, "Pressure", i), 0.4 * (4 - 2), 1e-12);
  }
  EXPECT_TRUE(b.hidden_points.empty());
  // The points are still read.
  EXPECT_EQ(read_volume(folder.put("cloud.xyz", "0 0 0\n1 0 0\n0 1 0\n")).blocks[0].kind, GridKind::scattered);
}

TEST(Plot3d, FunctionsAndSolutionsByName) {
  const Folder folder;
  const Dims sizes{{4, 3, 5}};
  const std::string grid = folder.put("flow.x", grid_file(kPlain, sizes));
  EXPECT_TRUE(read_volume(grid).blocks[0].point_arrays.empty());
  P3dWriter w(kPlain);
  write_sizes(w, kPlain, sizes, 2);
  for (int i = 0; i < 120; ++i) w.real(i);
  folder.put("flow.f", w.bytes);
  const GridData data = read_volume(grid);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_EQ(number(data.blocks[0].point_arrays, "Function_1", i), static_cast<double>(i));
    EXPECT_EQ(number(data.blocks[0].point_arrays, "Function_2", i), static_cast<double>(60 + i));
  }
  const std::string named = folder.put("elsewhere.dat", solution_file(kPlain, sizes));
  EXPECT_NE(read_volume(grid, {.solution = named}).blocks[0].point_arrays.find("Density"), nullptr);
  // Bytes after the numbers are ignored with a warning.
  folder.put("elsewhere.dat", solution_file(kPlain, sizes) + std::string(100, '\0'));
  const GridData longer = read_volume(grid, {.solution = named});
  EXPECT_NE(longer.blocks[0].point_arrays.find("Density"), nullptr);
  ASSERT_EQ(longer.notes.size(), 1u);
  EXPECT_NE(longer.notes[0].find("100 bytes"), std::string::npos);
}

TEST(Plot3d, WhatDoesNotBelongTogether) {
  const Folder folder;
  const std::string grid = folder.put("flowxyz.bin", grid_file(kPlain, {{4, 3, 5}}));
  const std::string q = folder.put("flowq.bin", solution_file(kPlain, {{4, 3, 6}}));
  expect_file_error(q, "4 x 3 x 6 points, the grid 4 x 3 x 5", [&] { read_volume(grid); });
  expect_no_volume(q, "is the solution of a PLOT3D grid");
  expect_file_error(folder / "gone", "no such file", [&] { read_volume(grid, {.solution = folder / "gone"}); });
  // One point with iblank, or one grid of one point: ambiguous.
  std::string both;
  for (const int v : {1, 1, 1, 1, 0, 0, 1}) both += raw(v);
  expect_no_volume(folder.put("both.bin", both), "ambiguous");
  expect_no_volume(folder.put("noise.bin", std::string(1000, '\x7f')), "fits no layout");
}

TEST(Plot3d, NoPressureWithoutEnergyAndNoVelocityWithoutDensity) {
  const Folder folder;
  const std::string grid = folder.put("flowxyz.bin", grid_file(kPlain, {{2, 2, 2}}));
  P3dWriter w(kPlain);
  write_sizes(w, kPlain, {{2, 2, 2}});
  for (int i = 0; i < 4; ++i) w.real(0);
  for (int i = 0; i < 8; ++i) w.real(i);
  for (int i = 0; i < 24; ++i) w.real(1);
  for (int i = 0; i < 8; ++i) w.real(0);
  folder.put("flowq.bin", w.bytes);
  const GridData data = read_volume(grid);
  EXPECT_EQ(data.blocks[0].point_arrays.find("Pressure"), nullptr);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_TRUE(std::isfinite(number(data.blocks[0].point_arrays, "Velocity", i)));
}

TEST(VolumeFiles, SeveralAsOneInTheirOrder) {
  const Folder folder;
  const std::string a = folder.put("a.xyz", "0 0 0\n1 0 0\n0 1 0\n"),
                    b = folder.put("b.csv", "x,y,z,temp\n1,2,3,4\n5,6,7,8\n9,1,2,3\n");
  const GridData data = read_volumes({b, a});
  ASSERT_EQ(data.blocks.size(), 2u);
  EXPECT_EQ(data.blocks[0].name, "b");
  EXPECT_EQ(data.blocks[1].name, "a");
  EXPECT_EQ(data.blocks[0].kind, GridKind::scattered);
  EXPECT_EQ(data.blocks[0].points[1], (Vec3{5, 6, 7}));
  EXPECT_EQ(number(data.blocks[0].point_arrays, "temp", 2), 3);
  EXPECT_THROW(read_volumes({}), ArgumentError);
  // A grid and its solution are one volume.
  const std::string grid = folder.put("flowxyz.bin", grid_file(kPlain, {{4, 3, 5}}));
  const std::string q = folder.put("flowq.bin", solution_file(kPlain, {{4, 3, 5}}));
  const GridData flow = read_volumes({grid, q});
  ASSERT_EQ(flow.blocks.size(), 1u);
  EXPECT_EQ(flow.blocks[0].name, "");
  EXPECT_EQ(read_volumes({grid, q, a}).blocks.size(), 2u);
}

TEST(VolumeFiles, CollectionsHaveTimesAndParts) {
  const Folder folder;
  const auto image = [](char c) {
    return "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string(8, c);
  };
  folder.put("a.mha", image(1)), folder.put("b.mha", image(2)), folder.put("c.mha", image(3));
  const std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\">\n<Collection>\n"
      "<DataSet timestep=\"2.5\" part=\"0\" file=\"b.mha\"/>\n<DataSet timestep=\"1\" part=\"0\" file=\"a.mha\"/>\n"
      "<DataSet timestep=\"2.5\" part=\"1\" file=\"c.mha\"/>\n</Collection>\n</VTKFile>\n";
  const std::string file = folder.put("all.pvd", text);
  const GridData first = read_volume(file), second = read_volume(file, {.time_step = 1});
  EXPECT_EQ(first.times, (std::vector<double>{1, 2.5}));
  EXPECT_EQ(first.time, 1.0);
  ASSERT_EQ(first.blocks.size(), 1u);
  EXPECT_EQ(number(first.blocks[0].point_arrays, "value", 0), 1);
  ASSERT_EQ(second.blocks.size(), 2u);
  EXPECT_EQ(number(second.blocks[0].point_arrays, "value", 7), 2);
  EXPECT_EQ(number(second.blocks[1].point_arrays, "value", 7), 3);
  EXPECT_THROW(read_volume(file, {.time_step = 2}), ArgumentError);
  for (std::size_t n = 0; n + 12 < text.size(); n += 13) expect_no_volume(folder.put("all.pvd", text.substr(0, n)), "");
}

TEST(VolumeFiles, SeriesOfFilesHaveTimes) {
  const Folder folder;
  const auto image = [](char c) {
    return "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string(8, c);
  };
  folder.put("a.mha", image(1)), folder.put("b.mha", image(2));
  const std::string text =
      "{\"file-series-version\": \"1.0\", \"files\": [\n{\"name\": \"b.mha\", \"time\": 2.5},\n{\"name\": \"a.mha\", "
      "\"time\": 1}]}";
  const std::string file = folder.put("all.mha.series", text);
  const GridData first = read_volume(file), second = read_volume(file, {.time_step = 1});
  EXPECT_EQ(first.times, (std::vector<double>{1, 2.5}));
  EXPECT_EQ(number(first.blocks[0].point_arrays, "value", 0), 1);
  EXPECT_EQ(second.time, 2.5);
  EXPECT_EQ(number(second.blocks[0].point_arrays, "value", 0), 2);
  EXPECT_THROW(read_volume(file, {.time_step = 2}), ArgumentError);
  for (std::size_t n = 1; n < text.size(); n += 7)
    expect_no_volume(folder.put("all.mha.series", text.substr(0, n)), "is not a series of files");
  const auto refused = [&](const std::string& content, const std::string& why) {
    expect_no_volume(folder.put("bad.series", content), why);
  };
  refused("[1, 2]", "no list \"files\"");
  refused("{\"files\": {}}", "no list \"files\"");
  refused("{\"files\": []}", "names no files");
  refused("{\"files\": [{\"time\": 1}]}", "without a file");
  refused("{\"files\": [{\"name\": \"a.mha\", \"time\": \"soon\"}]}", "time that is not a number");
  // The error names the wrong file.
  folder.put("inner.series", text);
  for (const auto& [name, why] :
       {std::pair{"no.mha", "no.mha: no such file"}, {"inner.series", "inside another one"}}) {
    const std::string outer =
        folder.put("bad.series", "{\"files\": [{\"name\": \"" + std::string(name) + "\", \"time\": 1}]}");
    expect_file_error(folder / name, why, [&] { read_volume(outer); });
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
