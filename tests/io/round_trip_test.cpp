// Round trips of every format, with and without normals, colours and scalars.
#include <nlohmann/json.hpp>

#include "sample_files.h"
#include "sansmesh/image.h"
#include "support/any_threads.h"
#include "support/png_file.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct Kind {
  const char* name;  ///< name of the file
  bool ascii;
  bool normals, colors, scalar;  ///< data that the format keeps
};
std::ostream& operator<<(std::ostream& out, const Kind& k) { return out << k.name << (k.ascii ? " ascii" : ""); }

constexpr Kind mesh_kinds[] = {{"m.ply", false, true, true, true},    {"m.ply", true, true, true, true},
                               {"m.ply.gz", false, true, true, true}, {"M.PLY", false, true, true, true},
                               {"m.obj", false, true, true, false},   {"m.obj.gz", false, true, true, false},
                               {"m.vtp", false, true, true, true},    {"m.vtp", true, true, true, true},
                               {"m.off", false, true, true, false},   {"m.stl", false, false, false, false},
                               {"m.stl", true, false, false, false},  {"m.stl.gz", false, false, false, false}};
constexpr Kind point_kinds[] = {{"p.ply", false, true, true, true},     {"p.ply", true, true, true, true},
                                {"p.obj", false, true, true, false},    {"p.xyz", false, true, true, false},
                                {"p.xyz.gz", false, true, true, false}, {"p.csv", false, true, true, true},
                                {"p.csv.gz", false, true, true, true},  {"p.pcd", false, true, true, true},
                                {"p.pcd", true, true, true, true},      {"p.vtp", false, true, true, true},
                                {"p.vtp", true, true, true, true},      {"p.vtp.gz", false, true, true, true}};

// Far from zero, a step of a float is half a metre in y; this must not be noticeable.
const Vec3 survey_origin{512345.125, 4512345.5, 250.25};

class MeshRoundTrip : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Formats, MeshRoundTrip, ::testing::ValuesIn(mesh_kinds));

TEST_P(MeshRoundTrip, KeepsWhatTheFormatHas) {
  const Kind kind = GetParam();
  const bool stl = std::string(kind.name).find(".stl") != std::string::npos;
  for (const bool attributes : {true, false}) {
    const Folder folder;
    TriangleMesh mesh = made_mesh();
    if (!attributes) mesh.normals.clear(), mesh.colors.clear(), mesh.attributes.clear();
    write_mesh(folder / kind.name, mesh, {.ascii = kind.ascii});
    EXPECT_EQ(folder.entries(), 1u);
    ReadReport report;
    const TriangleMesh back = read_mesh(folder / kind.name, &report);
    EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
    EXPECT_EQ(back.origin, Vec3{});
    ASSERT_EQ(back.vertices.size(), mesh.vertices.size());
    ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
    if (stl) {  // vertices have another order: compare corner by corner
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
          EXPECT_EQ(back.vertices[back.triangles[t][k]], mesh.vertices[mesh.triangles[t][k]]);
        }
      }
    } else {
      EXPECT_EQ(back.vertices, mesh.vertices);
      EXPECT_EQ(back.triangles, mesh.triangles);
    }
    EXPECT_EQ(back.normals, kind.normals ? mesh.normals : std::vector<Vec3f>{});
    EXPECT_EQ(back.colors.empty(), !kind.colors || !attributes);
    if (kind.colors) {
      EXPECT_EQ(back.colors, mesh.colors);
    }
    if (kind.scalar) {
      EXPECT_EQ(back.attributes, mesh.attributes);
    }
  }
}

TEST_P(MeshRoundTrip, SurveyCoordinatesKeepTenthsOfMillimetres) {
  const Kind kind = GetParam();
  const Folder folder;
  const TriangleMesh mesh = made_mesh(12, survey_origin);
  write_mesh(folder / kind.name, mesh, {.ascii = kind.ascii});
  const TriangleMesh back = read_mesh(folder / kind.name);
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.origin + Vec3(mesh.vertices[mesh.triangles[t][k]]);
      const Vec3 b = back.origin + Vec3(back.vertices[back.triangles[t][k]]);
      ASSERT_LT(norm(a - b), 1e-6);
    }
  }
}

class PointsRoundTrip : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Formats, PointsRoundTrip, ::testing::ValuesIn(point_kinds));

