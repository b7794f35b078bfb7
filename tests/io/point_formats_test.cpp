// Reading tables of text, PCD, LAS, alignments of scans, and gzip.
#include <fmt/core.h>

#include "sample_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using Colors = std::vector<std::array<std::uint8_t, 3>>;
using Positions = std::vector<Vec3f>;

class Table : public ::testing::Test {
 protected:
  PointSet read(const std::string& name, const std::string& content) {
    return read_points(folder_.put(name, content), &report_);
  }
  void refuse(const std::string& content, const std::string& part) {
    expect_unreadable(folder_.put("a.xyz", content), part);
  }
  Folder folder_;
  ReadReport report_;
};

TEST_F(Table, SeparatorsCommentsAndLineEnds) {
  const Positions expected{{0, 0.5f, 1}, {-1, 2e3f, 3}, {4, 5, 6}};
  for (const char* content :
       {"0 0.5 1\n-1 2e3 3\n4 5 6\n", "0,0.5,1\n-1,2000,3\n4,5,6", "0;0.5;1\r\n-1;2E+3;3\r\n4;5;6\r\n",
        "0\t0.5\t1\n-1\t2000\t3\n4\t5\t6\n", "# comment\n\n  0   .5 1\n// another\n -1 2000 +3 \n\n4 5 6\n# end",
        "0, 0.5, 1,\n-1, 2000, 3,\n4, 5, 6,\n", "0;0,5;1\n-1;2000;3\n4;5;6\n", "0\t0,5\t1\n-1\t2000,0\t3\n4\t5\t6\n",
        "\xef\xbb\xbf\x30 0.5 1\n-1 2000 3\n4 5 6\n"}) {
    EXPECT_EQ(read("a.txt", content).positions, expected) << content;
  }
}

