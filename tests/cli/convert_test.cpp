// Tests of `convert`: formats, moves, selections, parts.
#include <cmath>
#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/io/transform_file.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "support/las_file.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

/// Adds a cube with that edge at a corner; each face has its own four vertices.
void add_cube(TriangleMesh& mesh, const Vec3f& corner, float edge) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const float side : {0.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      Vec3f normal;
      normal[axis] = 2 * side - 1;
      for (const float v : {0.0f, 1.0f})
        for (const float u : {0.0f, 1.0f}) {
          Vec3f p;
          p[axis] = side, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
          mesh.vertices.push_back(corner + p * edge);
          mesh.normals.push_back(normal);
          mesh.colors.push_back({static_cast<std::uint8_t>(80 * axis), static_cast<std::uint8_t>(200 * side), 7});
        }
      Triangle a{first, first + 1, first + 3}, b{first, first + 3, first + 2};
      if (side == 0) std::swap(a[1], a[2]), std::swap(b[1], b[2]);
      mesh.triangles.push_back(a), mesh.triangles.push_back(b);
    }
}

/// Cubes with attributes of several types.
TriangleMesh cubes(std::size_t count = 1) {
  TriangleMesh mesh;
  for (std::size_t k = 0; k < count; ++k)
    add_cube(mesh, {3.0f * static_cast<float>(k), 0, 0}, 1 + 0.001f * static_cast<float>(k % 7));
  std::vector<double> time;
  std::vector<std::uint8_t> label;
  std::vector<std::int16_t> patch;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    time.push_back(1e9 + 1e-3 * static_cast<double>(v)), label.push_back(static_cast<std::uint8_t>(v));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    patch.push_back(static_cast<std::int16_t>(-static_cast<int>(t)));
  mesh.attributes.set("gps_time", time);
  mesh.attributes.set("label", label);
  mesh.triangle_attributes.set("patch", patch);
  return mesh;
}

/// A survey of 500 points with all fields of LAS.
LasFile survey() {
  LasFile las;
  las.format = 7, las.offset = {637000, 849000, 400};
  for (int i = 0; i < 500; ++i)
    las.points.push_back({.x = 1000 * (i % 25),
                          .y = 700 * (i / 25),
                          .z = (i * 37) % 901,
                          .intensity = static_cast<std::uint16_t>(i * 131),
                          .classification = i % 3 == 0 ? 2u : 5u});
  return las;
}

/// Largest distance between samples with the same index, in the coordinates of the files.
double apart(const PointSet& a, const PointSet& b) {
  double most = a.size() == b.size() ? 0 : 1e300;
  for (std::size_t i = 0; most < 1e300 && i < a.size(); ++i)
    most = std::max(most, norm(a.origin + Vec3(a.positions[i]) - b.origin - Vec3(b.positions[i])));
  return most;
}

class Convert : public ToolTest {
 protected:
  Outcome convert(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "convert");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }
};

TEST_F(Convert, SurveysKeepEverythingThroughFormatsWithRoom) {
  write("a.las", survey().bytes());
  const PointSet a = read_points(path("a.las"));
  ASSERT_GE(a.attributes.size(), 2u);
  std::string before = "a.las";
  for (const char* next : {"b.ply", "c.pcd", "d.vtp", "dd.las", "e.csv", "f.ply.gz"}) {
    const Outcome outcome = convert({before, "-o", next});
    if (before == "a.las") {  // only the parts that the reader cannot hold
      EXPECT_NE(outcome.err.find("not read, since meshes and clouds cannot hold it: scan directions"),
                std::string::npos)
          << outcome.err;
    } else {
      EXPECT_EQ(outcome.err, "") << next;
    }
    const PointSet b = read_points(path(next));
    EXPECT_LT(apart(a, b), 1e-6) << next;
    EXPECT_EQ(b.colors, a.colors) << next;
    ASSERT_EQ(b.attributes.size(), a.attributes.size()) << next;
    for (const Attribute& one : a.attributes) {
      const Attribute* const other = b.attributes.find(one.name);
      ASSERT_TRUE(other && other->size() == one.size()) << next << " " << one.name;
      if (std::string(next) < "e") {  // with types
        EXPECT_EQ(*other, one) << next;
      }
      for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(other->number(i), one.number(i)) << next;
    }
    before = next;
  }
}

TEST_F(Convert, OneWarningSaysWhatAFormatCannotHold) {
  write_mesh(path("a.ply"), cubes());
  const Outcome stl = convert({"a.ply", "-o", "a.stl"});
  EXPECT_EQ(stl.lines_of_error(), 1) << stl.err;
  for (const char* word : {"normals", "colours", "gps_time", "label", "patch of triangles"})
    EXPECT_NE(stl.err.find(word), std::string::npos) << stl.err;
  EXPECT_NE(convert({"a.ply", "-o", "a.csv"}).err.find("12 triangles left out"), std::string::npos);
  EXPECT_EQ(convert({"a.ply", "--vertices-only", "-o", "p.ply"}).err, "");
  EXPECT_TRUE(read_points(path("p.ply")).triangles.empty());
  EXPECT_EQ(convert({"a.ply", "-o", "b.vtp"}).err, "");
  const TriangleMesh a = read_mesh(path("a.ply")), b = read_mesh(path("b.vtp"));
  EXPECT_EQ(a.attributes, b.attributes);
  EXPECT_EQ(a.triangle_attributes, b.triangle_attributes);
  EXPECT_EQ(a.triangles, b.triangles);
  const Json json = json_of({"convert", "a.ply", "-o", "a.off"});
  EXPECT_EQ(json["left_out"], (Json{"gps_time", "label", "patch of triangles"}));
  EXPECT_EQ(json["warnings"].size(), 1u);
  // Parts that a reader cannot hold.
  write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n");
  EXPECT_NE(convert({"t.obj", "-o", "t.ply"}).err.find("texture coordinates, materials"), std::string::npos);
}