TEST_P(PointsRoundTrip, KeepsWhatTheFormatHas) {
  const Kind kind = GetParam();
  for (int attributes = 0; attributes < 8; ++attributes) {
    const Folder folder;
    PointSet points = made_points();
    if (!(attributes & 1)) points.normals.clear();
    if (!(attributes & 2)) points.colors.clear();
    if (!(attributes & 4)) points.attributes.clear();
    write_points(folder / kind.name, points, {.ascii = kind.ascii});
    ReadReport report;
    const PointSet back = read_points(folder / kind.name, &report);
    EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
    EXPECT_EQ(back.positions, points.positions);
    EXPECT_EQ(back.normals, points.normals);
    EXPECT_EQ(back.colors, points.colors);
    if (kind.scalar) {
      // Text without types has no floats: the same numbers as doubles.
      ASSERT_EQ(back.attributes.size(), points.attributes.size());
      for (const Attribute& a : points.attributes) {
        const Attribute* const b = back.attributes.find(a.name);
        ASSERT_TRUE(b && b->size() == a.size() && (b->type() == a.type() || b->type() == NumberType::f64));
        for (std::size_t i = 0; i < a.size(); ++i)
          ASSERT_EQ(static_cast<float>(b->number(i)), static_cast<float>(a.number(i)));
      }
    }
    EXPECT_TRUE(back.triangles.empty());
  }
}

TEST_P(PointsRoundTrip, SurveyCoordinatesKeepTenthsOfMillimetres) {
  const Kind kind = GetParam();
  const Folder folder;
  const PointSet points = made_points(12, survey_origin);
  write_points(folder / kind.name, points, {.ascii = kind.ascii});
  const PointSet back = read_points(folder / kind.name);
  EXPECT_LT(largest_distance(points.origin, points.positions, back.origin, back.positions), 1e-6);
  EXPECT_EQ(back.normals, points.normals);
  EXPECT_EQ(back.colors, points.colors);
}

TEST_P(PointsRoundTrip, TinyAndHugeClouds) {
  for (const float scale : {1e-12f, 1e12f}) {
    const Folder folder;
    PointSet points = made_points();
    for (Vec3f& p : points.positions) p *= scale;
    write_points(folder / GetParam().name, points, {.ascii = GetParam().ascii});
    EXPECT_EQ(read_points(folder / GetParam().name).positions, points.positions);
  }
}

TEST(RoundTrip, MoreRowsThanOnePiece) {
  // Text is written and read in chunks of some thousand rows; their order must be kept.
  PointSet points;
  for (int i = 0; i < 40000; ++i) {
    points.positions.push_back({static_cast<float>(i), static_cast<float>(i % 7), static_cast<float>(i % 11)});
  }
  const Folder folder;
  for (const char* name : {"p.xyz", "p.csv", "p.ply", "p.obj", "p.pcd"}) {
    write_points(folder / name, points, {.ascii = true});
    EXPECT_EQ(read_points(folder / name).positions, points.positions) << name;
  }
}

TEST(RoundTrip, DoesNotDependOnTheNumberOfThreads) {
  const Folder folder;
  const TriangleMesh mesh = made_mesh(120, survey_origin);
  for (const char* name : {"m.ply", "m.obj", "m.stl", "m.off", "m.glb"}) {
    SCOPED_TRACE(name);
    expect_equal_for_any_threads([&] {
      write_mesh(folder / name, mesh, {.ascii = true});
      return slurp(folder / name);
    });
  }
}

TEST(RoundTrip, SurveyCoordinateAppearsAsItWasGiven) {
  const Folder folder;
  const std::string in = folder.put("in.xyz",
                                    "512345.678 4512345.678 100.001\n512355.678 4512344.321 101.5\n"
                                    "512350.001 4512350.999 99.125\n");
  const PointSet points = read_points(in);
  for (const char* name : {"out.xyz", "out.csv", "out.ply"}) {
    write_points(folder / name, points, {.ascii = true});
    const std::string text = slurp(folder / name);
    for (const char* number : {"512345.678", "4512345.678", "4512344.321", "4512350.999", "101.5"}) {
      EXPECT_NE(text.find(number), std::string::npos) << name << ": " << number << "\n" << text;
    }
  }
}

TEST(RoundTrip, PlyOfSurveyCoordinatesIsDoubleAndOfOthersFloat) {
  const Folder folder;
  write_mesh(folder / "a.ply", made_mesh());
  write_mesh(folder / "b.ply", made_mesh(12, survey_origin));
  EXPECT_NE(slurp(folder / "a.ply").find("property float x"), std::string::npos);
  EXPECT_NE(slurp(folder / "b.ply").find("property double x"), std::string::npos);
}

