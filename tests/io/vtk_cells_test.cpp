// VTK cells of all kinds become linear cells with the same volume and all of their nodes, consistent across common
// faces.
#include <map>
#include <numeric>
#include <set>

#include "volume/volume_checks.h"
#include "vtk_test_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

double volume_of(const GridBlock& b, std::size_t cell) {
  double six = 0;
  for (const CellFace& f : cell_faces(b.cells.shapes[cell])) {
    const auto at = [&](std::size_t k) { return b.points[b.cells[cell][f.corner[k]]]; };
    for (std::size_t k = 2; k < f.count; ++k) six += dot(at(0), cross(at(k - 1), at(k)));
  }
  return six / 6;
}

double area_of(const GridBlock& b, const std::array<std::uint32_t, 4>& flat) {
  const auto at = [&](std::size_t k) { return b.points[flat[k]]; };
  double area = norm(cross(at(1) - at(0), at(2) - at(0))) / 2;
  if (flat[3] != GridBlock::kNone) area += norm(cross(at(2) - at(0), at(3) - at(0))) / 2;
  return area;
}

/// A cell in a separate unit of space.
struct KindOfCell {
  const char* name;
  int type;
  std::vector<Vec3> nodes;
  double size;         ///< volume or area
  std::size_t pieces;  ///< number of resulting pieces
  std::size_t unused = 0;
};

using Edges = std::vector<std::array<std::size_t, 2>>;

/// With edge midpoints after the corners.
std::vector<Vec3> with_middles(std::vector<Vec3> corners, const Edges& edges) {
  std::vector<Vec3> nodes = corners;
  for (const auto& [a, b] : edges) nodes.push_back((corners[a] + corners[b]) / 2);
  return nodes;
}
/// With face centres after them.
std::vector<Vec3> with_centres(std::vector<Vec3> nodes, const std::vector<std::vector<std::size_t>>& faces) {
  for (const auto& face : faces) {
    Vec3 sum;
    for (const std::size_t v : face) sum += nodes[v];
    nodes.push_back(sum / static_cast<double>(face.size()));
  }
  return nodes;
}
/// A ring of n corners below and one above.
std::vector<Vec3> prism(int n) {
  std::vector<Vec3> nodes;
  for (const double z : {0.0, 2.0}) {
    for (int k = 0; k < n; ++k) nodes.push_back({std::cos(2 * M_PI * k / n), std::sin(2 * M_PI * k / n), z});
  }
  return nodes;
}

