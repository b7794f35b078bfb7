// Reading of glTF: files made here in all layouts of the standard, files by other programs, files that are damaged.
#include <cmath>
#include <nlohmann/json.hpp>

#include "io_test_tools.h"
#include "support/mesh_checks.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using nlohmann::json;

std::string glb_of(const json& document, std::string binary) {
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const auto word = [](std::size_t n) { return raw(static_cast<std::uint32_t>(n)); };
  return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" + text +
         word(binary.size()) + std::string("BIN\0", 4) + binary;
}

/// A document of one primitive in parts. Each array is a view of its own unless it is added to one.
struct Made {
  json document = {{"asset", {{"version", "2.0"}}},
                   {"scene", 0},
                   {"scenes", {{{"nodes", {0}}}}},
                   {"nodes", {{{"mesh", 0}}}},
                   {"meshes", {{{"primitives", {{{"attributes", json::object()}}}}}}},
                   {"accessors", json::array()},
                   {"bufferViews", json::array()}};
  std::string binary;

  json& primitive() { return document["meshes"][0]["primitives"][0]; }
  std::size_t view(const std::string& bytes, std::size_t stride = 0) {
    json view = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) view["byteStride"] = stride;
    document["bufferViews"].push_back(view);
    binary += bytes;
    return document["bufferViews"].size() - 1;
  }
  std::size_t accessor(std::size_t view, std::size_t count, int component, const char* type, const json& more = {}) {
    json made = {{"bufferView", view}, {"count", count}, {"componentType", component}, {"type", type}};
    if (!more.is_null()) made.update(more);
    document["accessors"].push_back(made);
    return document["accessors"].size() - 1;
  }
  void set(const char* attribute, std::size_t accessor) { primitive()["attributes"][attribute] = accessor; }
  std::string file() {
    document["buffers"] = {{{"byteLength", binary.size()}}};
    return glb_of(document, binary);
  }
};

