// Meshes of Gmsh, Medit, TetGen and Vega, in every form that their manuals describe.
#include <fmt/format.h>

#include <random>

#include "sansmesh/io/tets/vertex_list.h"
#include "volume_test_tools.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

// Content of every file of this test: two tetrahedra with a common face, and one of its triangles.
constexpr double kPlaces[5][3] = {{0, 0, 0}, {1.5, 0, 0}, {0, 2, 0}, {0, 0, -0.25}, {1, 1, 1}};
constexpr int kTets[2][4] = {{0, 2, 1, 3}, {0, 1, 2, 4}};
constexpr int kSide[3] = {0, 1, 4};

void expect_body(const GridData& data, bool points_in_order = true) {
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  ASSERT_EQ(b.points.size(), 5u);
  ASSERT_EQ(b.cells.size(), 2u);
  EXPECT_TRUE(b.flat_cells.empty());
  for (std::size_t t = 0; t < 2; ++t) {
    ASSERT_EQ(b.cells.shapes[t], CellShape::tetrahedron);
    for (std::size_t c = 0; c < 4; ++c) {
      const double* const x = kPlaces[kTets[t][c]];
      EXPECT_EQ(b.points[b.cells[t][c]], (Vec3{x[0], x[1], x[2]}));
    }
  }
  if (points_in_order) {
    EXPECT_EQ(b.points[4], (Vec3{1, 1, 1}));
  }
}

/// Valid but unusual node numbers: with gaps, out of order.
constexpr std::uint64_t kNodes[5] = {7, 12, 3, 100, 8};

struct Msh {
  int version;  ///< 22, 40, 41
  bool binary = false, big = false;

  std::string whole(std::int64_t v) const {
    return binary ? raw(static_cast<std::int32_t>(v), big) : fmt::format("{} ", v);
  }
  std::string size(std::uint64_t v) const { return binary ? raw(v, big) : fmt::format("{} ", v); }
  std::string real(double v) const { return binary ? raw(v, big) : fmt::format("{} ", v); }
  std::string eol() const { return binary ? "" : "\n"; }

