// Round trips of attributes of points, vertices and triangles: type, number and name.
#include <cmath>
#include <limits>

#include "io/io_test_tools.h"
#include "sample_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Extreme and common values of every type, as one and as three components; `n` rows.
AttributeTable every_type(std::size_t n) {
  AttributeTable table;
  for (int t = 0; t < 10; ++t)
    for (const std::size_t components : {1, 3}) {
      const auto type = static_cast<NumberType>(t);
      Attribute a{std::string(name_of(type)) + (components == 3 ? "_vector" : "_alone"), empty_values(type),
                  components};
      std::visit(
          [&](auto& values) {
            using T = typename std::decay_t<decltype(values)>::value_type;
            for (std::size_t i = 0; i < n * components; ++i) {
              const T all[] = {std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max(), T(0), T(i % 100),
                               static_cast<T>(static_cast<T>(i % 89) / 7)};
              values.push_back(all[i % 5]);
            }
          },
          a.values);
      table.set(std::move(a));
    }
  return table;
}

TEST(Attributes, OfPointsKeepTypeAndNumbersInEveryFormatThatHoldsThem) {
  PointSet points = made_points();
  points.attributes = every_type(points.size());
  for (const char* name : {"a.ply", "a.pcd", "a.vtp", "a.ply.gz", "a.vtp.gz"})
    for (const bool ascii : {false, true}) {
      const Folder folder;
      write_points(folder / name, points, {.ascii = ascii});
      ReadReport report;
      const PointSet back = read_points(folder / name, &report);
      EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
      EXPECT_EQ(back.positions, points.positions) << name;
      EXPECT_EQ(back.colors, points.colors) << name;
      ASSERT_EQ(back.attributes.size(), points.attributes.size()) << name;
      for (const Attribute& a : points.attributes) {
        ASSERT_NE(back.attributes.find(a.name), nullptr) << name << ' ' << a.name;
        EXPECT_TRUE(*back.attributes.find(a.name) == a) << name << ' ' << ascii << ' ' << a.name;
      }
      EXPECT_TRUE(back.attributes == points.attributes) << name << ": in order";
    }
}

TEST(Attributes, OfTablesKeepTheirNumbers) {
  PointSet points = made_points();
  points.attributes = every_type(points.size());
  const Folder folder;
  write_points(folder / "a.csv", points);
  const PointSet back = read_points(folder / "a.csv");
  EXPECT_EQ(back.positions, points.positions);
  for (const Attribute& a : points.attributes) {
    const Attribute* const b = back.attributes.find(a.name);
    ASSERT_NE(b, nullptr) << a.name;
    EXPECT_EQ(b->components, a.components);
    EXPECT_EQ(is_real(b->type()), is_real(a.type())) << a.name;
    ASSERT_EQ(b->size(), a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a.type() == NumberType::f32)
        ASSERT_EQ(static_cast<float>(b->number(i)), static_cast<float>(a.number(i)));
      else
        ASSERT_EQ(b->number(i), a.number(i)) << a.name;
    }
  }
  EXPECT_EQ(*back.attributes.find<std::int64_t>("int64_alone"), *points.attributes.find<std::int64_t>("int64_alone"));
  EXPECT_EQ(*back.attributes.find<std::uint64_t>("uint64_alone"),
            *points.attributes.find<std::uint64_t>("uint64_alone"));
  // A second round trip produces the same bytes.
  write_points(folder / "b.csv", back);
  EXPECT_EQ(slurp(folder / "b.csv"), slurp(folder / "a.csv"));
}

TEST(Attributes, OfMeshesBelongToVerticesAndTriangles) {
  TriangleMesh mesh = made_mesh();
  mesh.attributes = every_type(mesh.vertices.size());
  mesh.triangle_attributes = every_type(mesh.triangles.size());
  for (const char* name : {"a.ply", "a.vtp"})
    for (const bool ascii : {false, true}) {
      const Folder folder;
      write_mesh(folder / name, mesh, {.ascii = ascii});
      ReadReport report;
      const TriangleMesh back = read_mesh(folder / name, &report);
      EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
      EXPECT_EQ(back.vertices, mesh.vertices);
      EXPECT_EQ(back.triangles, mesh.triangles);
      EXPECT_EQ(back.normals, mesh.normals);
      EXPECT_EQ(back.colors, mesh.colors);
      EXPECT_TRUE(back.attributes == mesh.attributes) << name << ' ' << ascii;
      EXPECT_TRUE(back.triangle_attributes == mesh.triangle_attributes) << name << ' ' << ascii;
    }
}

