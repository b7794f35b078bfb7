// Reading PLY.
#include "sample_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

class PlyEncodings : public ::testing::TestWithParam<Ply> {
 protected:
  PointSet read(const std::vector<PlyElement>& elements) {
    return read_points(folder_.put("a.ply", make_ply(GetParam(), elements)), &report_);
  }
  std::string put(const std::vector<PlyElement>& elements) {
    return folder_.put("a.ply", make_ply(GetParam(), elements));
  }
  Folder folder_;
  ReadReport report_;
};

TEST_P(PlyEncodings, TetrahedronAndFormatName) {
  const TriangleMesh m = read_mesh(folder_.put("t.ply", tetrahedron_ply(GetParam())), &report_);
  const char* names[] = {"PLY ascii", "PLY binary little endian", "PLY binary big endian"};
  EXPECT_EQ(report_.format, names[static_cast<int>(GetParam())]);
  EXPECT_TRUE(report_.warnings.empty());
  EXPECT_EQ(m.vertices, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(m.triangles, (std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}));
}

TEST_P(PlyEncodings, PropertiesInAnyOrderAndOfAnyType) {
  // Mixed types in one triple, less common names, unknown properties in between.
  PlyElement v("vertex", {"uchar blue", "double z", "short intensity", "float nz", "float32 x", "uint8 red", "int16 y",
                          "float nx", "float ny", "uchar green", "float quality"});
  v.row({3, 2.5, -7, 1, 0.25, 1, -4, 0, 0, 2, 0.75}).row({255, -1, 9, 0, 8, 0, 16, 0, -1, 128, 2});
  const PointSet p = read({v});
  EXPECT_EQ(p.positions, (std::vector<Vec3f>{{0.25f, -4, 2.5f}, {8, 16, -1}}));
  EXPECT_EQ(p.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, -1, 0}}));
  EXPECT_EQ(p.colors, (std::vector<std::array<std::uint8_t, 3>>{{1, 2, 3}, {0, 128, 255}}));
  EXPECT_EQ(*p.attributes.find<float>("quality"), (std::vector<float>{0.75f, 2}));
  EXPECT_EQ(*p.attributes.find<std::int16_t>("intensity"), (std::vector<std::int16_t>{-7, 9}));
  EXPECT_EQ(p.attributes.size(), 2u);
}

TEST_P(PlyEncodings, PolygonsBecomeFansAndExtrasAreSteppedOver) {
  PlyElement camera("camera", {"float view", "list int float extra"}), edge("edge", {"int vertex1", "int vertex2"});
  camera.add({{1}, {1, 2, 3}}).add({{2}, {}});
  edge.row({0, 1}).row({1, 2});
  PlyElement v("vertex", {"float x", "float y", "float z"});
  for (int i = 0; i < 6; ++i) v.row({std::cos(i * 1.0), std::sin(i * 1.0), 0.5 * i});
  PlyElement f("face", {"uchar flags", "list uchar float texcoord", "list int uint vertex_index", "float area"});
  f.add({{1}, {0.5, 0.5}, {0, 1, 2, 3, 4}, {1}}).add({{0}, {}, {5, 4, 3}, {2}}).add({{0}, {1}, {0, 1}, {0}});
  const PointSet p = read({camera, v, edge, f});
  EXPECT_EQ(p.size(), 6u);
  EXPECT_EQ(p.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {5, 4, 3}}));
  ASSERT_EQ(report_.warnings.size(), 1u);
  EXPECT_NE(report_.warnings[0].find("1 faces with fewer than 3 corners"), std::string::npos);
}

TEST_P(PlyEncodings, FacesBeforeVertices) {
  PlyElement f("face", {"list uchar ushort vertex_indices"}), v("vertex", {"float x", "float y", "float z"});
  f.add({{0, 1, 2}});
  v.row({0, 0, 0}).row({1, 0, 0}).row({0, 1, 0});
  EXPECT_EQ(read({f, v}).triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST_P(PlyEncodings, TriangleStrips) {
  PlyElement v("vertex", {"float x", "float y", "float z"}), s("tristrips", {"list int int vertex_indices"});
  for (int i = 0; i < 7; ++i) {
    const int column = i / 2;
    v.row({0.5 * column, i % 2 ? 1.0 : 0.0, 0});
  }
  s.add({{0, 1, 2, 3, -1, 4, 5, 6}});
  const PointSet p = read({v, s});
  EXPECT_EQ(p.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {4, 5, 6}}));
}

TEST_P(PlyEncodings, RangeScanKnowsItsScanner) {
  PlyElement v("vertex", {"float x", "float y", "float z"}), grid("range_grid", {"list uchar int vertex_indices"});
  v.row({0, 0, 0}).row({1, 0, 0}).row({0, 1, 0});
  grid.add({{}}).add({{0}}).add({{1}}).add({{2}});
  const PointSet p = read({v, grid});
  ASSERT_EQ(p.scanners.size(), 1u);
  EXPECT_GT(p.scanners[0].z, 100);
  EXPECT_EQ(p.scan_of_point, (std::vector<std::uint16_t>(3, 0)));
}