TEST(RoundTrip, MeshWithoutTriangles) {
  const Folder folder;
  TriangleMesh mesh = made_mesh();
  mesh.triangles.clear();
  for (const char* name : {"m.ply", "m.obj", "m.off", "m.stl", "m.glb"}) {
    write_mesh(folder / name, mesh);
    expect_file_error(folder / name, "", [&] { read_mesh(folder / name); });
  }
  write_mesh(folder / "m.ply", TriangleMesh{});
  expect_unreadable(folder / "m.ply", "holds no points");
}

// -------------------------------------------------------------------------------------------------------- GLB

struct Glb {
  nlohmann::json json;
  std::string bytes;
};
Glb parse_glb(const std::string& s) {
  const auto number = [&](std::size_t at) {
    std::uint32_t v = 0;
    if (at + 4 <= s.size()) std::memcpy(&v, s.data() + at, 4);
    return v;
  };
  EXPECT_EQ(s.substr(0, 4), "glTF");
  EXPECT_EQ(number(4), 2u);
  EXPECT_EQ(number(8), s.size());
  const std::uint32_t length = number(12);
  EXPECT_EQ(length % 4, 0u);
  EXPECT_EQ(s.substr(16, 4), "JSON");
  Glb glb{nlohmann::json::parse(s.substr(20, length)), {}};
  const std::size_t at = 20 + length;
  if (at < s.size()) {
    EXPECT_EQ(s.substr(at + 4, 4), std::string("BIN\0", 4));
    EXPECT_EQ(number(at), s.size() - at - 8);
    EXPECT_EQ(number(at) % 4, 0u);
    glb.bytes = s.substr(at + 8);
  }
  return glb;
}

TEST(Glb, HoldsTheMesh) {
  const Folder folder;
  for (const int m : {12, 200}) {  // 16-bit and 32-bit indices
    const TriangleMesh mesh = made_mesh(m, survey_origin);
    write_mesh(folder / "m.glb", mesh);
    const Glb glb = parse_glb(slurp(folder / "m.glb"));
    const auto& j = glb.json;
    EXPECT_EQ(j["asset"]["version"], "2.0");
    EXPECT_EQ(j["buffers"][0]["byteLength"], glb.bytes.size());
    const auto& node = j["nodes"][j["scenes"][j["scene"].get<int>()]["nodes"][0].get<int>()];
    EXPECT_EQ(node["translation"], (std::vector<double>{survey_origin.x, survey_origin.y, survey_origin.z}));
    const auto& primitive = j["meshes"][node["mesh"].get<int>()]["primitives"][0];
    EXPECT_EQ(primitive["mode"], 4);
    EXPECT_TRUE(j["materials"][primitive["material"].get<int>()].is_object());
    /// The bytes of an accessor.
    const auto bytes = [&](const nlohmann::json& index, int component, const char* type, std::size_t count,
                           std::size_t stride) {
      const auto& accessor = j["accessors"][index.get<int>()];
      EXPECT_EQ(accessor["componentType"], component);
      EXPECT_EQ(accessor["type"], type);
      EXPECT_EQ(accessor["count"], count);
      const auto& view = j["bufferViews"][accessor["bufferView"].get<int>()];
      EXPECT_EQ(view["byteLength"], count * stride);
      const std::size_t offset = view["byteOffset"];
      EXPECT_EQ(offset % 4, 0u);
      EXPECT_LE(offset + count * stride, glb.bytes.size());
      return glb.bytes.data() + offset;
    };
    const std::size_t n = mesh.vertices.size();
    const auto& attributes = primitive["attributes"];
    EXPECT_EQ(std::memcmp(bytes(attributes["POSITION"], 5126, "VEC3", n, 12), mesh.vertices.data(), 12 * n), 0);
    EXPECT_EQ(std::memcmp(bytes(attributes["NORMAL"], 5126, "VEC3", n, 12), mesh.normals.data(), 12 * n), 0);
    EXPECT_EQ(std::memcmp(bytes(attributes["_QUALITY"], 5126, "SCALAR", n, 4),
                          mesh.attributes.find<float>("quality")->data(), 4 * n),
              0);
    const char* colors = bytes(attributes["COLOR_0"], 5123, "VEC4", n, 8);
    for (std::size_t i = 0; i < n; ++i) {
      std::uint16_t c[4];
      std::memcpy(c, colors + 8 * i, 8);
      for (int k = 0; k < 3; ++k) {  // linear → sRGB
        const double l = c[k] / 65535.0;
        const double s = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
        ASSERT_EQ(std::lround(255 * s), mesh.colors[i][k]);
      }
      ASSERT_EQ(c[3], 65535);
    }
    const Box3f box = bounds(mesh);
    const auto& position = j["accessors"][attributes["POSITION"].get<int>()];
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(position["min"][k].get<float>(), box.lower[k]);
      EXPECT_EQ(position["max"][k].get<float>(), box.upper[k]);
    }
    const bool narrow = n < 65535;
    const char* indices =
        bytes(primitive["indices"], narrow ? 5123 : 5125, "SCALAR", 3 * mesh.triangles.size(), narrow ? 2 : 4);
    for (std::size_t i = 0; i < 3 * mesh.triangles.size(); ++i) {
      std::uint32_t v = 0;
      std::memcpy(&v, indices + i * (narrow ? 2 : 4), narrow ? 2 : 4);
      ASSERT_EQ(v, mesh.triangles[i / 3][i % 3]);
    }
  }
}