  std::string file() const {
    std::string s = fmt::format("$MeshFormat\n{} {} 8\n",
                                version == 22   ? "2.2"
                                : version == 40 ? "4"
                                                : "4.1",
                                int{binary});
    if (binary) s += whole(1) + "\n";
    s += "$EndMeshFormat\n$Comments\nmade $here\n$EndComments\n";
    s += version == 22 ? second() : fourth();
    s += "$NodeData\n1\n\"warmth\"\n1\n0.5\n3\n0\n1\n2\n" + whole(3) + real(0.75) + eol() + whole(100) + real(-2) +
         "\n$EndNodeData\n";
    s += "$ElementData\n1\n\"flow\"\n1\n0\n3\n0\n3\n1\n" + whole(21) + real(1) + real(2) + real(3) +
         "\n$EndElementData\n";
    return s;
  }
  std::string second() const {
    std::string s = "$Nodes\n5\n";
    for (int k = 0; k < 5; ++k) {
      s += whole(static_cast<std::int64_t>(kNodes[k]));
      for (const double x : kPlaces[k]) s += real(x);
      s += eol();
    }
    s += "\n$EndNodes\n$Elements\n3\n";
    const auto tagged = [&](int number, int type, int physical, int entity, const auto& corners) {
      if (!binary) s += fmt::format("{} {} 2 ", number, type);
      if (binary) s += whole(number);
      s += whole(physical) + whole(entity);
      for (const int c : corners) s += whole(static_cast<std::int64_t>(kNodes[c]));
      s += eol();
    };
    if (binary) s += whole(2) + whole(1) + whole(2);
    tagged(10, 2, 5, 1, kSide);
    if (binary) s += whole(4) + whole(2) + whole(2);
    tagged(20, 4, 6, 2, kTets[0]);
    tagged(21, 4, 0, 3, kTets[1]);
    return s + "\n$EndElements\n";
  }
  std::string fourth() const {
    const bool one = version == 41;
    std::string s = "$Entities\n" + size(1) + size(0) + size(0) + size(1) + eol();
    s += whole(4) + real(0) + real(0) + real(0);
    if (!one) s += real(0) + real(0) + real(0);
    s += size(0) + eol();
    s += whole(2);
    for (int k = 0; k < 6; ++k) s += real(k);
    s += size(1) + whole(6) + size(1) + whole(1) + "\n$EndEntities\n$Nodes\n";
    s += size(2) + size(5);
    if (one) s += size(3) + size(100);
    s += eol();
    // The second block is parametric: two more numbers per node of a surface.
    const int counts[2] = {3, 2};
    for (int b = 0, at = 0; b < 2; at += counts[b], ++b) {
      const int dim = b == 0 ? 3 : 2;
      s += one ? whole(dim) + whole(b + 1) : whole(b + 1) + whole(dim);
      s += whole(b) + size(static_cast<std::uint64_t>(counts[b])) + eol();
      const auto place = [&](int k) {
        for (const double x : kPlaces[k]) s += real(x);
        if (b == 1) s += real(0.5) + real(0.25);
        s += eol();
      };
      if (one) {
        for (int k = at; k < at + counts[b]; ++k) s += size(kNodes[k]);
        for (int k = at; k < at + counts[b]; ++k) place(k);
      } else {
        for (int k = at; k < at + counts[b]; ++k) s += whole(static_cast<std::int64_t>(kNodes[k])), place(k);
      }
    }
    s += "\n$EndNodes\n$Elements\n" + size(3) + size(3);
    if (one) s += size(10) + size(21);
    s += eol();
    const auto element = [&](int number, const auto& corners) {
      s += one ? size(static_cast<std::uint64_t>(number)) : whole(number);
      for (const int c : corners) s += one ? size(kNodes[c]) : whole(static_cast<std::int64_t>(kNodes[c]));
      s += eol();
    };
    const auto head = [&](int dim, int tag, int type) {
      s += (one ? whole(dim) + whole(tag) : whole(tag) + whole(dim)) + whole(type) + size(1) + eol();
    };
    head(2, 1, 2);
    element(10, kSide);
    head(3, 2, 4);
    element(20, kTets[0]);
    head(3, 3, 4);
    element(21, kTets[1]);
    return s + "\n$EndElements\n";
  }
};

std::vector<Msh> all_msh() {
  std::vector<Msh> all;
  for (const int version : {22, 40, 41}) {
    all.push_back({version});
    all.push_back({version, true});
    all.push_back({version, true, true});
  }
  return all;
}

TEST(GmshReader, AllVersionsTextAndBinaryInBothByteOrders) {
  const Folder folder;
  for (const Msh& m : all_msh()) {
    SCOPED_TRACE(fmt::format("version {}, binary {}, big {}", m.version, m.binary, m.big));
    const GridData data = read_volume(folder.put("body.msh", m.file()));
    expect_body(data);
    const GridBlock& b = data.blocks[0];
    EXPECT_EQ(b.point_numbers, std::vector<std::uint64_t>(std::begin(kNodes), std::end(kNodes)));
    EXPECT_EQ(number(b.cell_arrays, "physical", 0), 6);
    EXPECT_EQ(number(b.cell_arrays, "physical", 1), 0);
    EXPECT_EQ(number(b.cell_arrays, "entity", 1), 3);
    EXPECT_EQ(number(b.point_arrays, "warmth", 2), 0.75);
    EXPECT_EQ(number(b.point_arrays, "warmth", 3), -2);
    EXPECT_TRUE(std::isnan(number(b.point_arrays, "warmth", 0)));
    EXPECT_EQ(number(b.cell_arrays, "flow", 5), 3);
    ASSERT_EQ(data.notes.size(), 1u);
    EXPECT_EQ(data.notes[0], "1 triangle was left out");
  }
}