TEST_P(PlyEncodings, VerticesWithLists) {
  PlyElement v("vertex", {"float x", "list uchar int seen_by", "float y", "float z", "float confidence"});
  v.add({{1}, {4, 5}, {2}, {3}, {0.5}}).add({{4}, {}, {5}, {6}, {1}});
  const PointSet p = read({v});
  EXPECT_EQ(p.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(*p.attributes.find<float>("confidence"), (std::vector<float>{0.5f, 1}));
}

TEST_P(PlyEncodings, ColoursOfOtherTypes) {
  PlyElement fractions("vertex", {"float x", "float y", "float z", "float red", "float green", "float blue"});
  fractions.row({0, 0, 0, 0, 0.5, 1}).row({1, 0, 0, 0.2, 0.4, 0.6});
  EXPECT_EQ(read({fractions}).colors, (std::vector<std::array<std::uint8_t, 3>>{{0, 128, 255}, {51, 102, 153}}));
  PlyElement wide("vertex", {"float x", "float y", "float z", "ushort red", "ushort green", "ushort blue"});
  wide.row({0, 0, 0, 0, 257, 65535}).row({1, 0, 0, 2570, 0, 0});
  EXPECT_EQ(read({wide}).colors, (std::vector<std::array<std::uint8_t, 3>>{{0, 1, 255}, {10, 0, 0}}));
  PlyElement dark("vertex", {"float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"});
  dark.row({0, 0, 0, 0, 1, 0}).row({1, 0, 0, 1, 1, 1});
  EXPECT_EQ(read({dark}).colors, (std::vector<std::array<std::uint8_t, 3>>{{0, 1, 0}, {1, 1, 1}}));
}

TEST_P(PlyEncodings, NormalsBecomeUnitAndUnknownOnesZero) {
  PlyElement v("vertex", {"float x", "float y", "float z", "float nx", "float ny", "float nz"});
  v.row({0, 0, 0, 0, 3, 4}).row({1, 0, 0, 0, 0, 0}).row({0, 1, 0, 0, 1e-20, 0});
  const PointSet p = read({v});
  ASSERT_EQ(p.normals.size(), 3u);
  EXPECT_LT(norm(p.normals[0] - Vec3f{0, 0.6f, 0.8f}), 1e-6f);
  EXPECT_EQ(p.normals[1], Vec3f{});
  EXPECT_EQ(p.normals[2], (Vec3f{0, 1, 0}));
  EXPECT_EQ(report_.warnings.size(), 1u);
}

TEST_P(PlyEncodings, SurveyCoordinatesKeepMillimetres) {
  PlyElement v("vertex", {"double x", "double y", "double z"});
  const std::vector<Vec3> world{
      {512345.678, 4512345.678, 123.456}, {512346.001, 4512345.002, 122.001}, {512399.999, 4512399.999, 99.999}};
  for (const Vec3& w : world) v.row({w.x, w.y, w.z});
  const PointSet p = read({v});
  for (std::size_t i = 0; i < world.size(); ++i) {
    EXPECT_LT(norm(p.origin + Vec3(p.positions[i]) - world[i]), 1e-5);
  }
}

TEST_P(PlyEncodings, NonFinitePointsGoWithTheirTriangles) {
  const double nan = std::nan(""), inf = HUGE_VAL;
  PlyElement v("vertex", {"float x", "float y", "float z", "float confidence"}),
      f("face", {"list uchar int vertex_indices", "ushort part"});
  v.row({nan, 0, 0, 9}).row({0, 0, 0, 1}).row({1, 0, 0, 2}).row({0, 1, 0, 3}).row({0, 0, inf, 9}).row({1, 1, 1, 4});
  f.add({{0, 1, 2}, {5}}).add({{1, 2, 3}, {6}}).add({{5, 3, 2}, {7}}).add({{4, 1, 2}, {8}});
  const PointSet p = read({v, f});
  EXPECT_EQ(p.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}));
  EXPECT_EQ(*p.attributes.find<float>("confidence"), (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(*p.triangle_attributes.find<std::uint16_t>("part"), (std::vector<std::uint16_t>{6, 7}));
  EXPECT_EQ(p.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 2, 1}}));
  ASSERT_EQ(report_.warnings.size(), 2u);
  EXPECT_EQ(report_.warnings[0], "2 of 6 points are not finite and were left out");
}

TEST_P(PlyEncodings, IndicesOutOfRangeAreRefused) {
  for (const double bad : {3.0, -1.0, 2e9}) {
    PlyElement v("vertex", {"float x", "float y", "float z"}), f("face", {"list uchar int vertex_indices"});
    v.row({0, 0, 0}).row({1, 0, 0}).row({0, 1, 0});
    f.add({{0, 1, 2}}).add({{0, bad, 2}});
    expect_unreadable(put({v, f}), "a face refers to");
    // Another code path of the reader: polygons of different lengths.
    f.add({{0, 1, 2, 1}});
    expect_unreadable(put({v, f}), "a face refers to");
  }
}