template <class T>
std::string packed(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A tetrahedron with positive volume 1/6.
const std::vector<float> kCorners{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<std::uint16_t> kFaces{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

Made tetrahedron() {
  Made made;
  made.set("POSITION", made.accessor(made.view(packed(kCorners)), 4, 5126, "VEC3"));
  made.primitive()["indices"] = made.accessor(made.view(packed(kFaces)), 12, 5123, "SCALAR");
  return made;
}

double volume_of(const PointSet& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += dot(Vec3(mesh.positions[t[0]]), cross(Vec3(mesh.positions[t[1]]), Vec3(mesh.positions[t[2]])));
  return six / 6;
}

TEST(Gltf, MeshesOfOurOwnComeBackToTheBit) {
  const Folder folder;
  for (const int m : {12, 200})
    for (const Vec3& origin : {Vec3{}, Vec3{512345.678, 4512345.678, 100.001}}) {
      TriangleMesh mesh = made_mesh(m, origin);
      write_mesh(folder / "m.glb", mesh);
      ReadReport report;
      const TriangleMesh read = read_mesh(folder / "m.glb", &report);
      EXPECT_EQ(report.format, "glTF binary");
      EXPECT_TRUE(report.warnings.empty() && report.unread.empty());
      EXPECT_LT(largest_distance(mesh.origin, mesh.vertices, read.origin, read.vertices),
                origin == Vec3{} ? 1e-30 : 1e-6);
      EXPECT_EQ(read.triangles, mesh.triangles);
      EXPECT_EQ(read.colors, mesh.colors);
      ASSERT_EQ(read.normals.size(), mesh.normals.size());
      for (std::size_t i = 0; i < read.normals.size(); ++i) ASSERT_LT(norm(read.normals[i] - mesh.normals[i]), 1e-6f);
      ASSERT_NE(read.attributes.find<float>("quality"), nullptr);
      EXPECT_EQ(*read.attributes.find<float>("quality"), *mesh.attributes.find<float>("quality"));
    }
}

TEST(Gltf, IndicesAndPositionsOfAllTypes) {
  const Folder folder;
  for (const int component : {5121, 5123, 5125}) {
    Made made;
    made.set("POSITION", made.accessor(made.view(packed(kCorners)), 4, 5126, "VEC3"));
    std::string bytes;
    for (const std::uint16_t i : kFaces)
      bytes += component == 5121   ? raw(static_cast<std::uint8_t>(i))
               : component == 5123 ? raw(i)
                                   : raw(static_cast<std::uint32_t>(i));
    made.primitive()["indices"] = made.accessor(made.view(bytes), 12, component, "SCALAR");
    EXPECT_NEAR(volume_of(read_points(folder.put("a.glb", made.file()))), 1.0 / 6, 1e-7) << component;
  }
  const auto quantised = [&](int component, bool normalized, auto one) {
    Made made;
    std::vector<decltype(one)> corners;
    for (const float c : kCorners) corners.push_back(c > 0 ? one : decltype(one)(0));
    made.set("POSITION", made.accessor(made.view(packed(corners)), 4, component, "VEC3", {{"normalized", normalized}}));
    made.primitive()["indices"] = made.accessor(made.view(packed(kFaces)), 12, 5123, "SCALAR");
    return volume_of(read_points(folder.put("q.glb", made.file()))) * 6;
  };
  EXPECT_NEAR(quantised(5120, true, std::int8_t{127}), 1, 1e-6);
  EXPECT_NEAR(quantised(5120, true, std::int8_t{-128}), -1, 1e-6);
  EXPECT_NEAR(quantised(5121, true, std::uint8_t{255}), 1, 1e-6);
  EXPECT_NEAR(quantised(5122, true, std::int16_t{32767}), 1, 1e-6);
  EXPECT_NEAR(quantised(5123, true, std::uint16_t{65535}), 1, 1e-6);
  EXPECT_NEAR(quantised(5122, false, std::int16_t{3}), 27, 1e-5);
}

TEST(Gltf, StripsFansAndCornersWithoutIndices) {
  const Folder folder;
  // The sides of a square of area 4, in the plane z = 0.
  const std::vector<float> strip{0, 0, 0, 2, 0, 0, 0, 2, 0, 2, 2, 0}, fan{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0};
  const std::vector<float> corners{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 0, 0, 2, 2, 0, 0, 2, 0};
  for (const auto& [mode, positions] : {std::pair(5, strip), std::pair(6, fan), std::pair(4, corners)}) {
    Made made;
    made.set("POSITION", made.accessor(made.view(packed(positions)), positions.size() / 3, 5126, "VEC3"));
    if (mode != 4) made.primitive()["mode"] = mode;
    const PointSet read = read_points(folder.put("a.glb", made.file()));
    ASSERT_EQ(read.triangles.size(), 2u) << mode;
    EXPECT_EQ(read.size(), 4u) << "equal corners are one vertex";
    double area = 0;
    for (const auto& t : read.triangles)
      area +=
          0.5 * static_cast<double>(
                    cross(read.positions[t[1]] - read.positions[t[0]], read.positions[t[2]] - read.positions[t[0]]).z);
    EXPECT_EQ(area, 4) << mode;
  }
}

TEST(Gltf, InterleavedAndSparseArrays) {
  const Folder folder;
  Made made;
  std::string records;
  for (std::size_t v = 0; v < 4; ++v)
    records += packed(std::vector<float>(kCorners.begin() + 3 * static_cast<int>(v),
                                         kCorners.begin() + 3 * static_cast<int>(v) + 3)) +
               packed(std::vector<float>{0, 0, 1}) + packed(std::vector<std::uint8_t>{255, 0, 0, 255});
  const std::size_t view = made.view("padding." + records, 28);
  made.set("POSITION", made.accessor(view, 4, 5126, "VEC3", {{"byteOffset", 8}}));
  made.set("NORMAL", made.accessor(view, 4, 5126, "VEC3", {{"byteOffset", 20}}));
  made.set("COLOR_0", made.accessor(view, 4, 5121, "VEC4", {{"byteOffset", 32}, {"normalized", true}}));
  made.primitive()["indices"] = made.accessor(made.view(packed(kFaces)), 12, 5123, "SCALAR");
  const PointSet read = read_points(folder.put("a.glb", made.file()));
  EXPECT_NEAR(volume_of(read), 1.0 / 6, 1e-7);
  EXPECT_EQ(read.normals[3], (Vec3f{0, 0, 1}));
  EXPECT_EQ(read.colors[2], (std::array<std::uint8_t, 3>{255, 0, 0}));

  // The last corner moves to z = 3; an array without a view is zeros.
  Made sparse;
  const std::size_t index = sparse.view(packed(std::vector<std::uint16_t>{3, 0}));
  const std::size_t value = sparse.view(packed(std::vector<float>{0, 0, 3}));
  const json changes = {
      {"count", 1}, {"indices", {{"bufferView", index}, {"componentType", 5123}}}, {"values", {{"bufferView", value}}}};
  sparse.set("POSITION", sparse.accessor(sparse.view(packed(kCorners)), 4, 5126, "VEC3", {{"sparse", changes}}));
  sparse.primitive()["indices"] = sparse.accessor(sparse.view(packed(kFaces)), 12, 5123, "SCALAR");
  EXPECT_NEAR(volume_of(read_points(folder.put("s.glb", sparse.file()))), 0.5, 1e-6);
  sparse.document["accessors"][0].erase("bufferView");
  const PointSet zeros = read_points(folder.put("z.glb", sparse.file()));
  EXPECT_EQ(zeros.size(), 2u);
  EXPECT_TRUE(zeros.triangles.empty());
}

TEST(Gltf, NodesMoveTurnScaleAndMirror) {
  const Folder folder;
  Made made = tetrahedron();
  const double s = std::sqrt(0.5);
  made.document["nodes"] = {{{"translation", {10, 0, 0}}, {"children", {1, 2}}},
                            {{"mesh", 0}, {"rotation", {0, 0, s, s}}, {"scale", {2, 1, 1}}},
                            {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}};
  const PointSet read = read_points(folder.put("a.glb", made.file()));
  ASSERT_EQ(read.size(), 8u);
  const auto at = [&](std::size_t i) { return read.origin + Vec3(read.positions[i]); };
  EXPECT_LT(norm(at(1) - Vec3{10, 2, 0}), 1e-6);  // x, twice as long, turned to y
  EXPECT_LT(norm(at(2) - Vec3{9, 0, 0}), 1e-6);   // y to -x
  EXPECT_LT(norm(at(5) - Vec3{14, 6, 7}), 1e-6);  // mirrored
  double six = 0;
  for (const auto& t : read.triangles) six += dot(at(t[0]) - at(0), cross(at(t[1]) - at(0), at(t[2]) - at(0)));
  EXPECT_NEAR(six, 3, 1e-5) << "the mirrored one keeps its outside";
}

TEST(Gltf, ColorsOfMaterialsAndNormalsOfCreases) {
  const Folder folder;
  Made made = tetrahedron();
  made.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.2158605, 0, 1}}}}}};
  made.primitive()["material"] = 0;
  EXPECT_EQ(read_points(folder.put("a.glb", made.file())).colors[0], (std::array<std::uint8_t, 3>{255, 128, 0}));

  // The same corners twice, with other normals: one vertex without a normal. Other colours keep them apart.
  std::vector<float> twice = kCorners, normals;
  twice.insert(twice.end(), kCorners.begin(), kCorners.end());
  for (int i = 0; i < 8; ++i) normals.insert(normals.end(), {i < 4 ? 1.0f : 0.0f, 0, i == 0 || i >= 4 ? 1.0f : 0.0f});
  std::vector<std::uint16_t> faces = kFaces;
  for (std::size_t i = 6; i < 12; ++i) faces[i] = static_cast<std::uint16_t>(faces[i] + 4);
  Made split;
  split.set("POSITION", split.accessor(split.view(packed(twice)), 8, 5126, "VEC3"));
  split.set("NORMAL", split.accessor(split.view(packed(normals)), 8, 5126, "VEC3"));
  split.primitive()["indices"] = split.accessor(split.view(packed(faces)), 12, 5123, "SCALAR");
  ReadReport report;
  const PointSet joined = read_points(folder.put("s.glb", split.file()), &report);
  EXPECT_EQ(joined.size(), 4u);
  EXPECT_EQ(joined.normals[1], Vec3f{});
  EXPECT_EQ(report.unread, (std::vector<std::string>{"normals of vertices whose faces have different ones"}));
  std::vector<float> colors(24, 1);
  for (std::size_t i = 0; i < 12; ++i) colors[i] = 0.25f;
  split.set("COLOR_0", split.accessor(split.view(packed(colors)), 8, 5126, "VEC3"));
  EXPECT_EQ(read_points(folder.put("c.glb", split.file())).size(), 8u);
}

