// Reading OBJ, OFF, STL and VTP.
#include "sample_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;
using Triangles = std::vector<Triangle>;
using Colors = std::vector<std::array<std::uint8_t, 3>>;

const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Triangles faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

// -------------------------------------------------------------------------------------------------------- OBJ

TEST(Obj, AllFormsOfFaces) {
  const Folder folder;
  const std::string v =
      "# a comment\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 0 1 0 \n  v 0 0 1 1.0\nvt 0 0\nvn 0 0 1\n";
  const std::string variants[] = {
      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n",
      "f 1/1 3/1 2/1\ng a\nf 1/1 2/1 4/1\ns off\nf 2/1 3/1 4/1\nusemtl m\nf 1/1 4/1 3/1",
      "f 1//1 3//1 2//1\r\nf 1//1 2//1 4//1\r\nf 2//1 3//1 4//1\r\nf 1//1 4//1 3//1\r\n",
      "f 1/1/1 3/1/1 2/1/1\nf 1/1/1 2/1/1 4/1/1\nf 2/1/1 3/1/1 4/1/1 # end\nf 1/1/1 4/1/1 3/1/1\n",
      "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf \\\n -4 \\\n -1 -2\nl 1 2\np 1\n"};
  for (const std::string& f : variants) {
    const TriangleMesh m = read_mesh(folder.put("a.obj", v + f));
    EXPECT_EQ(m.vertices, corners) << f;
    EXPECT_EQ(m.triangles, faces) << f;
  }
}

TEST(Obj, PolygonsNormalsAndColours) {
  const Folder folder;
  const PointSet p = read_points(folder.put(
      "a.obj",
      "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 0.2 0.4 0.6\nvn 0 0 2\nvn 1 0 0\nf 1//1 2//1 3//1 4//1\n"
      "f 1//2 4//1 3//1\n"));
  EXPECT_EQ(p.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 2}}));
  // The first vertex is on a crease: its faces disagree.
  EXPECT_EQ(p.normals, (std::vector<Vec3f>{{0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}}));
  EXPECT_EQ(p.colors, (Colors{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {51, 102, 153}}));
}

TEST(Obj, CloudsWithNormals) {
  const Folder folder;
  const PointSet p = read_points(folder.put("a.obj", "v 0 0 0\nvn 1 0 0\nv 1 0 0\nvn 0 1 0\n"));
  EXPECT_EQ(p.normals, (std::vector<Vec3f>{{1, 0, 0}, {0, 1, 0}}));
}

TEST(Obj, BadLines) {
  const Folder folder;
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.obj", content), part);
  };
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refuse("v 0 0\n", "line 1: a vertex needs three coordinates");
  refuse("v 0 0 zero\n", "line 1: a vertex");
  refuse(v + "vn 0 1\n", "line 4: a normal");
  refuse(v + "f 1 2 x\n", "line 4: 'x'");
  refuse(v + "f 1 2 3x\n", "line 4: '3x'");
  refuse(v + "f 0 1 2\n", "line 4: there is no vertex 0");
  refuse(v + "f 1 2 -4\n", "line 4: there is no vertex -4");
  refuse(v + "f 1 2 4\n", "only 3 points");
  refuse(v + "f 1 2 99999999999\n", "an impossible point number");
  refuse(v + "f 1 2 99999999999999999999\n", "line 4");
  refuse(v + "f 1//1 2//1 3//1\n", "normal 1");
  refuse("nothing of all this\n", "holds no points");
}

// -------------------------------------------------------------------------------------------------------- OFF

TEST(Off, LayoutsOfTheHeader) {
  const Folder folder;
  const std::string body = "0 0 0\n1 0 0\n\n# between\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 1 2 3\n3 0 3 2\n";
  for (const char* head : {"OFF\n4 4 0\n", "OFF 4 4 6\n", "# first\nOFF\r\n# then\n\n4 4 0 # counts\n", "OFF\n4 4\n"}) {
    const TriangleMesh m = read_mesh(folder.put("a.off", head + body));
    EXPECT_EQ(m.vertices, corners) << head;
    EXPECT_EQ(m.triangles, faces) << head;
  }
}