const std::vector<Vec3> kTet{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Vec3> kPyramid{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
const std::vector<Vec3> kWedge{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}};
const std::vector<Vec3> kHex{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<Vec3> kQuad(kHex.begin(), kHex.begin() + 4), kTriangle(kTet.begin(), kTet.begin() + 3);
const Edges kTetEdges{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
const Edges kPyramidEdges{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
const Edges kWedgeEdges{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
const Edges kHexEdges{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
const Edges kWedgeTriangles(kWedgeEdges.begin(), kWedgeEdges.begin() + 6);
const Edges kQuadEdges{{0, 1}, {1, 2}, {2, 3}, {3, 0}}, kTriangleEdges{{0, 1}, {1, 2}, {2, 0}};

std::vector<KindOfCell> solids() {
  const std::vector<Vec3> hex20 = with_middles(kHex, kHexEdges), wedge15 = with_middles(kWedge, kWedgeEdges);
  const double pentagon = 2.5 * std::sin(2 * M_PI / 5) * 2, hexagon = 3 * std::sin(M_PI / 3) * 2;
  const std::vector<std::vector<std::size_t>> sides{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 2, 6, 7}};
  std::vector<std::vector<std::size_t>> all = sides;
  all.insert(all.end(), {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}});
  return {
      {"tetrahedron", 10, kTet, 1.0 / 6, 1},
      {"voxel", 11, {kHex[0], kHex[1], kHex[3], kHex[2], kHex[4], kHex[5], kHex[7], kHex[6]}, 1, 1},
      {"hexahedron", 12, kHex, 1, 1},
      {"wedge", 13, kWedge, 0.5, 1},
      {"pyramid", 14, kPyramid, 1.0 / 3, 1},
      {"pentagonal prism", 15, prism(5), pentagon, 3},
      {"hexagonal prism", 16, prism(6), hexagon, 2},
      {"quadratic tetrahedron", 24, with_middles(kTet, kTetEdges), 1.0 / 6, 8},
      {"quadratic hexahedron", 25, hex20, 1, 22},
      {"quadratic wedge", 26, wedge15, 0.5, 0},
      {"quadratic pyramid", 27, with_middles(kPyramid, kPyramidEdges), 1.0 / 3, 0},
      {"triquadratic hexahedron", 29, with_centres(hex20, all), 1, 8},
      {"quadratic linear wedge", 31, with_middles(kWedge, kWedgeTriangles), 0.5, 4},
      {"biquadratic wedge", 32, with_centres(wedge15, {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}), 0.5, 8},
      {"biquadratic hexahedron", 33, with_centres(hex20, sides), 1, 10},
      {"convex point set", 41, kHex, 1, 0},
      {"Lagrange tetrahedron", 71, with_middles(kTet, kTetEdges), 1.0 / 6, 8},
      {"Lagrange hexahedron", 72, kHex, 1, 1},
      {"Lagrange hexahedron 2", 72, with_centres(hex20, all), 1, 8},
  };
}

TEST(VtkCells, SolidsAreFilledByPiecesAtAllOfTheirNodes) {
  const Folder folder;
  for (const KindOfCell& kind : solids()) {
    SCOPED_TRACE(kind.name);
    TextGrid grid;
    grid.add(kind.type, kind.nodes);
    const Vec3 aside{10, 0, 0};
    std::vector<Vec3> moved = kTet;
    for (Vec3& p : moved) p += aside;
    grid.add(10, moved);  // shows that rows follow their cells
    const GridData data = read_volume(folder.put("a.vtu", grid.vtu()));
    ASSERT_EQ(data.blocks.size(), 1u);
    const GridBlock& b = data.blocks[0];
    const std::size_t n = b.cells.size() - 1;
    if (kind.pieces > 0) EXPECT_EQ(n, kind.pieces);
    double sum = 0;
    std::set<std::uint32_t> used;
    for (std::size_t c = 0; c < n; ++c) {
      EXPECT_GT(volume_of(b, c), 1e-6);
      sum += volume_of(b, c);
      for (const std::uint32_t v : b.cells[c]) used.insert(v);
      EXPECT_EQ(number(b.cell_arrays, "cell", c), 0);
    }
    EXPECT_NEAR(sum, kind.size, 1e-9);
    EXPECT_EQ(used.size(), kind.nodes.size() - kind.unused);
    EXPECT_EQ(number(b.cell_arrays, "cell", n), 1);
    EXPECT_EQ(b.piece_of.empty(), n == 1);
    for (std::size_t c = 1; c < b.piece_of.size(); ++c) EXPECT_EQ(b.piece_of[c] == b.piece_of[c - 1], c < n);
    EXPECT_EQ(data.notes.empty(), n == 1);
    for (std::size_t i = 0; i < b.points.size(); ++i) EXPECT_EQ(number(b.point_arrays, "x", i), b.points[i].x);
  }
}

/// Values at points of one cell follow its own functions: of degree `degree` on straight cells.
void expect_reproduced(const std::string& name, int type, const std::vector<Vec3>& nodes, int degree) {
  SCOPED_TRACE(name);
  const Folder folder;
  const auto f = [&](const Vec3& x) { return std::pow(0.5 + x.x - 0.75 * x.y + 0.25 * x.z, degree); };
  TextGrid grid;
  grid.add(type, nodes);
  std::vector<double> values;
  for (const Vec3& p : nodes) values.push_back(f(p));
  const std::string array = data_array("Float64", "f", 1, words(values));
  GridData data = read_volume(folder.put("a.vtu", grid.vtu(array)));
  EXPECT_EQ(data.blocks[0].higher.size(), 1u);
  const auto volume = test::volume_of(data);
  const Errors errors = errors_of(*field_of(volume, "linear"), points_within(*volume, 300), f);
  EXPECT_LT(errors.most, 1e-12);
  data.blocks[0].higher = {};
  const auto pieces = test::volume_of(data);
  EXPECT_GT(errors_of(*field_of(pieces, "linear"), points_within(*pieces, 300), f).most, 1e-3);
}

TEST(VtkCells, ValuesAtPointsFollowShapeFunctions) {
  for (const KindOfCell& kind : solids())
    if (kind.type >= 24 && kind.type != 31 && kind.type != 41 && kind.nodes.size() > 8)
      expect_reproduced(kind.name, kind.type, kind.nodes, 2);
  // Corners, two nodes an edge, a node in the middle of a face.
  std::vector<Vec3> cubic = kTet;
  for (const auto& [a, b] : kTetEdges)
    for (const double t : {1.0 / 3, 2.0 / 3}) cubic.push_back(kTet[a] + (kTet[b] - kTet[a]) * t);
  expect_reproduced("Lagrange tetrahedron 3", 71, with_centres(cubic, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 1, 2}}), 3);
  const std::vector<Vec3> wedge15 = with_middles(kWedge, kWedgeEdges);
  expect_reproduced("Lagrange wedge 2", 73, with_centres(wedge15, {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}), 2);
}

TEST(VtkCells, LagrangeCellsMayHaveDifferentOrdersAlongTheirAxes) {
  const Folder folder;
  const auto f = [](const Vec3& x) { return 1 + x.x * x.x - x.y + 2 * x.z + x.x * x.x * x.y * x.z; };
  TextGrid grid;
  grid.add(72, with_middles(kHex, {{0, 1}, {3, 2}, {4, 5}, {7, 6}}));
  std::vector<double> values;
  for (const Vec3& p : grid.points) values.push_back(f(p));
  const std::string degrees = data_array("Float64", "degrees", 3, "2 1 1");
  std::string file = grid.vtu(data_array("Float64", "f", 1, words(values)), degrees);
  const std::string cells = "<CellData>";
  file.replace(file.find(cells), cells.size(), "<CellData HigherOrderDegrees=\"degrees\">");
  const auto volume = test::volume_of(read_volume(folder.put("a.vtu", file)));
  EXPECT_EQ(volume->cells.size(), 2u);
  EXPECT_LT(errors_of(*field_of(volume, "linear"), points_within(*volume, 100), f).most, 1e-12);
}

TEST(VtkCells, FlatOnesCountWhereThereAreNoOthers) {
  const Folder folder;
  const std::vector<KindOfCell> kinds{
      {"triangle", 5, kTriangle, 0.5, 1},
      {"strip", 6, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 1, 2},
      {"polygon", 7, {}, 0, 0},
      {"pixel", 8, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 1, 1},
      {"quadrilateral", 9, kQuad, 1, 1},
      {"quadratic triangle", 22, with_middles(kTriangle, kTriangleEdges), 0.5, 4},
      {"quadratic quadrilateral", 23, with_middles(kQuad, kQuadEdges), 1, 5},
      {"biquadratic quadrilateral", 28, with_centres(with_middles(kQuad, kQuadEdges), {{0, 1, 2, 3}}), 1, 4},
      {"quadratic linear quadrilateral", 30, with_middles(kQuad, {{0, 1}, {2, 3}}), 1, 2},
      {"biquadratic triangle", 34, with_centres(with_middles(kTriangle, kTriangleEdges), {{0, 1, 2}}), 0.5, 6},
      {"Lagrange quadrilateral", 70,
       with_centres(with_middles(kQuad, {{0, 1}, {1, 2}, {3, 2}, {0, 3}}), {{0, 1, 2, 3}}), 1, 4},
  };
  for (KindOfCell kind : kinds) {
    SCOPED_TRACE(kind.name);
    if (kind.type == 7) {
      const std::vector<Vec3> ring = prism(5);
      kind.nodes.assign(ring.begin(), ring.begin() + 5);
      kind.size = 2.5 * std::sin(2 * M_PI / 5), kind.pieces = 3;
    }
    TextGrid grid;
    grid.add(3, {{5, 0, 0}, {6, 0, 0}});
    grid.add(kind.type, kind.nodes);
    const GridData data = read_volume(folder.put("a.vtu", grid.vtu()));
    const GridBlock& b = data.blocks[0];
    EXPECT_TRUE(b.cells.empty());
    ASSERT_EQ(b.flat_cells.size(), kind.pieces);
    double sum = 0;
    for (std::size_t c = 0; c < kind.pieces; ++c) {
      sum += area_of(b, b.flat_cells[c]);
      EXPECT_EQ(number(b.cell_arrays, "cell", c), 1);
    }
    EXPECT_NEAR(sum, kind.size, 1e-9);
    ASSERT_FALSE(data.notes.empty());
    EXPECT_EQ(data.notes.back(), "1 line was left out");
    grid.add(10, kTet);
    const GridData solid = read_volume(folder.put("a.vtu", grid.vtu()));
    EXPECT_TRUE(solid.blocks[0].flat_cells.empty());
    EXPECT_EQ(number(solid.blocks[0].cell_arrays, "cell", 0), 2);
  }
}

TEST(VtkCells, NeighboursAreCutAlikeWhereTheyMeet) {
  const Folder folder;
  for (const int type : {25, 42}) {
    TextGrid grid;
    for (const double x : {0.0, 1.0}) {
      std::vector<Vec3> nodes = kHex;
      for (Vec3& p : nodes) p.x += x;
      if (type == 25) nodes = with_middles(nodes, kHexEdges);
      grid.add(type, nodes, {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}});
    }
    const GridData data = read_volume(folder.put("a.vtu", grid.vtu()));
    const GridBlock& b = data.blocks[0];
    std::map<std::vector<std::uint32_t>, int> faces;
    double sum = 0;
    for (std::size_t c = 0; c < b.cells.size(); ++c) {
      EXPECT_GT(volume_of(b, c), 1e-9);
      sum += volume_of(b, c);
      for (const CellFace& f : cell_faces(b.cells.shapes[c])) {
        std::vector<std::uint32_t> key;
        for (std::size_t k = 0; k < f.count; ++k) key.push_back(b.cells[c][f.corner[k]]);
        std::sort(key.begin(), key.end());
        ++faces[key];
      }
    }
    EXPECT_NEAR(sum, 2, 1e-9);
    // Faces of one cell only are on the outside of the two.
    for (const auto& [corners, count] : faces) {
      EXPECT_LE(count, 2);
      if (count == 2) continue;
      bool outside = false;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double side : {0.0, axis == 0 ? 2.0 : 1.0})
          outside |=
              std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return b.points[v][axis] == side; });
      }
      EXPECT_TRUE(outside);
    }
  }
}