TEST_F(Convert, StepsRunInTheOrderOfTheCommandLine) {
  PointSet p;
  p.positions = {{1, 0, 0}, {0, 2, 0}};
  write_points(path("p.xyz"), p);
  convert({"p.xyz", "-o", "a.ply", "--translate", "1,0,0", "--rotate", "z,90", "--scale", "2"});
  EXPECT_EQ(read_points(path("a.ply")).positions[0], (Vec3f{0, 4, 0}));
  convert({"--scale", "2", "--rotate", "0,0,1,90", "--translate", "-1,0,0", "p.xyz", "-o", "b.ply"});
  EXPECT_EQ(read_points(path("b.ply")).positions[0], (Vec3f{-1, 2, 0}));
  convert({"p.xyz", "-o", "c.ply", "--translate", "1,0,0", "--translate", "0,5,0", "--unit", "m", "--to-unit", "mm"});
  EXPECT_EQ(read_points(path("c.ply")).positions[0], (Vec3f{2000, 5000, 0}));
  convert({"p.xyz", "-o", "d.ply", "--about", "1,0,0", "--rotate", "z,180", "--up", "z"});
  EXPECT_EQ(read_points(path("d.ply")).positions[1], (Vec3f{2, 0, -2}));
  convert({"p.xyz", "-o", "e.ply", "--center", "--new-axes", "y,x,z"});
  EXPECT_EQ(read_points(path("e.ply")).positions[1], (Vec3f{1, -0.5f, 0}));
  write_transform(path("m.txt"), AffineMap::rotation({1, 2, 3}, 40).about({5, 6, 7}));
  convert({"p.xyz", "-o", "f.ply", "--transform", "m.txt", "--inverse-transform", "m.txt"});
  EXPECT_LT(apart(read_points(path("f.ply")), p), 1e-6);
}

TEST_F(Convert, MirrorsAndUnevenScalesKeepTheOutsideOutside) {
  write_mesh(path("a.ply"), cubes());
  for (const char* scale : {"-1,1,1", "2,0.5,-3", "-1,-2,-3"}) {
    convert({"a.ply", "-o", "b.ply", "--scale", scale});
    const TriangleMesh b = read_mesh(path("b.ply"));
    for (const Triangle& t : b.triangles) {
      const Vec3f n = normalized(cross(b.vertices[t[1]] - b.vertices[t[0]], b.vertices[t[2]] - b.vertices[t[0]]));
      EXPECT_GT(dot(n, b.normals[t[0]]), 0.999f) << scale;
    }
    convert({"b.ply", "-o", "c.stl", "--flip-faces"});
    EXPECT_LT(measure_size(read_mesh(path("c.stl"))).volume, 0) << scale;
  }
  convert({"a.ply", "-o", "d.ply", "--flip"});
  EXPECT_EQ(read_mesh(path("d.ply")).normals[0], -cubes().normals[0]);
}

TEST_F(Convert, WeldCropAndSplit) {
  write_mesh(path("a.ply"), cubes(1100));
  const Json welded = json_of({"convert", "a.ply", "-o", "b.ply", "--weld", "0"});
  EXPECT_EQ(welded["outputs"][0]["vertices"], 8 * 1100);
  EXPECT_TRUE(measure_topology(read_mesh(path("b.ply"))).closed());
  const Json json = json_of({"convert", "b.ply", "-o", "part.ply", "--split"});
  ASSERT_EQ(json["outputs"].size(), 1100u);
  EXPECT_EQ(json["outputs"][0]["file"], "part_0001.ply");
  EXPECT_EQ(json["outputs"][1099]["triangles"], 12);
  EXPECT_NEAR(measure_size(read_mesh(path("part_0001.ply"))).volume, std::pow(1.006, 3), 5e-4);
  EXPECT_EQ(read_mesh(path("part_1100.ply")).triangle_attributes.find("patch")->rows(), 12u);
  // Faces of one cube that share no vertex are also parts: --min-size drops them.
  expect_failures(
      {{{"convert", "a.ply", "-o", "q.ply", "--split", "--min-size", "3"}, 1, {"6,600 parts", "3 triangles"}}});

  convert({"b.ply", "-o", "half.ply", "--box", "-1,-1,-1,0.5,9,9"});
  EXPECT_NEAR(measure_size(read_mesh(path("half.ply"))).area, 3, 1e-5);  // open where it is cut
  convert({"half.ply", "-o", "rest.ply", "--outside-box", "0.25,-1,-1,9,9,9"});
  EXPECT_NEAR(measure_size(read_mesh(path("rest.ply"))).area, 2, 1e-5);
}