TEST_P(PlyEncodings, ManyRecordsReadInPiecesAgreeWithOneByOne) {
  // More records than one chunk of the parallel reader, and a polygon of another length at the end.
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(-1, 1);
  PlyElement v("vertex", {"float x", "float y", "float z"}), f("face", {"list uchar int vertex_indices"});
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  const std::uint32_t n = 70001;
  for (std::uint32_t i = 0; i < n; ++i) {
    positions.push_back({u(random), u(random), u(random)});
    v.row({positions[i].x, positions[i].y, positions[i].z});
    triangles.push_back({i, (i + 1) % n, (i + 7) % n});
    f.add({{double(i), double((i + 1) % n), double((i + 7) % n)}});
  }
  PointSet p = read({v, f});
  EXPECT_EQ(p.positions, positions);
  EXPECT_EQ(p.triangles, triangles);
  f.add({{0, 1, 2, 3}});
  triangles.push_back({0, 1, 2}), triangles.push_back({0, 2, 3});
  p = read({v, f});
  EXPECT_EQ(p.triangles, triangles);
}

std::string encoding_name(const ::testing::TestParamInfo<Ply>& info) {
  const char* names[] = {"Ascii", "LittleEndian", "BigEndian"};
  return names[static_cast<int>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(All, PlyEncodings, ::testing::Values(Ply::ascii, Ply::little, Ply::big), encoding_name);

TEST(Ply, AsciiInOddLayouts) {
  const Folder folder;
  const std::string head =
      "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\n"
      "property float z\r\nend_header\r\n";
  const std::vector<Vec3f> expected{{0, 0, 0}, {1, 0, 0}, {0, 1, -2.5f}};
  for (const char* body : {"0 0 0\r\n1 0 0\r\n0 1 -2.5\r\n", "0 0 0\r\n\r\n1 0\r\n0 0 1\t-2.5", "0 0 0 1 0 0 0 1 -2.5",
                           "  +0 0.0 0e0 \n 1. 0 0\n0 1 -.25e1  \n\n\n"}) {
    EXPECT_EQ(read_points(folder.put("a.ply", head + body)).positions, expected) << body;
  }
}

TEST(Ply, BinaryAfterCarriageReturnHeader) {
  const Folder folder;
  std::string s =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 2\r\nproperty float x\r\nproperty float y\r\n"
      "property float z\r\nend_header\r\n";
  s += raw(1.0f) + raw(2.0f) + raw(3.0f) + raw(-1.0f) + raw(0.0f) + raw(10.0f);
  EXPECT_EQ(read_points(folder.put("a.ply", s)).positions, (std::vector<Vec3f>{{1, 2, 3}, {-1, 0, 10}}));
}

TEST(Ply, MalformedHeaders) {
  const Folder folder;
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n", point = "end_header\n0 0 0\n";
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.ply", content), part);
  };
  refuse("plx\n", "is not a PLY file");
  refuse("ply\nelement vertex 1\n" + xyz + point, "no 'format' line");
  refuse("ply\nformat binary_middle_endian 1.0\nelement vertex 1\n" + xyz + point, "unknown format");
  refuse("ply\nformat ascii 1.0\nelement vertex one\n" + xyz + point, "element vertex one");
  refuse("ply\nformat ascii 1.0\nelement vertex -1\n" + xyz + point, "element vertex -1");
  refuse("ply\nformat ascii 1.0\n" + xyz + point, "a property before any element");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n" + xyz + point, "unknown property type 'real'");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int a\n" + xyz + point, "must be an integer");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
         "no x, y and z");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz, "no 'end_header'");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz + "nonsense\n" + point, "unknown keyword 'nonsense'");
  refuse("ply\nformat ascii 1.0\nelement vertex 0\n" + xyz + "end_header\n", "holds no points");
  refuse("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 1 2\n",
         "holds no points");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz + "element vertex 1\n" + xyz + "end_header\n0 0 0\n1 1 1\n",
         "more than one");
  refuse("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz + "end_header\n0 zero 0\n", "'zero' in vertex 1");
  refuse("ply\nformat ascii 1.0\nelement vertex 2\n" + xyz + "end_header\n0 0 0\n0 0 x\n", "'x' in vertex 2");
}

TEST(Ply, AbsurdListLengths) {
  const Folder folder;
  std::string s =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uint int vertex_indices\nend_header\n";
  for (int i = 0; i < 9; ++i) s += raw(static_cast<float>(i * i));
  expect_unreadable(folder.put("a.ply", s + raw(0xffffffffu) + std::string(12, '\0')), "truncated");
  expect_unreadable(folder.put("a.ply",
                               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                               "property float z\nelement face 1\nproperty list int int vertex_indices\n"
                               "end_header\n0 0 0\n4000000000 0 0 0\n"),
                    "4000000000");
}

}  // namespace
}  // namespace sansmesh::inline v1