TEST_F(Table, ColumnsByName) {
  PointSet p = read("a.csv",
                    "id,Z,red,green,blue,\"Y\",X [m],ny,nx,nz,quality,label\n"
                    "1,3,10,20,30,2,1,0,1,0,0.5,tree\n2,6,40,50,60,5,4,1,0,0,0.25,rock\n");
  EXPECT_EQ(p.positions, (Positions{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(p.normals, (Positions{{1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(p.colors, (Colors{{10, 20, 30}, {40, 50, 60}}));
  EXPECT_EQ(*p.attributes.find<double>("quality"), (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(*p.attributes.find<std::int32_t>("id"), (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(p.attributes.size(), 2u);
  EXPECT_EQ(report_.warnings, (std::vector<std::string>{"columns without numbers were left out: label"}));
  p = read("a.txt", "//X Y Z R G B Nx Ny Nz\n1 2 3 1 0 1 0 0 1\n4 5 6 0 0 1 0 0 -1\n");
  EXPECT_EQ(p.positions, (Positions{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(p.colors, (Colors{{1, 0, 1}, {0, 0, 1}}));  // integers: nearly black
  EXPECT_EQ(p.normals, (Positions{{0, 0, 1}, {0, 0, -1}}));
  p = read("a.csv", "Easting;Northing;Elevation\n1;2;3\n4;5;6\n");
  EXPECT_EQ(p.positions, (Positions{{1, 2, 3}, {4, 5, 6}}));
}

TEST_F(Table, FurtherColumnsHaveTheTypeThatHoldsThem) {
  const PointSet p = read("a.csv",
                          "x,y,z,nx,whole,large,largest,beyond,mixed,gap,v_0,v_1,Case [K],whole\n"
                          "1,2,3,0,-7,9007199254740993,18446744073709551615,1e300,1,5,1,4,1.5,1\n# a remark\n\n"
                          "4,5,6,1,8,-9223372036854775807,0,-3,2.5,,2,5,oops,2\n7,8,9,0,9,0,1,2,3\n");
  ASSERT_EQ(p.size(), 3u);
  EXPECT_TRUE(p.normals.empty());
  const auto& t = p.attributes;
  EXPECT_EQ(*t.find<std::int32_t>("nx"), (std::vector<std::int32_t>{0, 1, 0}));  // a single component is not a normal
  EXPECT_EQ(*t.find<std::int32_t>("whole"), (std::vector<std::int32_t>{-7, 8, 9}));
  EXPECT_EQ(*t.find<std::int64_t>("large"), (std::vector<std::int64_t>{9007199254740993, -9223372036854775807, 0}));
  EXPECT_EQ(*t.find<std::uint64_t>("largest"), (std::vector<std::uint64_t>{18446744073709551615u, 0, 1}));
  EXPECT_EQ(*t.find<double>("beyond"), (std::vector<double>{1e300, -3, 2}));
  EXPECT_EQ(*t.find<double>("mixed"), (std::vector<double>{1, 2.5, 3}));
  // Missing fields of a row are NaN; their column is real.
  const auto& gap = *t.find<double>("gap");
  EXPECT_TRUE(gap[0] == 5 && std::isnan(gap[1]) && std::isnan(gap[2]));
  ASSERT_TRUE(t.find<double>("v") && t.find("v")->components == 2);
  EXPECT_EQ(t.find("v")->number(3), 5);
  const auto& with_unit = *t.find<double>("Case [K]");
  EXPECT_TRUE(with_unit[0] == 1.5 && std::isnan(with_unit[1]));
  EXPECT_EQ(report_.warnings, (std::vector<std::string>{"'whole' occurs twice: the second one was left out"}));
}

TEST_F(Table, WordsThatBeginWithNumbersAreNone) {
  for (const std::string word : {"2020-01-02", "12:30", "7-8", "Info", "nano", "1e", "0x10", "1.2.3"}) {
    report_.warnings.clear();
    const PointSet p = read("a.csv", "x,y,z,word,dash\n1,2,3," + word + ",7\n4,5,6," + word + ",-\n7,8,9,,5\n");
    ASSERT_EQ(p.size(), 3u);
    EXPECT_EQ(p.attributes.size(), 1u) << word;
    const auto& dash = *p.attributes.find<double>("dash");
    EXPECT_TRUE(dash[0] == 7 && std::isnan(dash[1]) && dash[2] == 5);
    EXPECT_EQ(report_.warnings, (std::vector<std::string>{"columns without numbers were left out: word"})) << word;
  }
}

TEST_F(Table, ColumnsByTheirValues) {
  PointSet p = read("a.xyz", "1 2 3 0 0 1\n4 5 6 0.6 0 0.8\n");
  EXPECT_EQ(p.normals, (Positions{{0, 0, 1}, {0.6f, 0, 0.8f}}));
  p = read("a.xyz", "1 2 3 255 0 1\n4 5 6 9 8 7\n");
  EXPECT_TRUE(p.normals.empty());
  EXPECT_EQ(p.colors, (Colors{{255, 0, 1}, {9, 8, 7}}));
  p = read("a.xyz", "1 2 3 0 0 1 255 0 1\n4 5 6 0 1 0 9 8 7\n");
  EXPECT_EQ(p.normals, (Positions{{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(p.colors, (Colors{{255, 0, 1}, {9, 8, 7}}));
  p = read("a.pts", "2\n1 2 3 -1000 255 0 1\n4 5 6 50 9 8 7\n");  // intensity before the colours
  EXPECT_EQ(p.colors, (Colors{{255, 0, 1}, {9, 8, 7}}));
  p = read("a.xyz", "1 2 3 20 30 40 255\n4 5 6 9 8 7 255\n");  // opacity after the colours
  EXPECT_EQ(p.colors, (Colors{{20, 30, 40}, {9, 8, 7}}));
  p = read("a.xyz", "1 2 3 20 30 40 255\n4 5 6 9 8 7 250\n");  // not opacity: intensity before the colours
  EXPECT_EQ(p.colors, (Colors{{30, 40, 255}, {8, 7, 250}}));
  p = read("a.xyz", "1 2 3 0.25\n4 5 6 0.5\n");
  EXPECT_EQ(p.positions, (Positions{{1, 2, 3}, {4, 5, 6}}));
  p = read("a.pwn", "1 2 3 0 0 5\n4 5 6 0 7 0\n");  // normals follow from the ending
  EXPECT_EQ(p.normals, (Positions{{0, 0, 1}, {0, 1, 0}}));
  p = read("a.pwn.gz", gzip("1 2 3 0 0 5\n4 5 6 0 7 0\n"));
  EXPECT_EQ(p.normals, (Positions{{0, 0, 1}, {0, 1, 0}}));
}

TEST_F(Table, CountThenPointsThenNormals) {
  const PointSet p = read("a.pwn", "2\n1 2 3\n4 5 6\n0 0 1\n0 1 0\n");
  EXPECT_EQ(p.positions, (Positions{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(p.normals, (Positions{{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(read("a.pts", "2\n1 2 3\n4 5 6\n").size(), 2u);
}

TEST_F(Table, SurveyCoordinatesKeepMillimetres) {
  const PointSet p = read("a.xyz", "512345.678 4512345.678 100.001\n512346.679 4512346.999 100.002\n");
  EXPECT_LT(norm(p.origin + Vec3(p.positions[0]) - Vec3{512345.678, 4512345.678, 100.001}), 1e-6);
  EXPECT_LT(norm(p.origin + Vec3(p.positions[1]) - Vec3{512346.679, 4512346.999, 100.002}), 1e-6);
}

TEST_F(Table, OnePlaceFarAwayHasAnOrigin) {
  for (const int times : {1, 4}) {
    std::string text;
    for (int i = 0; i < times; ++i) text += "123456789012345678 234567890123456789 34567890123456789\n";
    const PointSet p = read("a.xyz", text);
    ASSERT_TRUE(is_finite(p.origin));
    EXPECT_LT(
        norm(p.origin + Vec3(p.positions[0]) - Vec3{123456789012345678.0, 234567890123456789.0, 34567890123456789.0}),
        1e4);
  }
}

/// Points with three decimals in a square of that size, with the lower corner at `corner`.
std::string survey(double corner, double size) {
  std::string text;
  for (int i = 0; i < 2000; ++i)
    text += fmt::format("{:.3f} {:.3f} {:.3f}\n", corner + size * (i * 37 % 2000) / 2000.0 + 0.001 * (i % 10),
                        corner + size * (i * 91 % 2000) / 2000.0 + 0.001 * (i % 7), 0.001 * i);
  return text;
}

TEST_F(Table, WideSurveysSayWhatTheyLose) {
  read("a.xyz", survey(1e7, 1e3));
  EXPECT_TRUE(report_.warnings.empty());
  read("a.xyz", survey(1e7, 1e6));
  ASSERT_EQ(report_.warnings.size(), 1u);
  EXPECT_TRUE(report_.warnings[0].starts_with("coordinates are rounded by up to 0.009, the file has steps of 0.001"))
      << report_.warnings[0];
  // Steps of a metre over a continent are exact.
  std::string metres;
  for (int i = 0; i < 2000; ++i) metres += fmt::format("{} {} {}\n", 10000000 + 500 * i, 5000000 + 7 * i, i);
  read("a.xyz", metres);
  EXPECT_TRUE(report_.warnings.empty());
}

TEST_F(Table, OriginInTheMiddleWhereZeroWouldLoseDecimals) {
  // Not far enough from zero for an origin, relative to the size of the cloud.
  const PointSet p = read("a.xyz", survey(20000, 8000));
  EXPECT_TRUE(report_.warnings.empty());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double x = p.origin.x + static_cast<double>(p.positions[i].x);
    EXPECT_NEAR(x, std::round(x * 1000) / 1000, 4.9e-4);
  }
}

TEST_F(Table, NotFinite) {
  const PointSet p = read("a.xyz", "nan 0 0\n1 2 3\n1e999 0 0\n4 5 6\n0 -inf 0\n1e-999 -0.0 1e30\n");
  EXPECT_EQ(p.positions, (Positions{{1, 2, 3}, {4, 5, 6}}));
  ASSERT_EQ(report_.warnings.size(), 2u);
  EXPECT_EQ(report_.warnings[0], "3 of 6 points are not finite and were left out");
  EXPECT_EQ(report_.warnings[1], "1 of 6 points are farther than 1e+18 from zero and were left out");
  refuse("nan nan nan\nnan nan nan\n", "no points with finite coordinates");
  refuse("1e30 0 0\n0 1e30 0\n", "no points that can be used: 2 of 2 lie farther than 1e+18 from zero");
  refuse("1e30 0 0\nnan 0 0\n", "1 of 2 lies farther than 1e+18 from zero, the others are not finite");
}

TEST_F(Table, BadRows) {
  refuse("1 2 3\n4 5\n", "line 2 has 2 of 3 columns");
  refuse("1 2 3\n4 five 6\n", "line 2: 'five' is not a number");
  refuse("1 2\n3 4\n", "2 columns, but a point needs at least 3");
  refuse("5\n1 2 3\n4 5 6\n", "announces 5 points, holds 2");
  refuse("# nothing\n\n", "holds no points");
  refuse("This is a letter.\nIt holds no points at all.\nNone.\n", "no rows of numbers");
  refuse(std::string("\x01\x02\0\x03", 4), "is not text");
  refuse("x y z nx ny nz\n1 2 3\n", "names more columns");
  refuse("99999999999999999\n1 2 3\n", "announces");
  // Line numbers are correct beyond the first chunk of the parallel reader.
  std::string many;
  for (int i = 0; i < 20000; ++i) many += "1 2 3\n";
  refuse("# head\n" + many + "1 2 x\n" + many, "line 20,002: 'x'");
}

// -------------------------------------------------------------------------------------------------------- PCD

TEST(Pcd, EveryKindOfData) {
  const Folder folder;
  for (const char* kind : {"ascii", "binary", "binary_compressed"}) {
    ReadReport report;
    const PointSet p = read_points(folder.put("a.pcd", make_pcd(kind, 5000)), &report);
    EXPECT_EQ(report.format, std::string("PCD ") + kind);
    ASSERT_EQ(p.size(), 5000u);
    ASSERT_EQ(p.normals.size(), 5000u);
    ASSERT_EQ(p.colors.size(), 5000u);
    EXPECT_TRUE(p.scanners.empty());
    for (std::uint32_t i = 0; i < 5000; ++i) {
      const float x = static_cast<float>(i);
      ASSERT_EQ(p.positions[i], (Vec3f{x, 0.5f * x, 1}));
      ASSERT_EQ(p.normals[i], (i % 2 ? Vec3f{0, 1, 0} : Vec3f{0, 0, -1}));
      const std::uint32_t c = 0x010203 + i;
      ASSERT_EQ(p.colors[i][0], c >> 16 & 255);
      ASSERT_EQ(p.colors[i][1], c >> 8 & 255);
      ASSERT_EQ(p.colors[i][2], c & 255);
    }
  }
}

TEST(Pcd, OrganisedFramesKnowTheirScanner) {
  const Folder folder;
  const PointSet p = read_points(
      folder.put("a.pcd",
                 "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 1 2 3 1 0 0 0\n"
                 "DATA ascii\n0 0 5\nnan nan nan\n1 1 5\n2 0 5\n"));
  EXPECT_EQ(p.size(), 3u);
  EXPECT_EQ(p.scan_of_point, (std::vector<std::uint16_t>(3, 0)));
  ASSERT_EQ(p.scanners.size(), 1u);
  EXPECT_EQ(p.origin + Vec3(p.scanners[0]), (Vec3{1, 2, 3}));
}

TEST(Pcd, ColoursAsFloatsInText) {
  const Folder folder;
  std::ostringstream s;
  s.precision(9);
  s << "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA "
       "ascii\n"
    << "0 0 0 " << std::bit_cast<float>(0x00ff8001u) << "\n1 0 0 " << 0x0102ffu << "\n";
  EXPECT_EQ(read_points(folder.put("a.pcd", s.str())).colors, (Colors{{255, 128, 1}, {1, 2, 255}}));
}

TEST(Pcd, BadFiles) {
  const Folder folder;
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.pcd", content), part);
  };
  const auto with = [&](const std::string& from, const std::string& to, std::string s) {
    const std::size_t at = s.find(from);
    EXPECT_NE(at, std::string::npos);
    return s.replace(at, from.size(), to);
  };
  const std::string ascii = make_pcd("ascii");
  refuse("some text\n", "is not a PCD file");
  refuse(with("SIZE 4", "SIZE 3", make_pcd("binary")), "field 'x'");
  refuse(with("SIZE 4", "SIZE 0", ascii), "malformed PCD header: 'SIZE");
  refuse(with("COUNT 1", "COUNT 0", make_pcd("binary")), "malformed PCD header: 'COUNT");
  refuse(with("COUNT 1 1 1 3", "COUNT 1 1 1 99999999999", ascii), "malformed PCD header: 'COUNT");
  refuse(with("FIELDS x", "FIELDS u", ascii), "lack x, y or z");
  refuse(with("DATA ascii", "DATA morse", ascii), "unknown kind of data 'morse'");
  refuse(with("POINTS 50", "POINTS 0", ascii), "holds no points");
  refuse(with("POINTS 50", "POINTS -1", ascii), "malformed PCD header: 'POINTS -1'");
  refuse(with("\n3 1.5", "\n3 one", ascii), "'one' in point 4 is not a number");
  refuse(with("\n3 1.5 1 7", "\n3 1.5", ascii), "point 4 has");
  refuse(ascii.substr(0, ascii.rfind("49 ")), "holds 49 of 50 points");
  std::string packed = make_pcd("binary_compressed");
  const std::size_t data = packed.find("compressed\n") + 11;
  refuse(std::string(packed).replace(data, 4, raw(0xffffffffu)), "truncated");
  refuse(std::string(packed).replace(data + 4, 4, raw(0xffffffffu)), "announces more");
  refuse(std::string(packed).replace(data + 4, 4, raw(std::uint32_t{100})), "truncated");
}

// -------------------------------------------------------------------------------------------------------- LAS

TEST(Las, VersionsAndPointFormats) {
  const Folder folder;
  for (unsigned minor = 0; minor <= 4; ++minor) {
    for (unsigned format = 0; format <= (minor >= 4 ? 10u : minor >= 3 ? 5u : 3u); ++format) {
      ReadReport report;
      const PointSet p = read_points(folder.put("a.las", make_las(minor, format)), &report);
      EXPECT_EQ(report.format, "LAS 1." + std::to_string(minor));
      ASSERT_EQ(p.size(), 20u);
      for (int i = 0; i < 20; ++i) {
        const Vec3 world = p.origin + Vec3(p.positions[i]);
        ASSERT_LT(norm(world - Vec3{500000 + 0.001 * i, 4512345 + 0.002 * i, 100 + 0.003 * i}), 1e-6);
      }
      const bool colored = format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
      ASSERT_EQ(p.has_colors(), colored) << minor << ' ' << format;
      if (colored) {
        EXPECT_EQ(p.colors[19], (std::array<std::uint8_t, 3>{19, 255, 0}));
      }
    }
  }
}

TEST(Las, BadFiles) {
  const Folder folder;
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.las", content), part);
  };
  const std::string good = make_las(2, 3);
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  refuse("LASF", "truncated");
  refuse("LAZF" + good.substr(4), "is not a LAS file");
  refuse(with(25, "\5"), "unsupported LAS version 1.5");
  refuse(with(104, "\x83"), "LAZ");
  refuse(with(104, "\x0b"), "unsupported LAS point format 11");
  refuse(with(105, raw(std::uint16_t{33})), "records of 33 bytes");
  refuse(with(105, raw(std::uint16_t{0})), "records of 0 bytes");
  refuse(with(96, raw(0xfffffff0u)), "truncated");
  refuse(with(107, raw(0xfffffff0u)), "truncated");
  refuse(with(107, raw(std::uint32_t{0})), "holds no points");
  refuse(with(131, raw(std::nan(""))), "scale or offset");
  refuse(with(131, raw(0.0)), "scale or offset");
  refuse(good.substr(0, good.size() - 1), "truncated: 1 byte is missing");
  refuse(make_las(4, 6, ~std::uint64_t{0}), "announces");
}

// ----------------------------------------------------------------------------------------------- alignments

TEST(Conf, MergesScansWithTheirMotions) {
  const Folder folder;
  // A quarter turn about z in the convention of these files: the rotation is applied transposed, (x, y) → (y, -x).
  const double h = std::sqrt(0.5);
  PlyElement v("vertex", {"float x", "float y", "float z", "float nx", "float ny", "float nz"});
  v.row({1, 0, 0, 1, 0, 0}).row({0, 2, 0, 0, 1, 0}).row({0, 0, 3, 0, 0, 1});
  PlyElement f("face", {"list uchar int vertex_indices"});
  f.add({{0, 1, 2}});
  folder.put("one.ply", make_ply(Ply::little, {v, f}));
  std::filesystem::create_directory(folder / "sub");
  folder.put("sub/two.ply", make_ply(Ply::ascii, {v, f}));
  std::ostringstream conf;
  conf.precision(17);
  conf << "camera 1 2 3 0 0 0 1\n\nmesh one.ply 0 0 0 0 0 0 1\nbmesh sub/two.ply 10 20 30 0 0 " << 2 * h << ' ' << 2 * h
       << "\n";  // not unit: normalised
  const PointSet p = read_points(folder.put("a.conf", conf.str()));
  const Vec3 expected[] = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {10, 19, 30}, {12, 20, 30}, {10, 20, 33}};
  const Vec3f normals[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  ASSERT_EQ(p.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(norm(p.origin + Vec3(p.positions[i]) - expected[i]), 1e-5) << i;
    EXPECT_LT(norm(p.normals[i] - normals[i]), 1e-6f) << i;
  }
  EXPECT_EQ(p.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(p.scan_of_point, (std::vector<std::uint16_t>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(p.scanners.size(), 2u);
}

/// As in Stanford's own dragonStandRight.conf.
TEST(Conf, ScansThatAreNotThereAreNamedAndLeftOut) {
  const Folder folder;
  folder.put("a.ply", tetrahedron_ply(Ply::ascii));
  ReadReport report;
  const PointSet p = read_points(folder.put("a.conf",
                                            "camera 0 0 0 0 0 0 1\nmesh gone.ply 0 0 0 0 0 0 1\n"
                                            "bmesh a.ply 1 0 0 0 0 0 1\nbmesh sub/gone.ply 0 0 0 0 0 0 1\n"
                                            "bmesh a.ply 0 5 0 0 0 0 1\n"),
                                 &report);
  EXPECT_EQ(report.format, "Stanford alignment of 2 of 4 scans");
  EXPECT_EQ(report.warnings, (std::vector<std::string>{"names the scan gone.ply, which does not exist: left out",
                                                       "names the scan sub/gone.ply, which does not exist: left out"}));
  ASSERT_EQ(p.size(), 8u);
  EXPECT_EQ(p.scan_of_point, (std::vector<std::uint16_t>{0, 0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(p.scanners.size(), 2u);
  EXPECT_LT(norm(p.origin + Vec3(p.positions[0]) - Vec3{1, 0, 0}), 1e-6);
  EXPECT_LT(norm(p.origin + Vec3(p.positions[4]) - Vec3{0, 5, 0}), 1e-6);
  expect_unreadable(folder.put("b.conf", "bmesh gone.ply 0 0 0 0 0 0 1\nmesh sub/gone.ply 0 0 0 0 0 0 1\n"),
                    "gone.ply: no such file");
}

TEST(Conf, BadFiles) {
  const Folder folder;
  folder.put("a.ply", tetrahedron_ply(Ply::ascii));
  folder.put("bad.ply", "ply\n");
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.conf", content), part);
  };
  refuse("camera 0 0 0 0 0 0 1\n", "names no scans");
  refuse("bmesh a.ply 0 0 0 0 0 0\n", "line 1");
  refuse("bmesh a.ply 0 0 0 0 0 0 0\n", "line 1");
  refuse("bmesh a.ply 0 0 nan 0 0 0 1\n", "line 1");
  refuse("bmesh\n", "line 1");
  refuse("bmesh none.ply 0 0 0 0 0 0 1\n", "none.ply: no such file");
  refuse("bmesh a.ply 0 0 0 0 0 0 1\nbmesh bad.ply 0 0 0 0 0 0 1\n", "bad.ply: truncated");
  refuse("bmesh a.conf 0 0 0 0 0 0 1\n", "an alignment inside an alignment");
  refuse("bmesh . 0 0 0 0 0 0 1\n", "directory");
  folder.put("b.conf.gz", gzip("bmesh b.conf.gz 0 0 0 0 0 0 1\n"));
  expect_unreadable(folder / "b.conf.gz", "an alignment inside an alignment");
}

// -------------------------------------------------------------------------------------------------------- gzip

TEST(Gzip, EveryFormatAndSeveralStreams) {
  const Folder folder;
  for (const SampleFile& s : sample_files()) folder.put(s.name, s.content);
  for (const SampleFile& s : sample_files()) {
    if (s.name.ends_with(".gz")) continue;
    const PointSet plain = read_points(folder / s.name);
    const std::size_t half = s.content.size() / 2;
    for (const std::string& packed :
         {gzip(s.content), gzip(s.content.substr(0, half)) + gzip(s.content.substr(half))}) {
      const PointSet unpacked = read_points(folder.put("packed." + s.name + ".gz", packed));
      EXPECT_EQ(unpacked.positions, plain.positions) << s.name;
      EXPECT_EQ(unpacked.triangles, plain.triangles) << s.name;
      EXPECT_EQ(unpacked.normals, plain.normals) << s.name;
    }
  }
}

TEST(Gzip, BadFiles) {
  const Folder folder;
  const std::string good = gzip(make_pcd("ascii", 500));
  expect_unreadable(folder.put("a.pcd.gz", good.substr(0, good.size() / 2)), "truncated: the gzip data ends early");
  expect_unreadable(folder.put("a.pcd.gz", gzip("")), "empty");
  std::string damaged = good;
  for (std::size_t i = 200; i < 240; ++i) damaged[i] = static_cast<char>(~damaged[i]);
  expect_unreadable(folder.put("a.pcd.gz", damaged), "");
  damaged = good;
  damaged[damaged.size() - 6] = static_cast<char>(damaged[damaged.size() - 6] + 1);  // the checksum
  expect_unreadable(folder.put("a.pcd.gz", damaged), "damaged compressed data");
}

}  // namespace
}  // namespace sansmesh::inline v1