TEST_F(Convert, CloudsAreThinnedSplitMergedAndChosen) {
  write("a.las", survey().bytes());
  const std::size_t n = read_points(path("a.las")).size();
  EXPECT_EQ(json_of({"convert", "a.las", "-o", "b.ply", "--every", "7"})["outputs"][0]["points"], (n + 6) / 7);
  EXPECT_EQ(json_of({"convert", "a.las", "-o", "b.ply", "--point-count", "100"})["outputs"][0]["points"], 100);
  convert({"a.las", "-o", "thin.ply", "--point-spacing", "3"});
  const PointSet thin = read_points(path("thin.ply"));
  for (std::size_t i = 0; i < thin.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) ASSERT_GE(norm(thin.positions[i] - thin.positions[j]), 2.9999f);
  convert({"a.las", "-o", "far.ply", "--translate", "5000,0,0"});
  convert({"a.las", "far.ply", "-o", "both.ply"});
  const PointSet both = read_points(path("both.ply"));
  const auto* const source = both.attributes.find<std::uint16_t>("source");
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)[0], 0);
  EXPECT_EQ((*source)[n], 1);
  EXPECT_EQ(both.attributes.find("intensity")->rows(), 2 * n);
  const Json parts = json_of({"convert", "both.ply", "-o", "part.ply", "--split", "--split-distance", "20"});
  ASSERT_EQ(parts["outputs"].size(), 2u);
  EXPECT_LT(apart(read_points(path("part_002.ply")), read_points(path("far.ply"))), 2e-4);
  convert({"both.ply", "-o", "once.ply", "--weld", "0", "--translate", "-5000,0,0", "--keep", "intensity"});
  EXPECT_EQ(read_points(path("once.ply")).attributes.size(), 1u);
  std::filesystem::copy_file(path("both.ply"), path("copy.ply"));
  convert({"both.ply", "copy.ply", "-o", "once.ply", "--weld", "0", "--drop", "source,intensity"});
  EXPECT_EQ(read_points(path("once.ply")).size(), 2 * n);
  EXPECT_FALSE(read_points(path("once.ply")).attributes.find("source"));
  // The output may replace the input.
  convert({"once.ply", "-o", "once.ply", "--point-count", "3"});
  EXPECT_EQ(read_points(path("once.ply")).size(), 3u);
}

TEST_F(Convert, FailuresSayWhatToDo) {
  write_mesh(path("m.ply"), cubes());
  write("p.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  write("flat.txt", "1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n");
  expect_failures({
      {{"convert", "p.xyz", "-o", "p.stl"}, 1, {"p.stl", "reconstruct"}},
      {{"convert", "p.xyz", "-o", "p.pwn"}, 1, {"read, not written"}},
      {{"convert", "p.xyz", "-o", "p.foo"}, 1, {".foo"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--box", "5,5,5,6,6,6"}, 1, {"--box leaves nothing", "(1, 1, 1)"}},
      {{"convert", "m.ply", "-o", "q.ply", "--box", "5,5,5,6,6,6"}, 1, {"--box leaves nothing", "12 triangles"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--box", "5,5,5,4,6,6"}, 2, {"--box", "least"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--box", "5,5"}, 2, {"--box"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--rotate", "w,9"}, 2, {"--rotate", "z,90"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--scale", "0"}, 2, {"--scale"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--unit", "furlong"}, 2, {"--unit", "mm"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--to-unit", "mm"}, 2, {"--unit"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--new-axes", "x,x,y"}, 2, {"--new-axes"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--transform", "flat.txt"}, 1, {"flat.txt", "inverse"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--transform", "none.txt"}, 1, {"none.txt"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--flip"}, 1, {"--flip", "normals"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--flip-faces"}, 1, {"--flip-faces is for meshes"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--drop", "foo"}, 1, {"--drop", "'foo'"}},
      {{"convert", "m.ply", "-o", "q.ply", "--point-spacing", "1"}, 1, {"--point-spacing", "--vertices-only"}},
      {{"convert", "m.ply", "p.xyz", "-o", "q.ply"}, 1, {"points and meshes"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--min-size", "4"}, 2, {"--split"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--unit", "mm", "--to-unit", "m", "--to-unit", "cm"},
       2,
       {"--to-unit", "twice"}},
      {{"convert", "p.xyz", "-o", "q.ply", "--rotate", "z,30", "--about", "center"}, 2, {"--about", "none follows"}},
  });
}

TEST_F(Convert, PartsAreNotWrittenOverTheInput) {
  write_mesh(path("part_001.ply"), cubes());
  const std::string before = slurp(path("part_001.ply"));
  expect_failures({{{"convert", "part_001.ply", "-o", "part.ply", "--split"}, 1, {"part_001.ply", "is an input"}}});
  EXPECT_EQ(slurp(path("part_001.ply")), before);
}

}  // namespace
}  // namespace sansmesh::test