TEST(Off, NormalsColoursAndPolygons) {
  const Folder folder;
  PointSet p = read_points(folder.put("a.off",
                                      "CNOFF\n4 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 1 0 255\n"
                                      "1 1 0 0 0 1 0 0 2 255\n0 1 0 0 0 1 9 9 9 255\n4 0 1 2 3\n"));
  EXPECT_EQ(p.normals, (std::vector<Vec3f>(4, {0, 0, 1})));
  EXPECT_EQ(p.colors, (Colors{{255, 0, 0}, {0, 1, 0}, {0, 0, 2}, {9, 9, 9}}));
  EXPECT_EQ(p.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  p = read_points(folder.put("a.off", "COFF\n2 0 0\n0 0 0 1.0 0.0 0.0 1.0\n1 0 0 0.2 0.4 0.6 1.0\n"));
  EXPECT_EQ(p.colors, (Colors{{255, 0, 0}, {51, 102, 153}}));
}

TEST(Off, BadFiles) {
  const Folder folder;
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.off", content), part);
  };
  refuse("4 4 0\n0 0 0\n", "is not an OFF file");
  refuse("OFF BINARY\n", "binary OFF");
  refuse("4OFF\n1 0 0\n0 0 0 0\n", "unsupported kind");
  refuse("OFF\n", "truncated");
  refuse("OFF\nmany\n", "malformed OFF header");
  refuse("OFF\n2 0 0\n0 0 0\n", "truncated");
  refuse("OFF\n2 0 0\n0 0 0 0 0 0 0\n0 0\n", "line 4: a vertex needs three coordinates");
  refuse("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "lists fewer");
  refuse("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "only 3 points");
  refuse("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "a face refers to");
  refuse("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", "line 6");
  refuse("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "truncated: ends at face 2 of 2");
}

// -------------------------------------------------------------------------------------------------------- STL

TEST(Stl, BothKindsWeldTheirCorners) {
  const Folder folder;
  for (const std::string& content :
       {tetrahedron_stl_ascii(), tetrahedron_stl_binary(), tetrahedron_stl_binary("solid but binary")}) {
    const TriangleMesh m = read_mesh(folder.put("a.stl", content));
    ASSERT_EQ(m.vertices.size(), 4u);
    ASSERT_EQ(m.triangles.size(), 4u);
    for (std::size_t t = 0; t < 4; ++t) {
      for (int k = 0; k < 3; ++k) EXPECT_EQ(m.vertices[m.triangles[t][k]], corners[faces[t][k]]);
    }
  }
}

TEST(Stl, ZeroHasNoSignAndDegenerateTrianglesGo) {
  const Folder folder;
  ReadReport report;
  const TriangleMesh m = read_mesh(
      folder.put("a.stl",
                 "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 -0\nvertex 0 1 0\nendloop\nendfacet\n"
                 "facet normal 0 0 1\nouter loop\nvertex -0.0 0 0\nvertex 0 1 0\nvertex -1 0 0\nendloop\nendfacet\n"
                 "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 0 0 0\nendloop\nendfacet\n"
                 "endsolid\n"),
      &report);
  EXPECT_EQ(m.vertices.size(), 4u);
  EXPECT_EQ(m.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(report.warnings.size(), 1u);
}

TEST(Stl, BadFiles) {
  const Folder folder;
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.stl", content), part);
  };
  refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "line 4: a vertex needs three coordinates");
  refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\nendsolid\n",
         "line 6: a facet with 1");
  refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "truncated");
  refuse("solid a\nendsolid a\n", "holds no triangles");
  refuse("some text", "is neither");
  refuse(tetrahedron_stl_binary().substr(0, 200), "84 bytes are missing");
  std::string huge = tetrahedron_stl_binary();
  huge.replace(80, 4, raw(0xffffffffu));
  refuse(huge, "truncated");
  refuse(std::string(84, '\0'), "holds no triangles");
  ReadReport report;
  read_mesh(folder.put("a.stl", tetrahedron_stl_binary() + "tail"), &report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("4 bytes after"), std::string::npos);
}

// -------------------------------------------------------------------------------------------------------- VTP

TEST(Vtp, EveryEncodingHoldsTheSame) {
  const Folder folder;
  int number = 0;
  for (const char* format : {"ascii", "binary", "appended"}) {
    for (int k = 0; k < 32; ++k) {
      const Vtp o{format, (k & 1) != 0, (k & 2) != 0, (k & 4) != 0, (k & 8) != 0, (k & 16) != 0};
      ReadReport report;
      const PointSet p = read_points(folder.put(std::to_string(number++) + ".vtp", make_vtp(o)), &report);
      EXPECT_TRUE(report.warnings.empty());
      ASSERT_EQ(
          p.positions,
          (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}}))
          << format << ' ' << k;
      ASSERT_EQ(p.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {4, 5, 7}, {7, 5, 6}}));
      ASSERT_EQ(p.normals, (std::vector<Vec3f>(8, {0, 0, 1})));
      ASSERT_EQ(
          p.colors,
          (Colors{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 255}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 255}}));
    }
  }
}

TEST(Vtp, BadFiles) {
  const Folder folder;
  const auto refuse = [&](const std::string& content, const std::string& part) {
    expect_unreadable(folder.put("a.vtp", content), part);
  };
  const std::string good = make_vtp({});
  const auto with = [&](const std::string& from, const std::string& to, const std::string& in) {
    std::string s = in;
    const std::size_t at = s.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return s.replace(at, from.size(), to);
  };
  refuse("some text", "is not a VTK XML file");
  refuse(with("PolyData", "UnstructuredGrid", good), "UnstructuredGrid");
  refuse(with("\n4 \n", "\n5 \n", good), "impossible offsets");
  refuse(with("0 1 2 3 \n", "0 1 2 4 \n", good), "a face refers to point 4");
  refuse(with("0 1 2 3 \n", "0 1 2 -1 \n", good), "a face refers to point -1");
  refuse(with("1 1 0 0 1 0", "1 1 0 0 1", good), "not triples");
  refuse(with("1 1 0 0 1 0", "1 1 0 0 1 nothing", good), "is not a number");
  refuse(with("Float32", "Float16", good), "unknown type 'Float16'");
  refuse(with("format=\"ascii\"", "format=\"roman\"", good), "unknown format 'roman'");
  refuse(with("byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order", good), "vtkLZ4DataCompressor");
  refuse(good.substr(0, good.size() / 2), "truncated");
  refuse(good.substr(0, good.size() - 12), "truncated");
  refuse(with("offset=\"0\"", "offset=\"99999999\"", make_vtp({.format = "appended"})), "truncated");
  // Impossible sizes in the headers of arrays.
  const auto with_first_word = [&](const Vtp& o, std::uint32_t word, std::size_t at) {
    std::string s = make_vtp(o);
    return s.replace(s.find("\n_") + 2 + at, 4, raw(word));
  };
  refuse(with_first_word({.format = "appended"}, 0xfffffff0u, 0), "truncated");
  const Vtp packed{.format = "appended", .compressed = true};
  refuse(with_first_word(packed, 0xfffffff0u, 0), "announces more");
  refuse(with_first_word(packed, 0xfffffff0u, 4), "a block announces");
}

}  // namespace
}  // namespace sansmesh::inline v1
