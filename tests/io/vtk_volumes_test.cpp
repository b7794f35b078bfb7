// Files read by the VTK module: grids of all kinds, blocks, levels, and third-party formats.
#include <limits>
#include <numeric>
#include <set>

#include "support/places.h"
#include "vtk_test_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

const std::vector<Vec3> kUnitTet{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

std::vector<int> first_numbers(int n) {
  std::vector<int> v(static_cast<std::size_t>(n));
  std::iota(v.begin(), v.end(), 0);
  return v;
}

std::string image(const std::string& attributes, const std::string& extent, const std::string& data) {
  return vtk_file("ImageData", "<ImageData WholeExtent=\"" + extent + "\" " + attributes + ">\n<Piece Extent=\"" +
                                   extent + "\">\n" + data + "</Piece>\n</ImageData>\n");
}

TEST(VtkModule, IsThere) {
  std::string why_not;
  EXPECT_TRUE(has_vtk_readers(&why_not)) << why_not;
}

TEST(VtkVolumes, ImagesAreTurnedAndShifted) {
  const Folder folder;
  const std::string file =
      folder.put("a.vti", image("Origin=\"1 2 3\" Spacing=\"0.5 2 1\" Direction=\"0 -1 0 1 0 0 0 0 1\"", "2 3 0 1 0 1",
                                "<PointData>" + data_array("Int32", "v", 1, words(first_numbers(8))) + "</PointData>"));
  const GridData data = read_volume(file);
  const GridBlock& b = data.blocks[0];
  ASSERT_EQ(b.kind, GridKind::lattice);
  for (std::size_t i = 0; i < 8; ++i) {
    const double x = static_cast<double>(2 + (i & 1)) * 0.5, y = static_cast<double>(i >> 1 & 1) * 2,
                 z = static_cast<double>(i >> 2);
    EXPECT_LT(norm(place(b, i) - Vec3{1 - y, 2 + x, 3 + z}), 1e-12);
    EXPECT_EQ(number(b.point_arrays, "v", i), static_cast<double>(i));
  }
  EXPECT_EQ(b.point_arrays.find("v")->type(), NumberType::i32);
}

std::string rectilinear(const std::string& x) {
  return vtk_file("RectilinearGrid",
                  "<RectilinearGrid WholeExtent=\"0 2 0 1 0 1\">\n<Piece Extent=\"0 2 0 1 0 1\">\n<CellData>" +
                      data_array("Float32", "load", 1, "1.5 2.5") + "</CellData><Coordinates>" +
                      data_array("Float64", "x", 1, x) + data_array("Float64", "y", 1, "0 2") +
                      data_array("Float64", "z", 1, "-1 4") + "</Coordinates></Piece></RectilinearGrid>\n");
}

TEST(VtkVolumes, RectilinearGridsOnAxesThatMayRunBackwards) {
  const Folder folder;
  const auto check = [&](const std::string& x, GridKind kind, const std::vector<double>& expected) {
    const GridData data = read_volume(folder.put("a.vtr", rectilinear(x)));
    const GridBlock& b = data.blocks[0];
    EXPECT_EQ(b.kind, kind);
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_EQ(place(b, i), (Vec3{expected[i % 3], i / 3 % 2 == 1 ? 2.0 : 0.0, i / 6 == 1 ? 4.0 : -1.0}));
    if (kind == GridKind::lattice) EXPECT_LT(b.axes[0][0], b.axes[0][1]);
    EXPECT_EQ(number(b.cell_arrays, "load", 1), 2.5);
  };
  check("0 1 5", GridKind::lattice, {0, 1, 5});
  check("5 1 0", GridKind::lattice, {5, 1, 0});
  check("0 1 1", GridKind::curvilinear, {0, 1, 1});
}

TEST(VtkVolumes, BlocksKeepTheirNamesAndSurfacesGoWhereThereAreVolumes) {
  const Folder folder;
  TextGrid a, b, surface;
  a.add(10, kUnitTet);
  b.add(10, {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
  surface.add(5, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  folder.put("a.vtu", a.vtu()), folder.put("b.vtu", b.vtu()), folder.put("s.vtu", surface.vtu());
  const std::string text =
      vtk_file("vtkMultiBlockDataSet",
               "<vtkMultiBlockDataSet>\n<DataSet index=\"0\" name=\"inner\" file=\"a.vtu\"/>\n"
               "<Block index=\"1\" name=\"group\"><DataSet index=\"0\" name=\"outer\" file=\"b.vtu\"/></Block>\n"
               "<DataSet index=\"2\" name=\"wall\" file=\"s.vtu\"/>\n</vtkMultiBlockDataSet>\n",
               "1.0");
  const GridData data = read_volume(folder.put("all.vtm", text));
  ASSERT_EQ(data.blocks.size(), 2u);
  EXPECT_EQ(data.blocks[0].name, "inner");
  EXPECT_EQ(data.blocks[1].name, "group/outer");
  EXPECT_EQ(data.blocks[1].points[0], (Vec3{5, 0, 0}));
  EXPECT_EQ(data.notes, (std::vector<std::string>{"1 block of surfaces was left out"}));
  std::filesystem::remove(folder / "b.vtu");
  expect_no_volume(folder / "all.vtm", "");
}

TEST(VtkVolumes, GhostsAndBlankedOnesAreHidden) {
  const Folder folder;
  TextGrid grid;
  grid.add(10, kUnitTet);
  grid.add(10, {{1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  const GridData data = read_volume(folder.put("a.vtu", grid.vtu(data_array("UInt8", "vtkGhostType", 1, "0 1 2 0 0"),
                                                                 data_array("UInt8", "vtkGhostType", 1, "0 1"))));
  const GridBlock& b = data.blocks[0];
  EXPECT_EQ(b.hidden_points, (std::vector<std::uint8_t>{0, 0, 1, 0, 0}));
  EXPECT_EQ(b.hidden_cells, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(b.point_arrays.find("vtkGhostType"), nullptr);
}

/// A coarse box of 2 x 2 x 2 cells, one of which is covered by a box of half their size.
std::string two_levels(const Folder& folder) {
  const auto box = [&](const char* name, double spacing, double origin) {
    const std::string s = std::to_string(spacing), o = std::to_string(origin);
    std::filesystem::create_directories(folder / "parts");
    return folder.put(
        std::string("parts/") + name,
        image("Origin=\"" + o + " " + o + " " + o + "\" Spacing=\"" + s + " " + s + " " + s + "\"", "0 2 0 2 0 2",
              "<CellData>" + data_array("Float64", "v", 1, words(first_numbers(8))) + "</CellData>"));
  };
  box("0.vti", 1, 0), box("1.vti", 0.5, 1);
  return vtk_file(
      "vtkOverlappingAMR",
      "<vtkOverlappingAMR origin=\"0 0 0\" grid_description=\"XYZ\">\n"
      "<Block level=\"0\" spacing=\"1 1 1\"><DataSet index=\"0\" amr_box=\"0 1 0 1 0 1\" "
      "file=\"parts/0.vti\"/></Block>\n"
      "<Block level=\"1\" spacing=\"0.5 0.5 0.5\"><DataSet index=\"0\" amr_box=\"2 3 2 3 2 3\" file=\"parts/1.vti\"/>"
      "</Block>\n</vtkOverlappingAMR>\n",
      "1.1");
}

/// Volume of all visible cells.
double visible_volume(const GridData& data) {
  double sum = 0;
  for (const GridBlock& b : data.blocks) {
    const std::size_t mx = b.axes[0].size() - 1, my = b.axes[1].size() - 1, mz = b.axes[2].size() - 1;
    for (std::size_t c = 0; c < mx * my * mz; ++c) {
      if (!b.hidden_cells.empty() && b.hidden_cells[c] != 0) continue;
      const std::size_t i = c % mx, j = c / mx % my, k = c / (mx * my);
      sum += (b.axes[0][i + 1] - b.axes[0][i]) * (b.axes[1][j + 1] - b.axes[1][j]) * (b.axes[2][k + 1] - b.axes[2][k]);
    }
  }
  return sum;
}

TEST(VtkVolumes, FinerLevelsHideWhatTheyCover) {
  const Folder folder;
  const std::string file = folder.put("a.vthb", two_levels(folder));
  const GridData data = read_volume(file);
  ASSERT_EQ(data.blocks.size(), 2u);
  EXPECT_EQ(data.blocks[0].level, 0);
  EXPECT_EQ(data.blocks[1].level, 1);
  EXPECT_EQ(data.blocks[0].hidden_cells, (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 1}));
  EXPECT_TRUE(data.blocks[1].hidden_cells.empty());
  EXPECT_NEAR(visible_volume(data), 8, 1e-12);
  EXPECT_EQ(place(data.blocks[1], 0), (Vec3{1, 1, 1}));
  std::string old = slurp(file);
  old.replace(old.find("1.1"), 3, "0.1");
  expect_no_volume(folder.put("old.vthb", old), "before 1.1");
  std::filesystem::remove(folder / "parts/1.vti");
  expect_no_volume(file, "");
}

TEST(VtkVolumes, LegacyFilesOfAllKinds) {
  const Folder folder;
  const std::string head = "# vtk DataFile Version 3.0\na test\nASCII\nDATASET ";
  const std::string points = "POINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\n";
  const std::string arrays =
      "POINT_DATA 8\nSCALARS p float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\nVECTORS v double\n" +
      words(first_numbers(24)) + "\nCELL_DATA 1\nSCALARS c int 1\nLOOKUP_TABLE default\n9\n";
  const std::pair<std::string, GridKind> kinds[] = {
      {"STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n", GridKind::lattice},
      {"RECTILINEAR_GRID\nDIMENSIONS 2 2 2\nX_COORDINATES 2 float\n0 1\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 "
       "float\n0 1\n",
       GridKind::lattice},
      {"STRUCTURED_GRID\nDIMENSIONS 2 2 2\n" + points, GridKind::curvilinear},
      {"UNSTRUCTURED_GRID\n" + points + "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n11\n", GridKind::unstructured},
      {"POLYDATA\n" + points + "POLYGONS 1 5\n4 0 1 3 2\n", GridKind::unstructured},
  };
  for (const auto& [text, kind] : kinds) {
    SCOPED_TRACE(text.substr(0, 20));
    const std::string whole = head + text + arrays;
    const GridData data = read_volume(folder.put("a.vtk", whole));
    ASSERT_EQ(data.blocks.size(), 1u);
    const GridBlock& b = data.blocks[0];
    EXPECT_EQ(b.kind, kind);
    EXPECT_TRUE(data.times.empty());
    ASSERT_EQ(point_count(b), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto bit = [&](std::size_t k) { return static_cast<double>(i >> k & 1); };
      EXPECT_EQ(place(b, i), (Vec3{bit(0), bit(1), bit(2)}));
      EXPECT_EQ(number(b.point_arrays, "p", i), static_cast<double>(i));
      EXPECT_EQ(number(b.point_arrays, "v", 3 * i + 2), static_cast<double>(3 * i + 2));
    }
    EXPECT_EQ(number(b.cell_arrays, "c", 0), 9);
    for (std::size_t n = 0; n < whole.size(); n += 9) volume_readable(folder.put("a.vtk", whole.substr(0, n)));
  }
  expect_no_volume(folder.put("a.vtk", "not one of these"), "# vtk DataFile");
  expect_no_volume(folder.put("a.vtk", head + "STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nPOINT_DATA 8\nSCALARS p float\n"),
                   "");
}

TEST(VtkVolumes, ShippedFilesAreWhole) {
  const GridData tets = read_volume(source_file("tests/data/post_tets.vtk"));
  ASSERT_EQ(tets.blocks.size(), 1u);
  const GridBlock& t = tets.blocks[0];
  EXPECT_EQ(t.points.size(), 2288u);
  EXPECT_EQ(t.cells.size(), 8750u);
  EXPECT_EQ(std::set<std::uint32_t>(t.cells.corners.begin(), t.cells.corners.end()).size(), t.points.size());
  EXPECT_EQ(t.point_arrays.find("Pressure")->rows(), t.points.size());
  const GridData comb = read_volume(source_file("tests/data/multicomb_0.vts"));
  EXPECT_EQ(comb.blocks[0].dims, (std::array<std::size_t, 3>{6, 12, 9}));
  EXPECT_EQ(comb.blocks[0].point_arrays.find("Momentum")->size(), 3u * 648);
  // Two adjacent unit cubes with the writer's order of corners.
  const GridData exodus = read_volume(source_file("tests/data/two_hexes.ex2"));
  ASSERT_EQ(exodus.blocks.size(), 1u);
  const GridBlock& e = exodus.blocks[0];
  ASSERT_EQ(e.points.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    const Vec3& p = e.points[i];
    EXPECT_EQ(number(e.point_arrays, "temp", i), 10 * (p.x + 3 * p.y + 6 * p.z));
  }
  EXPECT_EQ(e.cells.size(), 2u);
  EXPECT_EQ(number(e.cell_arrays, "load", 1), 1.5);
}

std::string ensight_line(const std::string& s) { return s + "\n"; }

TEST(VtkVolumes, EnsightWithSteps) {
  const Folder folder;
  std::string geo;
  for (const char* line : {"a test", "in text", "node id off", "element id off", "part", "         1", "body",
                           "coordinates", "         4"})
    geo += ensight_line(line);
  for (const char* line : {"0", "1", "0", "0", "0", "0", "1", "0", "0", "0", "0", "1"})
    geo += ensight_line(std::string(" ") + line + ".00000e+00");
  geo += "tetra4\n         1\n         1         2         3         4\n";
  folder.put("a.geo", geo);
  for (int step = 0; step < 2; ++step) {
    std::string values = "pressure\npart\n         1\ncoordinates\n";
    for (int i = 0; i < 4; ++i) values += " " + std::to_string(10 * step + i) + ".00000e+00\n";
    folder.put("a.p" + std::to_string(step), values);
  }
  const std::string file =
      folder.put("a.case",
                 "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: 1 pressure "
                 "a.p*\nTIME\ntime set: 1\n"
                 "number of steps: 2\nfilename start number: 0\nfilename increment: 1\ntime values: 0.5 1.5\n");
  for (std::size_t step = 0; step < 2; ++step) {
    const GridData data = read_volume(file, {.time_step = step});
    EXPECT_EQ(data.times, (std::vector<double>{0.5, 1.5}));
    EXPECT_EQ(data.time, step == 0 ? 0.5 : 1.5);
    ASSERT_EQ(data.blocks.size(), 1u);
    EXPECT_EQ(data.blocks[0].name, "body");
    EXPECT_EQ(data.blocks[0].cells.size(), 1u);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(number(data.blocks[0].point_arrays, "pressure", i),
                10.0 * static_cast<double>(step) + static_cast<double>(i));
  }
  EXPECT_THROW(read_volume(file, {.time_step = 2}), ArgumentError);
  std::filesystem::remove(folder / "a.geo");
  expect_no_volume(file, "");
}

TEST(VtkVolumes, OpenFoamCases) {
  const Folder folder;
  std::filesystem::create_directories(folder / "constant/polyMesh");
  std::filesystem::create_directories(folder / "system");
  std::filesystem::create_directories(folder / "0");
  const auto head = [](const std::string& kind, const std::string& object) {
    return "FoamFile { version 2.0; format ascii; class " + kind + "; object " + object + "; }\n";
  };
  folder.put("system/controlDict", head("dictionary", "controlDict") +
                                       "startFrom startTime; startTime 0; stopAt endTime; endTime 0; deltaT 1; "
                                       "writeControl timeStep; writeInterval 1; writeFormat ascii;\n");
  folder.put("constant/polyMesh/points",
             head("vectorField", "points") + "8((0 0 0)(1 0 0)(1 1 0)(0 1 0)(0 0 1)(1 0 1)(1 1 1)(0 1 1))\n");
  folder.put("constant/polyMesh/faces",
             head("faceList", "faces") + "6(4(0 4 7 3)4(1 2 6 5)4(0 1 5 4)4(3 7 6 2)4(0 3 2 1)4(4 5 6 7))\n");
  folder.put("constant/polyMesh/owner", head("labelList", "owner") + "6(0 0 0 0 0 0)\n");
  folder.put("constant/polyMesh/neighbour", head("labelList", "neighbour") + "0()\n");
  folder.put("constant/polyMesh/boundary",
             head("polyBoundaryMesh", "boundary") + "1(walls{type wall; nFaces 6; startFace 0;})\n");
  folder.put("0/T",
             head("volScalarField", "T") +
                 "dimensions [0 0 0 1 0 0 0];\ninternalField uniform 300;\nboundaryField{walls{type zeroGradient;}}\n");
  const GridData data = read_volume(folder.put("case.foam", ""));
  ASSERT_EQ(data.blocks.size(), 1u);
  EXPECT_EQ(data.blocks[0].points.size(), 8u);
  EXPECT_EQ(data.blocks[0].cells.shapes, (std::vector<CellShape>{CellShape::hexahedron}));
  EXPECT_EQ(number(data.blocks[0].cell_arrays, "T", 0), 300);
}

/// Values of the CGNS files at the corners.
double cgns_pressure(const Vec3& x) { return 1 + 2 * x.x - 3 * x.y + 0.5 * x.z; }

TEST(VtkVolumes, CgnsOfStructuredZones) {
  const GridData data = read_volume(source_file("tests/data/duct.cgns"));
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  EXPECT_EQ(b.kind, GridKind::curvilinear);
  ASSERT_EQ(b.dims, (std::array<std::size_t, 3>{4, 3, 3}));
  for (std::size_t i = 0; i < 36; ++i) {
    const double l = static_cast<double>(i % 4), j = static_cast<double>(i / 4 % 3), k = static_cast<double>(i / 12);
    EXPECT_NEAR(norm(b.points[i] - Vec3{l + 0.25 * j, 0.5 * j + 0.125 * l, 0.25 * k}), 0, 1e-6);
    EXPECT_NEAR(number(b.point_arrays, "Pressure", i), cgns_pressure(b.points[i]), 1e-5);
  }
  for (std::size_t c = 0; c < 12; ++c) EXPECT_EQ(number(b.cell_arrays, "Density", c), 100.0 + static_cast<double>(c));
}

TEST(VtkVolumes, CgnsOfUnstructuredZones) {
  const GridData data = read_volume(source_file("tests/data/mixed_cells.cgns"));
  ASSERT_EQ(data.blocks.size(), 1u);
  const GridBlock& b = data.blocks[0];
  EXPECT_EQ(b.kind, GridKind::unstructured);
  ASSERT_EQ(b.points.size(), 10u);
  EXPECT_EQ(b.cells.shapes,
            (std::vector<CellShape>{CellShape::hexahedron, CellShape::pyramid, CellShape::tetrahedron}));
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_NEAR(number(b.point_arrays, "Pressure", i), cgns_pressure(b.points[i]), 1e-12);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(number(b.cell_arrays, "Density", c), cgns_pressure(b.points[c]));
}

TEST(VtkVolumes, DamagedFilesAreErrors) {
  const Folder folder;
  TextGrid grid;
  grid.add(10, kUnitTet);
  grid.add(42, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {0, 2, 3}});
  const std::string whole = grid.vtu();
  ASSERT_TRUE(volume_readable(folder.put("a.vtu", whole)));
  for (std::size_t n = 0; n + 12 < whole.size(); n += 37) {
    if (volume_readable(folder.put("a.vtu", whole.substr(0, n)))) ADD_FAILURE() << n << " bytes of " << whole.size();
  }
  // VTK's reader trusts a file's faces of polyhedra, so there are none here.
  TextGrid simple;
  simple.add(10, kUnitTet);
  const std::string to_garble = simple.vtu();
  std::mt19937 random(9);
  for (int k = 0; k < 100; ++k) {
    std::string garbled = to_garble;
    garbled[random() % garbled.size()] = static_cast<char>('0' + random() % 10);
    volume_readable(folder.put("a.vtu", garbled));
  }
  const std::string tets = slurp(source_file("tests/data/post_tets.vtk"));
  for (const double part : {0.01, 0.1, 0.3, 0.6, 0.9, 0.99})
    EXPECT_FALSE(volume_readable(
        folder.put("t.vtk", tets.substr(0, static_cast<std::size_t>(part * static_cast<double>(tets.size()))))));
  const std::string exodus = slurp(source_file("tests/data/two_hexes.ex2"));
  for (std::size_t n = 4; n + 4 < exodus.size(); n += 40)
    EXPECT_FALSE(volume_readable(folder.put("e.ex2", exodus.substr(0, n)))) << n;
  expect_no_volume(folder.put("a.vtu", vtk_file("Table", "<Table></Table>\n")), "not a volume");
  expect_no_volume(folder.put("a.vti", "not XML"), "ending says");
  expect_no_volume(folder.put("a.case", "FORMAT\n"), "");
  expect_no_volume(folder.put("a.cgns", std::string(200, 'x')), "");
  for (const char* name : {"duct.cgns", "mixed_cells.cgns"}) {
    const std::string cgns = slurp(source_file(std::string("tests/data/") + name));
    for (const std::size_t n : {cgns.size() / 60, cgns.size() / 8, cgns.size() / 2, cgns.size() - 1000})
      EXPECT_FALSE(volume_readable(folder.put("b.cgns", cgns.substr(0, n)))) << name << ": " << n;
  }
  std::filesystem::create_directories(folder / "nothing");
  expect_no_volume(folder / "nothing", "without DICOM");
}

TEST(VtkModuleDeathTest, WithoutItOneLineSaysWhatIsMissing) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";  // in a process that has not loaded it yet
  const std::string file = source_file("tests/data/multicomb_0.vts");
  EXPECT_EXIT(
      {
        ::setenv("SANSMESH_VTK_MODULE", "/nowhere/module.so", 1);
        try {
          read_volume(file);
        } catch (const FileError& e) {
          std::fprintf(stderr, "%s\n", e.what());
          std::exit(is_clean(e.what()) ? 3 : 4);
        }
        std::exit(0);
      },
      ::testing::ExitedWithCode(3), "cannot be loaded");
}

}  // namespace
}  // namespace sansmesh::inline v1
