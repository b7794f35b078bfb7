// Reports of lost data: writers report unsupported data, readers report skipped data.
#include <algorithm>

#include "io_test_tools.h"
#include "support/las_file.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

TEST(LeftOut, WritersNameWhatTheyHaveNoRoomFor) {
  using Words = std::vector<std::string>;
  TriangleMesh mesh = made_mesh();  // normals, colours and a float
  mesh.attributes.set("label", std::vector<std::int32_t>(mesh.vertices.size()));
  mesh.triangle_attributes.set("patch", std::vector<float>(mesh.triangles.size()));
  EXPECT_EQ(left_out("a.stl", mesh), (Words{"normals", "colours", "quality", "label", "patch of triangles"}));
  EXPECT_EQ(left_out("a.obj.gz", mesh), (Words{"quality", "label", "patch of triangles"}));
  EXPECT_EQ(left_out("A.OFF", mesh), (Words{"quality", "label", "patch of triangles"}));
  EXPECT_EQ(left_out("a.glb", mesh), (Words{"label", "patch of triangles"}));
  EXPECT_EQ(left_out("a.xyz", made_points()), (Words{"quality"}));
  mesh.normals.clear(), mesh.colors.clear(), mesh.attributes.clear(), mesh.triangle_attributes.clear();
  EXPECT_TRUE(left_out("a.stl", mesh).empty());
  EXPECT_THROW(left_out("a.las", mesh), FileError);
  EXPECT_EQ(left_out("a.las", made_points()), (Words{"normals"}));
  EXPECT_TRUE(is_written("a.csv", "points") && !is_written("a.csv", "mesh") && !is_written("a.las", "mesh"));
  EXPECT_TRUE(is_read("a.LAS.gz") && is_read("a.glb") && !is_read("a.fbx") && !is_read("a"));
}

TEST(LeftOut, ReadersNameWhatHasNoPlace) {
  const Folder folder;
  const auto unread = [&](const std::string& name, const std::string& content) {
    ReadReport report;
    (void)read_points(folder.put(name, content), &report);
    std::string all;
    for (const std::string& what : report.unread) all += (all.empty() ? "" : ", ") + what;
    return all;
  };
  EXPECT_EQ(unread("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "");
  EXPECT_EQ(unread("b.obj", "g a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\nl 1 2\n"),
            "texture coordinates, materials, groups of faces, lines");
  EXPECT_EQ(
      unread("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n"),
      "normals of vertices whose faces have different ones");
  EXPECT_EQ(unread("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n"), "colours of faces");
  EXPECT_EQ(unread("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                   "element material 1\nproperty int id\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 2 0 0\n7\n"),
            "lists 'texcoord' of face, elements 'material'");
  EXPECT_EQ(unread("a.pcd",
                   "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\n"
                   "VIEWPOINT 1 2 3 1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"),
            "rows and columns, the viewpoint");
}

TEST(LeftOut, ColoursOfSixteenBitsThatAreBytesStayThem) {
  const Folder folder;
  for (const unsigned factor : {1u, 256u, 257u}) {
    LasFile las;
    las.minor = 2, las.format = 2;
    for (unsigned c = 0; c < 256; ++c)
      las.points.push_back({.x = static_cast<std::int32_t>(c), .rgb = {static_cast<std::uint16_t>(c * factor), 0, 0}});
    ReadReport report;
    const PointSet points = read_points(folder.put("a.las", las.bytes()), &report);
    ASSERT_EQ(points.colors.size(), 256u);
    for (unsigned c = 0; c < 256; ++c) EXPECT_EQ(points.colors[c][0], c) << factor;
    for (const std::string& what : report.unread) EXPECT_EQ(what.find("colours"), std::string::npos);
  }
  LasFile las;
  las.minor = 2, las.format = 2;
  las.points = {{.rgb = {1000, 0, 0}}, {.x = 1, .rgb = {65535, 0, 0}}};
  ReadReport report;
  (void)read_points(folder.put("a.las", las.bytes()), &report);
  EXPECT_NE(std::find(report.unread.begin(), report.unread.end(), "the lower 8 of the 16 bits of colours"),
            report.unread.end());
}

}  // namespace
}  // namespace sansmesh::inline v1