TEST(VtkCells, LinesAndVerticesAloneArePoints) {
  const Folder folder;
  TextGrid grid;
  grid.add(1, {{0, 0, 0}});
  grid.add(2, {{1, 0, 0}, {0, 1, 0}});
  grid.add(4, {{0, 0, 1}, {0, 0, 2}, {0, 0, 3}});
  const GridData data = read_volume(folder.put("a.vtu", grid.vtu()));
  EXPECT_EQ(data.blocks[0].kind, GridKind::scattered);
  EXPECT_EQ(data.blocks[0].points.size(), 6u);
  EXPECT_EQ(data.notes, (std::vector<std::string>{"1 line was left out", "2 vertices were left out"}));
}

TEST(VtkCells, CellsOfPointsThatAreNotThere) {
  const Folder folder;
  TextGrid grid;
  grid.add(10, kTet);
  grid.connectivity[2] = 17;
  expect_no_volume(folder.put("a.vtu", grid.vtu()), "cell 0 names point 17, but there are 4");
  grid.connectivity[2] = -1;
  expect_no_volume(folder.put("a.vtu", grid.vtu()), "cell 0 names point -1");
  expect_no_volume(folder.put("a.vtk", grid.legacy()), "cell 0 names point -1");
  TextGrid few;
  few.add(12, kTet);
  expect_no_volume(folder.put("a.vtu", few.vtu()), "too few");
}

}  // namespace
}  // namespace sansmesh::inline v1