TEST(Glb, UnknownNormalsAreCompletedAndEmptyMeshesHaveNoMesh) {
  const Folder folder;
  TriangleMesh mesh = made_mesh();
  std::fill(mesh.normals.begin(), mesh.normals.begin() + 20, Vec3f{});
  write_mesh(folder / "m.glb", mesh);
  const Glb glb = parse_glb(slurp(folder / "m.glb"));
  const auto& view = glb.json["bufferViews"][1];
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vec3f n;
    std::memcpy(&n, glb.bytes.data() + view["byteOffset"].get<std::size_t>() + 12 * i, 12);
    ASSERT_NEAR(norm(n), 1, 1e-5);
    ASSERT_GT(dot(n, normalized(mesh.vertices[i])), 0.5f);
  }
  write_mesh(folder / "e.glb", TriangleMesh{});
  const Glb empty = parse_glb(slurp(folder / "e.glb"));
  EXPECT_FALSE(empty.json.contains("meshes"));
  EXPECT_TRUE(empty.bytes.empty());
}

// ----------------------------------------------------------------------------------------------- PNG and text

TEST(Png, HoldsEveryLevelOfEveryChannel) {
  const Folder folder;
  Image image(64, 48);
  std::vector<std::uint8_t> expected;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) {
      expected.push_back(static_cast<std::uint8_t>((2 * c + 1) * i + 3 * c + i / 256));
      image.pixels[i][c] = from_byte(expected.back());
    }
  write_image(folder / "i.png", image);
  const PngPicture read = read_png(folder / "i.png");
  EXPECT_EQ(read.width, 64u);
  EXPECT_EQ(read.height, 48u);
  EXPECT_TRUE(read.bytes == expected);
}

TEST(Png, TakesTheNearestLevelAndClampsWhatIsBeyond) {
  const Folder folder;
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<float, std::uint8_t> cases[] = {
      {-0.001f, 0}, {-7.0f, 0},          {-infinity, 0},      {nan, 0},        {1.001f, 255},     {30.0f, 255},
      {1e38f, 255}, {infinity, 255},     {0.4f / 255, 0},     {0.6f / 255, 1}, {99.4f / 255, 99}, {99.6f / 255, 100},
      {0.0f, 0},    {254.4f / 255, 254}, {254.6f / 255, 255}, {-0.0f, 0}};
  Image image(static_cast<int>(std::size(cases)), 1);
  for (std::size_t i = 0; i < std::size(cases); ++i) image.pixels[i].fill(cases[i].first);
  write_image(folder / "i.png", image);
  const std::vector<std::uint8_t> bytes = read_png(folder / "i.png").bytes;
  ASSERT_EQ(bytes.size(), 4 * std::size(cases));
  for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_EQ(bytes[i], cases[i / 4].second) << cases[i / 4].first;
}

TEST(Png, RefusesImagesWithoutPixels) {
  const Folder folder;
  EXPECT_THROW(write_image(folder / "i.png", Image{}), ArgumentError);
  Image torn(4, 4);
  torn.pixels.pop_back();
  EXPECT_THROW(write_image(folder / "i.png", torn), ArgumentError);
  expect_file_error(folder / "i.jpg", ".png", [&] { write_image(folder / "i.jpg", Image(2, 2)); });
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Text, AppearsWholeAndReplaces) {
  const Folder folder;
  write_text(folder / "a.json", "{\"first\": 1}");
  write_text(folder / "a.json", "{}\n");
  EXPECT_EQ(slurp(folder / "a.json"), "{}\n");
  EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace sansmesh::inline v1