TEST(Attributes, OfFacesGoToTheTrianglesThatTheyBecome) {
  for (const Ply kind : {Ply::ascii, Ply::little, Ply::big}) {
    PlyElement v("vertex", {"float x", "float y", "float z"}),
        f("face",
          {"short Part", "list uchar int vertex_indices", "double w_0", "double w_1", "list uchar float other"});
    for (int i = 0; i < 5; ++i) v.row({double(i), double(i * i), 0});
    f.add({{-3}, {0, 1, 2}, {1.5}, {2.5}, {1}}).add({{4}, {0, 1, 2, 3, 4}, {3.5}, {4.5}, {}});
    f.add({{5}, {0, 1}, {0}, {0}, {2, 3}}).add({{6}, {2, 3, 4}, {5.5}, {6.5}, {}});
    const Folder folder;
    const TriangleMesh mesh = read_mesh(folder.put("a.ply", make_ply(kind, {v, f})));
    ASSERT_EQ(mesh.triangles.size(), 5u);
    EXPECT_EQ(*mesh.triangle_attributes.find<std::int16_t>("Part"), (std::vector<std::int16_t>{-3, 4, 4, 4, 6}));
    EXPECT_EQ(mesh.triangle_attributes.find("w")->components, 2u);
    EXPECT_EQ(*mesh.triangle_attributes.find<double>("w"),
              (std::vector<double>{1.5, 2.5, 3.5, 4.5, 3.5, 4.5, 3.5, 4.5, 5.5, 6.5}));
    EXPECT_EQ(mesh.triangle_attributes.size(), 2u);
  }
}

TEST(Attributes, OfCellsOfAVtpFollowVerticesAndLines) {
  // Two vertex cells and a line precede the polygon and the strip.
  const std::string file =
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\"><PolyData>"
      "<Piece NumberOfPoints=\"5\" NumberOfVerts=\"2\" NumberOfLines=\"1\" NumberOfStrips=\"1\" NumberOfPolys=\"1\">"
      "<PointData><DataArray type=\"Float32\" Name=\"a &lt;b&gt;\" format=\"ascii\">1 2 3 4 5</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"label\" NumberOfComponents=\"3\" format=\"ascii\">"
      "1 2 3 1 2 3 1 2 3 1 2 3 7 8 9</DataArray>"
      "<DataArray type=\"String\" Name=\"words\" format=\"ascii\">1 2 3 4 5</DataArray></PointData>"
      "<CellData><DataArray type=\"UInt64\" Name=\"id\" format=\"ascii\">1 2 3 18446744073709551615 5</DataArray>"
      "<DataArray type=\"Int8\" Name=\"short\" format=\"ascii\">1 2 3</DataArray></CellData>"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
      "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0</DataArray></Points>"
      "<Verts><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">1 2</DataArray></Verts>"
      "<Lines><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">2</DataArray></Lines>"
      "<Strips><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">1 2 3 4</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray></Strips>"
      "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece></PolyData></VTKFile>";
  const Folder folder;
  ReadReport report;
  const TriangleMesh mesh = read_mesh(folder.put("a.vtp", file), &report);
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(*mesh.attributes.find<float>("a <b>"), (std::vector<float>{1, 2, 3, 4, 5}));
  EXPECT_TRUE(mesh.colors.empty());  // three bytes without a colour's name
  EXPECT_EQ(mesh.attributes.find("label")->components, 3u);
  EXPECT_EQ(*mesh.triangle_attributes.find<std::uint64_t>("id"),
            (std::vector<std::uint64_t>{18446744073709551615u, 5, 5}));
  EXPECT_EQ(mesh.triangle_attributes.size(), 1u);
  EXPECT_EQ(report.warnings, (std::vector<std::string>{"'short' has 3 numbers for 5 cells: left out"}));
}