TEST(Gltf, PointsAreACloudAndLinesAreLeftOut) {
  const Folder folder;
  Made made = tetrahedron();
  json points = made.primitive(), lines = made.primitive();
  points["mode"] = 0, lines["mode"] = 1;
  made.document["meshes"][0]["primitives"].push_back(points);
  made.document["meshes"][0]["primitives"].push_back(lines);
  ReadReport report;
  EXPECT_EQ(read_points(folder.put("a.glb", made.file()), &report).size(), 4u);
  EXPECT_EQ(report.unread, (std::vector<std::string>{"lines", "points beside the triangles"}));
  made.document["meshes"][0]["primitives"] = json::array({points});
  const PointSet cloud = read_points(folder.put("p.glb", made.file()));
  EXPECT_EQ(cloud.size(), 4u);
  EXPECT_TRUE(cloud.triangles.empty());
  made.document["meshes"][0]["primitives"] = json::array({lines});
  expect_unreadable(folder.put("l.glb", made.file()), "lines, but no triangles");
}

TEST(Gltf, TextWithBuffersInsideAndBeside) {
  const Folder folder;
  Made made = tetrahedron();
  made.document["buffers"] = {{{"byteLength", made.binary.size()}, {"uri", "the%20data.bin"}}};
  folder.put("the data.bin", made.binary);
  ReadReport report;
  EXPECT_NEAR(volume_of(read_points(folder.put("a.gltf", made.document.dump(1)), &report)), 1.0 / 6, 1e-7);
  EXPECT_EQ(report.format, "glTF");
  const auto expect_at = [&](const char* uri, const char* part) {
    made.document["buffers"][0]["uri"] = uri;
    expect_unreadable(folder.put("b.gltf", made.document.dump()), part);
  };
  expect_at("nowhere.bin", "nowhere.bin");
  expect_at("https://example.com/a.bin", "'https://example.com/a.bin'; only files in its folder are read");
  expect_at("../a.bin", "only files in its folder");
  expect_at("/etc/hostname", "only files in its folder");
  expect_at("data:application/octet-stream;base64,AAAA", "buffer 0 has 3 of 72 bytes");
  Made tiny;
  tiny.set("POSITION", tiny.accessor(0, 1, 5126, "VEC3"));
  tiny.document["bufferViews"] = {{{"buffer", 0}, {"byteLength", 12}}};
  tiny.primitive()["mode"] = 0;
  tiny.document["buffers"] = {{{"uri", "data:;base64,AACAPwAAAEAAAEBA"}}};
  const PointSet one = read_points(folder.put("c.gltf", "\n " + tiny.document.dump()));
  EXPECT_EQ(one.positions[0] + Vec3f(one.origin), (Vec3f{1, 2, 3}));
}