/// A cell of the type with nodes 1, 2, … at the corners of a unit cube or some of them.
std::string msh_cell(int type, const std::vector<Vec3>& nodes) {
  std::string s = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    s += fmt::format("{} {} {} {}\n", k + 1, nodes[k].x, nodes[k].y, nodes[k].z);
  s += fmt::format("$EndNodes\n$Elements\n1\n1 {} 0", type);
  for (std::size_t k = 0; k < nodes.size(); ++k) s += fmt::format(" {}", k + 1);
  return s + "\n$EndElements\n";
}

TEST(GmshReader, OtherCells) {
  const Folder folder;
  // In a prism of Gmsh the first triangle is counter-clockwise seen from the second.
  const GridData prism =
      read_volume(folder.put("a.msh", msh_cell(6, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}})));
  ASSERT_EQ(prism.blocks[0].cells.shapes[0], CellShape::wedge);
  EXPECT_EQ(prism.blocks[0].cells[0][1], 2u);
  EXPECT_EQ(prism.blocks[0].cells[0][4], 5u);
  std::vector<Vec3> ten{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 6; ++k) ten.push_back({0.5, 0.1 * k, 0});
  const GridData curved = read_volume(folder.put("b.msh", msh_cell(11, ten)));
  EXPECT_EQ(curved.blocks[0].cells.shapes[0], CellShape::tetrahedron);
  EXPECT_EQ(curved.notes, std::vector<std::string>{"of 1 cell of higher order only the corners are used"});
  // A triangle is read if there are no solid cells.
  const GridData flat = read_volume(folder.put("c.msh", msh_cell(2, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})));
  EXPECT_EQ(flat.blocks[0].flat_cells.size(), 1u);
  expect_no_volume(folder.put("d.msh", msh_cell(99, ten)), "type 99");
}

std::string medit_text() {
  std::string s = "MeshVersionFormatted 2\n# made\nDimension\n3\nVertices\n5\n";
  for (int k = 0; k < 5; ++k)
    s += fmt::format("{} {} {} {}\n", kPlaces[k][0], kPlaces[k][1], kPlaces[k][2], k == 2 ? 4 : 0);
  s += "Triangles 1\n1 2 5 9\nTetrahedra\n2\n";
  for (int t = 0; t < 2; ++t) {
    for (const int c : kTets[t]) s += fmt::format("{} ", c + 1);
    s += fmt::format("{}\n", 10 + t);
  }
  return s + "Corners\n2\n1\n2\nNormals 1\n0.5 -.5 1e-3\nEnd\n";
}

std::string medit_binary(int version, bool big) {
  std::string s = raw(std::int32_t{1}, big) + raw(std::int32_t{version}, big);
  const auto whole = [&](std::int64_t v) { return version > 3 ? raw(v, big) : raw(static_cast<std::int32_t>(v), big); };
  const auto section = [&](int code, const std::string& body) {
    const std::size_t next = s.size() + 4 + (version > 2 ? 8 : 4) + body.size();
    s += raw(std::int32_t{code}, big);
    s += version > 2 ? raw(static_cast<std::int64_t>(next), big) : raw(static_cast<std::int32_t>(next), big);
    s += body;
  };
  section(3, raw(std::int32_t{3}, big));
  std::string body = whole(2);
  for (int t = 0; t < 2; ++t) {
    for (const int c : kTets[t]) body += whole(c + 1);
    body += whole(10 + t);
  }
  section(8, body);  // may precede the vertices
  section(1234, "something that is skipped");
  body = whole(5);
  for (int k = 0; k < 5; ++k) {
    for (const double x : kPlaces[k]) body += version == 1 ? raw(static_cast<float>(x), big) : raw(x, big);
    body += whole(k == 2 ? 4 : 0);
  }
  section(4, body);
  return s + raw(std::int32_t{54}, big) + (version > 2 ? raw(std::int64_t{0}, big) : raw(std::int32_t{0}, big));
}