TEST(Attributes, OfScansStayWithTheirPoints) {
  const Folder folder;
  PlyElement a("vertex", {"float x", "float y", "float z", "ushort id", "float only_here"}),
      b("vertex", {"ushort id", "float x", "float y", "float z"});
  a.row({0, 0, 0, 10, 1}).row({HUGE_VAL, 0, 0, 11, 1}).row({1, 0, 0, 12, 1});
  b.row({20, 0, 1, 0}).row({21, 0, 0, 1});
  folder.put("a.ply", make_ply(Ply::ascii, {a}));
  folder.put("b.ply", make_ply(Ply::little, {b}));
  ReadReport report;
  const PointSet p =
      read_points(folder.put("all.conf", "bmesh a.ply 0 0 0 0 0 0 1\nbmesh b.ply 5 0 0 0 0 0 1\n"), &report);
  EXPECT_EQ(*p.attributes.find<std::uint16_t>("id"), (std::vector<std::uint16_t>{10, 12, 20, 21}));
  EXPECT_EQ(p.attributes.size(), 1u);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings.back().find("'only_here'"), std::string::npos);
}

TEST(Attributes, StayWithThePointsThatAreCleaned) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PointSet points;
  std::vector<std::int64_t> id;
  for (int i = 0; i < 50000; ++i) {
    points.positions.push_back({i % 3 == 0 ? nan : static_cast<float>(i), 1, 2});
    id.push_back(std::int64_t{1} << 40 | i);
  }
  points.attributes.set("id", id);
  for (const char* name : {"a.ply", "a.csv", "a.pcd", "a.vtp"}) {
    const Folder folder;
    write_points(folder / name, points);
    const PointSet back = read_points(folder / name);
    ASSERT_EQ(back.size(), 33333u) << name;
    const auto& kept = *back.attributes.find<std::int64_t>("id");
    for (std::size_t i = 0; i < back.size(); ++i)
      ASSERT_EQ(kept[i] & 0xffffff, static_cast<std::int64_t>(back.positions[i].x + static_cast<float>(back.origin.x)))
          << name;
  }
}

TEST(Attributes, OfNoNumberAreStillWritten) {
  PointSet points = made_points();
  std::vector<float> values(points.size(), 0.5f);
  values[3] = std::numeric_limits<float>::infinity();
  values[5] = std::numeric_limits<float>::quiet_NaN();
  points.attributes.set("k1", values);
  for (const char* name : {"a.csv", "a.ply", "a.pcd", "a.vtp"})
    for (const bool ascii : {false, true}) {
      const Folder folder;
      write_points(folder / name, points, {.ascii = ascii});
      const PointSet back = read_points(folder / name);
      EXPECT_EQ(back.positions, points.positions) << name;
      const Attribute& k1 = *back.attributes.find("k1");
      EXPECT_TRUE(std::isinf(k1.number(3))) << name;
      EXPECT_TRUE(std::isnan(k1.number(5))) << name;
      EXPECT_EQ(k1.number(4), 0.5) << name;
    }
}

TEST(Attributes, LeaveFormatsWithoutThemAsTheyAre) {
  PointSet points = made_points();
  TriangleMesh mesh = made_mesh();
  PointSet bare_points = points;
  TriangleMesh bare_mesh = mesh;
  bare_points.attributes.clear(), bare_mesh.attributes.clear();
  mesh.triangle_attributes = every_type(mesh.triangles.size());
  const Folder folder;
  for (const char* name : {"a.xyz", "a.obj"}) {
    write_points(folder / name, points);
    const std::string with = slurp(folder / name);
    write_points(folder / name, bare_points);
    EXPECT_EQ(slurp(folder / name), with) << name;
  }
  for (const char* name : {"m.obj", "m.stl", "m.off"}) {
    write_mesh(folder / name, mesh);
    const std::string with = slurp(folder / name);
    write_mesh(folder / name, bare_mesh);
    EXPECT_EQ(slurp(folder / name), with) << name;
  }
}