TEST(Gltf, FilesOfOtherPrograms) {
  const double plain = read_points(source_file("tests/data/two_solids_three.glb")).size();
  for (const auto& [name, most] : {std::pair("three", 1e-6), std::pair("sparse", 1e-6), std::pair("quantized", 1e-3)}) {
    const TriangleMesh mesh = read_mesh(source_file(std::string("tests/data/two_solids_") + name + ".glb"));
    EXPECT_EQ(static_cast<double>(mesh.vertices.size()), plain) << name;
    EXPECT_EQ(mesh.triangles.size(), 44u);
    EXPECT_TRUE(topology_of(mesh).closed_manifold());
    PointSet points;
    points.positions = mesh.vertices, points.triangles = mesh.triangles;
    EXPECT_NEAR(volume_of(points), 31.542473, 31.542473 * most + 1e-5) << name;
  }
}

TEST(Gltf, ErrorsNameTheirCause) {
  const Folder folder;
  const auto expect_of = [&](const char* part, auto&& change) {
    Made made = tetrahedron();
    made.document["buffers"] = {{{"byteLength", made.binary.size()}}};
    change(made.document);
    expect_unreadable(folder.put("a.glb", glb_of(made.document, made.binary)), part);
  };
  expect_of("Draco (KHR_draco_mesh_compression)",
            [](json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; });
  expect_of("meshopt (EXT_meshopt_compression)", [](json& d) {
    d["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = json::object();
    d["bufferViews"][0]["buffer"] = 1;
    d["buffers"].push_back({{"byteLength", 48}});
  });
  expect_of("Draco", [](json& d) {
    d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = json::object();
    d["accessors"][0].erase("bufferView");
  });
  expect_of("is glTF 1.0; version 2", [](json& d) { d["asset"]["version"] = "1.0"; });
  expect_of("no mesh in its scene", [](json& d) { d["nodes"][0].erase("mesh"); });
  expect_of("entry 7 of meshes, which has 1", [](json& d) { d["nodes"][0]["mesh"] = 7; });
  expect_of("'mesh' is not a count", [](json& d) { d["nodes"][0]["mesh"] = -1; });
  expect_of("'mesh' is not a count", [](json& d) { d["nodes"][0]["mesh"] = 1e300; });
  expect_of("'meshes' is of the wrong type", [](json& d) { d["meshes"] = 3; });
  expect_of("entry 0 of meshes is not an object", [](json& d) { d["meshes"][0] = 3; });
  expect_of("node 0 is in the scene twice", [](json& d) { d["nodes"][0]["children"] = {0}; });
  expect_of("'matrix' has not 16 numbers", [](json& d) { d["nodes"][0]["matrix"] = {1, 2}; });
  expect_of("unknown type", [](json& d) { d["accessors"][0]["componentType"] = 5130; });
  expect_of("are more than view 0 has", [](json& d) { d["accessors"][0]["count"] = 5; });
  expect_of("are more than view 0 has", [](json& d) { d["accessors"][0]["count"] = 9007199254740992; });
  expect_of("view 0 ends at byte", [](json& d) { d["bufferViews"][0]["byteLength"] = 4800; });
  expect_of("elements of view 0 overlap", [](json& d) { d["bufferViews"][0]["byteStride"] = 4; });
  expect_of("buffer 0 has 72 of 1,000 bytes", [](json& d) { d["buffers"][0]["byteLength"] = 1000; });
  expect_of("no data of their own", [](json& d) {
    d["accessors"][0].erase("bufferView");
    d["accessors"][0]["count"] = 1000000000;
  });
  expect_of("refers to vertex 3, but its mesh has 3", [](json& d) { d["accessors"][0]["count"] = 3; });
  expect_of("repeats its meshes too often", [](json& d) {
    d["accessors"][0].erase("bufferView");
    d["accessors"][0]["count"] = 400000;
    for (int i = 1; i < 4; ++i) d["nodes"].push_back({{"mesh", 0}}), d["scenes"][0]["nodes"].push_back(i);
  });
}

TEST(Gltf, CutAndFlippedFilesGiveOneError) {
  const Folder folder;
  for (const char* name : {"three", "sparse", "quantized"}) {
    const std::string whole = slurp(source_file(std::string("tests/data/two_solids_") + name + ".glb"));
    for (std::size_t at = 1; at < whole.size(); at += 211)
      expect_unreadable(folder.put("cut.glb", whole.substr(0, at)), at < 4 ? "" : "truncated");
    std::mt19937 random(3);
    for (int i = 0; i < 150; ++i) {
      std::string damaged = whole;
      for (int k = 0; k < 1 + i % 3; ++k)
        damaged[random() % std::min<std::size_t>(whole.size(), 2600)] ^= static_cast<char>(1u << random() % 8);
      const std::string file = folder.put("flip.glb", damaged);
      try {
        const PointSet read = read_points(file);
        for (const auto& t : read.triangles) ASSERT_LT(std::max({t[0], t[1], t[2]}), read.size());
      } catch (const FileError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(file + ": ") && is_clean(error.what())) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