void expect_medit(const GridData& data) {
  expect_body(data);
  EXPECT_EQ(number(data.blocks[0].point_arrays, "reference", 2), 4);
  EXPECT_EQ(number(data.blocks[0].cell_arrays, "reference", 1), 11);
  EXPECT_EQ(data.blocks[0].point_numbers, (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
}

TEST(MeditReader, TextAndBinary) {
  const Folder folder;
  expect_medit(read_volume(folder.put("body.mesh", medit_text())));
  for (const int version : {1, 2, 3, 4})
    for (const bool big : {false, true})
      expect_medit(read_volume(folder.put("body.meshb", medit_binary(version, big))));
}

std::string tetgen_nodes(int first) {
  std::string s = "# points\n5 3 1 1\n";
  for (int k = 0; k < 5; ++k)
    s += fmt::format("{} {} {} {} {} {}\n", first + k, kPlaces[k][0], kPlaces[k][1], kPlaces[k][2], 0.5 * k,
                     k == 1 ? 3 : 0);
  return s;
}
std::string tetgen_cells(int first) {
  std::string s = "2  4  1 # with regions\n\n";
  for (int t = 0; t < 2; ++t) {
    s += fmt::format("{}", first + t);
    for (const int c : kTets[t]) s += fmt::format(" {}", c + first);
    s += fmt::format(" {}\n", 7 + t);
  }
  return s;
}

TEST(TetgenReader, EitherFileFindsTheOther) {
  for (const int first : {0, 1}) {
    const Folder folder;
    const std::string nodes = folder.put("a.1.node", tetgen_nodes(first)),
                      cells = folder.put("a.1.ele", tetgen_cells(first));
    for (const std::string& file : {nodes, cells}) {
      const GridData data = read_volume(file);
      expect_body(data);
      EXPECT_EQ(number(data.blocks[0].point_arrays, "attribute", 3), 1.5);
      EXPECT_EQ(number(data.blocks[0].point_arrays, "marker", 1), 3);
      EXPECT_EQ(number(data.blocks[0].cell_arrays, "region", 1), 8);
      EXPECT_EQ(data.blocks[0].point_numbers.empty(), first == 0);
    }
    std::filesystem::remove(cells);
    const GridData alone = read_volume(nodes);
    EXPECT_EQ(alone.blocks[0].kind, GridKind::scattered);
    EXPECT_EQ(alone.notes.size(), 1u);
    std::filesystem::remove(nodes);
    expect_no_volume(folder.put("a.1.ele", tetgen_cells(first)), "a.1.node is not there");
  }
}

std::string vega_text() {
  std::string s = "# Vega\n\n*VERTICES\n5 3 0 0\n";
  for (int k = 0; k < 5; ++k) s += fmt::format("{} {} {} {}\n", k + 1, kPlaces[k][0], kPlaces[k][1], kPlaces[k][2]);
  s += "\n*ELEMENTS\nTET\n2 4 0\n";
  for (int t = 0; t < 2; ++t) {
    s += fmt::format("{}", t + 1);
    for (const int c : kTets[t]) s += fmt::format(" {}", c + 1);
    s += "\n";
  }
  return s +
         "*MATERIAL soft\nENU, 1000, 2.5e5, 0.45\n\n*MATERIAL hard\nENU, 7800, 2e11, 0.3\n*SET bone\n2,\n"
         "*REGION\nallElements, soft\n*REGION\nbone, hard\n";
}

TEST(VegaReader, MaterialsAndFilesInFiles) {
  const Folder folder;
  const auto expect_vega = [](const GridData& data) {
    expect_body(data);
    EXPECT_EQ(number(data.blocks[0].cell_arrays, "density", 0), 1000);
    EXPECT_EQ(number(data.blocks[0].cell_arrays, "young", 1), 2e11);
    EXPECT_EQ(number(data.blocks[0].cell_arrays, "poisson", 0), 0.45);
  };
  expect_vega(read_volume(folder.put("body.veg", vega_text())));
  expect_vega(read_volume(folder.put("outer.veg", "*INCLUDE body.veg\n")));
  std::string none = vega_text();
  none.replace(none.find("bone, hard"), 4, "skin");
  expect_no_volume(folder.put("c.veg", none), "the set 'skin'");
  std::string misspelt = vega_text();
  misspelt.replace(misspelt.find("allElements, soft"), 17, "allElements, sfot");
  expect_no_volume(folder.put("d.veg", misspelt), "the missing material 'sfot'");
  for (const char* const wrong : {"1000, -5, 0.45", "0, 2.5e5, 0.45", "1000, 2.5e5, 0.5", "1000, 2.5e5, nan"}) {
    std::string material = vega_text();
    material.replace(material.find("1000, 2.5e5, 0.45"), 17, wrong);
    expect_no_volume(folder.put("d.veg", material), "the material 'soft' must have");
  }
  expect_no_volume(folder.put("loop.veg", "*INCLUDE loop.veg\n"), "more than 8 deep");
  // Twenty files that name twenty each, and so on: 20^7 of them.
  for (int depth = 0; depth < 7; ++depth) {
    std::string many;
    for (int k = 0; k < 20; ++k) many += fmt::format("*INCLUDE bomb{}.veg\n", depth + 1);
    folder.put(fmt::format("bomb{}.veg", depth), many);
  }
  folder.put("bomb7.veg", "# nothing\n");
  expect_no_volume(folder / "bomb0.veg", "more than 1000 files");
  expect_no_volume(folder.put("e.veg", "*VERTICES\n1 3 0 0\n1 0 0 0\n*SHELLS\n"), "unknown section '*SHELLS'");
}

TEST(VertexLists, CommasBlanksAndComments) {
  const Folder folder;
  EXPECT_EQ(read_vertex_list(folder.put("a.bou", "1,3, 8,\n17 18 # feet\n\n256,265")),
            (std::vector<std::uint64_t>{1, 3, 8, 17, 18, 256, 265}));
  const std::string bad = folder.put("b.bou", "1,2\n3,x4");
  expect_file_error(bad, "line 2: 'x4'", [&] { read_vertex_list(bad); });
  const std::string empty = folder.put("c.bou", "\n# none\n");
  expect_file_error(empty, "names no vertices", [&] { read_vertex_list(empty); });
}

/// Files of every form, by their endings.
std::vector<std::pair<std::string, std::string>> all_mesh_files() {
  std::vector<std::pair<std::string, std::string>> all;
  for (const Msh& m : all_msh()) all.emplace_back("msh", m.file());
  all.emplace_back("mesh", medit_text());
  for (const int version : {1, 2, 3, 4}) all.emplace_back("meshb", medit_binary(version, version == 2));
  all.emplace_back("node", tetgen_nodes(0));
  all.emplace_back("ele", tetgen_cells(0));
  all.emplace_back("veg", vega_text());
  return all;
}

TEST(MeshReaders, TruncatedFilesAreErrors) {
  const Folder folder;
  folder.put("cut.1.node", tetgen_nodes(0));
  folder.put("cut.2.ele", tetgen_cells(0));
  for (const auto& [ending, bytes] : all_mesh_files()) {
    const std::string file = folder / ("cut." +
                                       std::string(ending == "ele"    ? "1."
                                                   : ending == "node" ? "2."
                                                                      : "") +
                                       ending);
    // Bytes after the last used number may be missing.
    const std::size_t needed = ending == "veg"     ? bytes.find("*MATERIAL")
                               : ending == "msh"   ? bytes.find("$EndElements")
                               : ending == "meshb" ? bytes.size() - 12
                                                   : bytes.size() - 3;
    for (std::size_t size = 1; size < needed - 2; size += size < 60 ? 1 : 5) {
      std::ofstream(file, std::ios::binary) << bytes.substr(0, size);
      EXPECT_FALSE(volume_readable(file)) << ending << ": " << size << " of " << bytes.size();
    }
    std::filesystem::remove(file);
    if (ending == "node" || ending == "ele") folder.put(ending == "node" ? "cut.1.node" : "cut.2.ele", bytes);
  }
}

TEST(MeshReaders, GarbledFilesAreErrorsOrMeshes) {
  const Folder folder;
  folder.put("cut.1.node", tetgen_nodes(0));
  folder.put("cut.2.ele", tetgen_cells(0));
  std::mt19937 random(5);
  for (const auto& [ending, bytes] : all_mesh_files()) {
    const std::string file = folder / ("cut." +
                                       std::string(ending == "ele"    ? "1."
                                                   : ending == "node" ? "2."
                                                                      : "") +
                                       ending);
    for (int round = 0; round < 60; ++round) {
      std::string damaged = bytes;
      for (int k = 0; k < 1 + round % 4; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      std::ofstream(file, std::ios::binary) << damaged;
      volume_readable(file);
    }
    std::filesystem::remove(file);
    if (ending == "node" || ending == "ele") folder.put(ending == "node" ? "cut.1.node" : "cut.2.ele", bytes);
  }
}

TEST(MeshReaders, SayWhatIsWrong) {
  const Folder folder;
  expect_no_volume(folder.put("a.msh", "(0 \"fluent\")"), "Fluent");
  expect_no_volume(folder.put("b.msh", "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n"), "version 3 of Gmsh's format");
  expect_no_volume(folder.put("c.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"), "holds no nodes");
  std::string medit = medit_text();
  expect_no_volume(folder.put("d.mesh", medit.replace(medit.find("Tetrahedra\n2\n1"), 14, "Tetrahedra\n2\n6")),
                   "the point 6");
  expect_no_volume(folder.put("e.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices\n1\n0 0 zero 0\n"),
                   "line 5: 'zero' is not a number");
  expect_no_volume(folder.put("f.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices\n900000\n0 0 0 0\n"),
                   "truncated");
  // Undeclared rows and columns, and invalid numbers.
  const std::string gmsh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n{}$EndNodes\n"
      "$Elements\n1\n1 4 0 1 2 3 4\n{}$EndElements\n";
  EXPECT_NO_THROW(read_volume(folder.put("t.msh", fmt::format(fmt::runtime(gmsh), "", ""))));
  expect_no_volume(folder.put("t.msh", fmt::format(fmt::runtime(gmsh), "5 1 1 1\n", "")), "more data in its $Nodes");
  expect_no_volume(folder.put("t.msh", fmt::format(fmt::runtime(gmsh), "", "2 4 0 1 2 4 3\n")),
                   "more data in its $Elements");
  expect_no_volume(folder.put("h.node", tetgen_nodes(1) + "6 1 1 1 0 0\n"), "more points than its header");
  std::string columns = tetgen_nodes(1);
  columns.insert(columns.find("\n2 "), " 5");
  expect_no_volume(folder.put("h.node", columns), "line 3: a row of its points has more columns");
  columns = tetgen_nodes(1);
  columns.replace(columns.find("\n2 ") + 3, 1, "1.5.5");
  expect_no_volume(folder.put("h.node", columns), "line 4: '1.5.5");
  folder.put("i.node", tetgen_nodes(1));
  expect_no_volume(folder.put("i.ele", tetgen_cells(1) + "3 1 2 3 4 5\n"), "more tetrahedra than its header");
  std::string twice = tetgen_nodes(1);
  twice.replace(twice.find("\n3 "), 3, "\n2 ");
  expect_no_volume(folder.put("g.node", twice), "two points the number 2");
}

}  // namespace
}  // namespace sansmesh::inline v1