TEST(Attributes, OfAnotherLengthAreRefused) {
  for (const std::size_t length : {std::size_t{19}, std::size_t{21}}) {
    TriangleMesh mesh = made_mesh();
    PointSet points = made_points();
    points.attributes.clear(), mesh.attributes.clear();
    points.attributes.set("shape_index", std::vector<float>(length));
    mesh.triangle_attributes.set("shape_index", std::vector<float>(length));
    for (const char* name : {"a.ply", "a.vtp", "a.obj"}) {
      const Folder folder;
      const auto refuse = [&](const auto& write) {
        try {
          write();
          ADD_FAILURE() << name << " was written with " << length << " values";
        } catch (const ArgumentError& error) {
          EXPECT_NE(std::string(error.what()).find("shape_index"), std::string::npos) << error.what();
        }
      };
      refuse([&] { write_points(folder / name, points); });
      refuse([&] { write_mesh(folder / name, mesh); });
      EXPECT_EQ(folder.entries(), 0u);
    }
  }
}

TEST(Attributes, NamesThatWouldTearAHeaderBecomeOneWord) {
  PointSet points = made_points();
  points.attributes.clear();
  const std::vector<std::string> names = {"two words", "a,b", "line\nbreak", "\"quoted\"", "tab\t",
                                          "two_words", "X",   "red",         "Case",       "case"},
                                 words = {"two_words",   "a_b", "line_break", "_quoted_", "tab_",
                                          "two_words_2", "X_2", "red_2",      "Case",     "case_2"};
  for (std::size_t k = 0; k < names.size(); ++k)
    points.attributes.set(names[k], std::vector<std::int32_t>(points.size(), static_cast<std::int32_t>(k)));
  for (const char* file : {"a.ply", "a.csv", "a.pcd"}) {
    const Folder folder;
    write_points(folder / file, points);
    const PointSet back = read_points(folder / file);
    EXPECT_EQ(back.positions, points.positions) << file;
    if (std::string(file) == "a.pcd") continue;  // its colours have another name, so "red" is free
    ASSERT_EQ(back.attributes.size(), words.size()) << file;
    for (std::size_t k = 0; k < words.size(); ++k) {
      EXPECT_EQ(back.attributes[k].name, words[k]) << file;
      EXPECT_EQ(back.attributes[k].number(0), static_cast<double>(k));
    }
  }
  // XML supports any name.
  const Folder folder;
  points.attributes.set("<&> \"so\"", std::vector<float>(points.size()));
  points.attributes.erase("line\nbreak"), points.attributes.erase("tab\t");
  write_points(folder / "a.vtp", points);
  EXPECT_TRUE(read_points(folder / "a.vtp").attributes == points.attributes);
}

TEST(Attributes, ThatAreNumberedAreComponents) {
  PlyElement v("vertex", {"float x", "float y", "float z", "float u_0", "float u_1", "int u_2", "float w_0",
                          "float w_2", "float s_1", "float t_00", "float f_0", "float f_1", "float f_2", "float f_3"});
  v.row({0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  const Folder folder;
  const PointSet p = read_points(folder.put("a.ply", make_ply(Ply::little, {v})));
  EXPECT_EQ(*p.attributes.find<float>("u"), (std::vector<float>{1, 2}));
  EXPECT_EQ(*p.attributes.find<float>("f"), (std::vector<float>{8, 9, 10, 11}));
  for (const char* name : {"u_2", "w_0", "w_2", "s_1", "t_00"}) EXPECT_NE(p.attributes.find(name), nullptr) << name;
  EXPECT_EQ(p.attributes.size(), 7u);
}

TEST(Attributes, ThatAreNumberedStayApartWhereTheirNameIsTaken) {
  const Folder folder;
  for (const std::vector<std::string>& names : {std::vector<std::string>{"v", "v_0", "v_1"}, {"v_0", "v_1", "v"}}) {
    PointSet points;
    points.positions = {{1, 2, 3}, {4, 5, 6}};
    float value = 0;
    for (const std::string& name : names) points.attributes.set(name, std::vector<float>{++value, -value});
    write_points(folder / "a.ply", points);
    EXPECT_TRUE(read_points(folder / "a.ply").attributes == points.attributes) << names[0];
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
