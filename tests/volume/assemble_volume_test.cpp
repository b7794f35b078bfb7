#include "sansmesh/volume/grid/assemble_volume.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "support/any_threads.h"
#include "volume/volume_checks.h"
#include "volume/volume_sizes.h"

namespace sansmesh::test {
namespace {

TEST(AssembleVolume, StarsAreSymmetricAscendingAndWithoutTheirSample) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    std::vector<std::uint32_t> star, back;
    std::size_t most = 0;
    for (std::size_t i = 0; i < volume->size(); ++i) {
      volume->star(i, star);
      ASSERT_FALSE(star.empty());
      ASSERT_TRUE(std::is_sorted(star.begin(), star.end()));
      most = std::max(most, star.size());
      for (const std::uint32_t j : star) {
        ASSERT_NE(i, j);
        volume->star(j, back);
        ASSERT_TRUE(std::binary_search(back.begin(), back.end(), i));
      }
    }
    EXPECT_GE(most, 4u);
  }
}

TEST(AssembleVolume, BoundaryEnclosesTheCells) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    const bool overlapping = grid.name.starts_with("overlapping");
    const double of_cells = overlapping ? volume_by_chance(*volume) : volume_of_cells(*volume);
    const TriangleMesh mesh = volume_boundary(*volume);
    // Curved faces are split into two triangles, which deviate from them.
    EXPECT_NEAR(measure_size(mesh).volume, of_cells,
                (overlapping || grid.name.starts_with("bent") ? 2e-2 : 1e-5) * of_cells);
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
    if (grid.name.starts_with("two levels") || grid.name.starts_with("overlapping") ||
        grid.name.starts_with("abutting, unlike"))
      continue;  // faces of different sizes meet there
    for (const auto& [a, b] : edges) ASSERT_EQ(edges.count({b, a}), edges.count({a, b}));
  }
}

TEST(AssembleVolume, PiecesOfACellShareOneSample) {
  const auto f = [](const Vec3& x) { return std::sin(3 * x.x) + x.y * x.z; };
  const auto cut = volume_of(cut_grid({6, 5, 7}, f), Association::cells);
  const auto lattice = volume_of(lattice_grid({6, 5, 7}, f), Association::cells);
  ASSERT_EQ(cut->size(), lattice->size());
  EXPECT_EQ(cut->cells.size(), 6 * cut->size());
  EXPECT_EQ(cut->facts.cells, lattice->facts.cells);
  const VolumeValues values = volume_values(*cut, "f");
  std::vector<std::uint32_t> star, expected;
  std::map<std::array<long, 3>, std::size_t> there;
  const auto key = [](const Vec3& x) {
    return std::array{std::lround(1e6 * x.x), std::lround(1e6 * x.y), std::lround(1e6 * x.z)};
  };
  for (std::size_t i = 0; i < lattice->size(); ++i) there[key(lattice->position(i))] = i;
  for (std::size_t i = 0; i < cut->size(); ++i) {
    EXPECT_NEAR(values.values[i], f(cut->position(i)), 1e-12);
    const auto at = there.find(key(cut->position(i)));
    ASSERT_NE(at, there.end());
    cut->star(i, star), lattice->star(at->second, expected);
    EXPECT_EQ(star.size(), expected.size());
  }
}

TEST(AssembleVolume, PiecesMustBeNumberedForEachCell) {
  GridData data = cut_grid({3, 3, 3}, linear_function);
  data.blocks[0].piece_of.pop_back();
  EXPECT_THROW(volume_of(data, Association::cells), DataError);
}

double length_of(const PolylineSet& lines) {
  double sum = 0;
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t p = lines.offsets[i]; p + 1 < lines.offsets[i + 1]; ++p)
      sum += norm(Vec3(lines.positions[p + 1]) - Vec3(lines.positions[p]));
  return sum;
}

TEST(AssembleVolume, BoundaryEdgesAreUniqueEdgesOfOuterFaces) {
  // A unit cube of 3 × 3 × 3 cells: on every axis 4 lines on each of two sides, and 2 on each of the two others.
  const GridData lattice = lattice_grid({4, 4, 4}, linear_function);
  const PolylineSet lines = boundary_edges(*volume_of(lattice));
  EXPECT_EQ(lines.size(), 36u);
  EXPECT_NEAR(length_of(lines), 36, 1e-5);
  // The single edges of cells.
  const PolylineSet edges = boundary_edges(*volume_of(bent_grid({4, 4, 4}, linear_function)));
  EXPECT_EQ(edges.size(), 108u);
  // For cell data, lines are on the cell borders, not through the cell centres.
  const PolylineSet in_cells = boundary_edges(*volume_of(lattice, Association::cells));
  EXPECT_EQ(in_cells.size(), 36u);
  std::set<float> heights;
  for (const Vec3f& x : in_cells.positions)
    heights.insert(std::round(300 * (x.z + static_cast<float>(in_cells.origin.z))));
  EXPECT_EQ(heights, (std::set<float>{0, 100, 200, 300}));
  // Tetrahedra also have diagonals; hidden faces between levels are not drawn twice.
  EXPECT_EQ(boundary_edges(*volume_of(tetrahedra_grid({4, 4, 4}, linear_function))).size(), 108u + 54u);
  const auto amr = volume_of(two_level_amr(8, linear_function), Association::cells);
  const PolylineSet levels = boundary_edges(*amr);
  EXPECT_GT(levels.size(), 0u);
  const Box3 box = amr->bounds();
  for (const Vec3f& at : levels.positions) {
    const Vec3 x = levels.origin + Vec3(at);
    double to_side = box.diagonal();
    for (std::size_t k = 0; k < 3; ++k)
      to_side = std::min({to_side, std::abs(x[k] - box.lower[k]), std::abs(x[k] - box.upper[k])});
    ASSERT_LT(to_side, 1e-5);
  }
}

TEST(AssembleVolume, RepairsCells) {
  const auto o = volume_of(o_grid({17, 5, 6}, linear_function));
  EXPECT_EQ(o->size(), (1 + 16 * 4) * 6u);  // one axis, one seam
  EXPECT_EQ(o->cells.size(), 16 * 4 * 5u);
  EXPECT_EQ(o->facts.degenerate, 16 * 5u);
  EXPECT_EQ(o->facts.parts, 1u);
  EXPECT_EQ(std::count(o->cells.shapes.begin(), o->cells.shapes.end(), CellShape::wedge), 16 * 5);

  // A hexahedron with an edge of zero length: two pyramids with the same volume.
  GridBlock block = tetrahedra_of(lattice_block({2, 2, 2}));
  block.cells = {};
  block.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  block.cells.add(CellShape::hexahedron, std::array<std::uint32_t, 8>{0, 1, 2, 3, 4, 4, 6, 7});
  const auto collapsed = volume_of(one_block(block, linear_function));
  EXPECT_EQ(collapsed->facts.degenerate, 1u);
  EXPECT_EQ(collapsed->cells.size(), 2u);
  EXPECT_NEAR(volume_of_cells(*collapsed), measure_size(volume_boundary(*collapsed)).volume, 1e-6);

  // An inverted cell among others is turned.
  GridBlock turned = tetrahedra_of(lattice_block({3, 3, 3}));
  std::swap(turned.cells.corners[0], turned.cells.corners[1]);
  const auto upright = volume_of(one_block(turned, linear_function));
  EXPECT_EQ(upright->facts.inverted, 1u);
  EXPECT_NEAR(volume_of_cells(*upright), 1, 1e-12);
}

TEST(AssembleVolume, AnyCornersOfACellMayCoincide) {
  std::mt19937 random(11);
  std::size_t kept = 0, missed = 0;
  for (int i = 0; i < 2000; ++i) {
    GridBlock block;
    block.kind = GridKind::unstructured;
    const GridBlock cube = lattice_block({2, 2, 2});
    for (std::size_t p = 0; p < 8; ++p) block.points.push_back(bend(block_point(cube, p)));
    constexpr CellShape kShapes[] = {CellShape::tetrahedron, CellShape::pyramid, CellShape::wedge,
                                     CellShape::hexahedron};
    const CellShape shape = kShapes[i % 4];
    const std::vector<std::uint32_t> of_shape[] = {
        {0, 1, 2, 4}, {0, 1, 3, 2, 4}, {0, 2, 1, 4, 6, 5}, {0, 1, 3, 2, 4, 5, 7, 6}};
    std::vector<std::uint32_t> corners = of_shape[i % 4];
    if (i % 3 == 0) std::shuffle(corners.begin(), corners.end(), random);
    for (std::size_t k = random() % 4; k > 0; --k)
      corners[random() % corners.size()] = corners[random() % corners.size()];
    block.cells.add(shape, corners);
    std::shared_ptr<const SampledVolume> volume;
    try {
      volume = volume_of(one_block(block, linear_function));
    } catch (const DataError&) {
      continue;  // no cells remain
    }
    ++kept;
    for (std::size_t c = 0; c < volume->cells.size(); ++c) {
      const auto of_cell = volume->cells[c];
      EXPECT_EQ(std::set<std::uint32_t>(of_cell.begin(), of_cell.end()).size(), of_cell.size());
    }
    EXPECT_GT(volume_of_cells(*volume), 0);
    const auto x = points_within(*volume, 20);
    std::vector<CellLocation> locations(x.size());
    VolumeLocator(*volume).locate(x, locations);
    std::vector<double> values(x.size());
    field_of(volume, "linear")->evaluate(x, {values});
    for (std::size_t k = 0; k < x.size(); ++k) {
      // Many of these cells are folded several times, and cover some points repeatedly.
      if (!locations[k].inside) {
        ++missed;
        continue;
      }
      EXPECT_NEAR(values[k], linear_function(x[k]), 1e-6) << i;
    }
  }
  EXPECT_GT(kept, 1000u);
  EXPECT_LT(missed, 20u);  // more than 20000 points in all
}

TEST(AssembleVolume, SingleLayersBecomeSlabs) {
  for (const GridBlock& block :
       {lattice_block({6, 5, 1}), curvilinear_block(lattice_block({6, 1, 5}), [](const Vec3& x) { return x; })})
    for (const Association a : {Association::points, Association::cells}) {
      GridData data;
      data.blocks = {block};
      std::vector<double> points, cells;
      for (std::size_t i = 0; i < 30; ++i) points.push_back(linear_function(block_point(data.blocks[0], i)));
      for (std::size_t i = 0; i < 20; ++i) cells.push_back(1);
      data.blocks[0].point_arrays.set("f", points);
      data.blocks[0].cell_arrays.set("f", cells);
      const auto volume = volume_of(data, a);
      EXPECT_GT(volume->facts.layer, 0.15);
      const auto field = field_of(volume, "linear");
      const Vec3 x = block_point(data.blocks[0], 7) + Vec3{0.05, 0, 0};
      double value = 0;
      std::uint8_t inside = 0;
      field->evaluate({&x, 1}, {{&value, 1}, {}, {&inside, 1}});
      EXPECT_EQ(inside, 1);
      EXPECT_NEAR(value, a == Association::points ? linear_function(x) : 1, 1e-12);
    }
}

TEST(AssembleVolume, FlatBlocksBecomeOneSlab) {
  // Three sheets with common points; the second is reversed and stretched, the third consists of triangles and squares
  // of both orientations.
  GridData data;
  data.blocks.push_back(curvilinear_block(lattice_block({5, 5, 1}), [](const Vec3& x) { return x; }));
  data.blocks.push_back(curvilinear_block(lattice_block({9, 5, 1}), [](const Vec3& x) {
    return Vec3{2 - x.x * x.x, x.y, 0};
  }));
  GridBlock& third = data.blocks.emplace_back();
  third.kind = GridKind::unstructured;
  for (std::uint32_t j = 0; j < 5; ++j)
    for (std::uint32_t i = 0; i < 3; ++i) third.points.push_back({2 + i / 2.0, j / 4.0, 0});
  for (std::uint32_t j = 0; j < 4; ++j)
    for (std::uint32_t i = 0; i < 2; ++i) {
      const std::uint32_t p = i + 3 * j;
      if (i == 0)
        third.flat_cells.push_back(j % 2 == 0 ? std::array{p, p + 1, p + 4, p + 3}
                                              : std::array{p, p + 3, p + 4, p + 1});
      else
        third.flat_cells.insert(third.flat_cells.end(),
                                {{p, p + 1, p + 4, GridBlock::kNone}, {p, p + 3, p + 4, GridBlock::kNone}});
    }
  for (GridBlock& b : data.blocks) {
    std::vector<double> f;
    for (const Vec3& p : b.points) f.push_back(linear_function(p));
    b.point_arrays.set("f", std::move(f));
  }
  for (int turn = 0; turn < 3; ++turn) {
    const auto volume = volume_of(data);
    const double layer = volume->facts.layer;
    EXPECT_GT(layer, 0);
    EXPECT_EQ(volume->facts.parts, 1u);
    EXPECT_EQ(volume->facts.inverted, 0u);
    EXPECT_EQ(volume->facts.degenerate, 0u);
    EXPECT_EQ(volume->facts.merged, 20u);  // two borders of five points on two sides
    EXPECT_NEAR(volume_of_cells(*volume), 3 * layer, 1e-12);
    EXPECT_NEAR(measure_size(volume_boundary(*volume)).volume, 3 * layer, 1e-6);
    for (const Vec3& p : volume->positions) EXPECT_NEAR(std::abs(p.z), layer / 2, 1e-12);
    std::rotate(data.blocks.begin(), data.blocks.begin() + 1, data.blocks.end());
  }
}

TEST(AssembleVolume, SheetsHaveConsistentSides) {
  // A closed sheet with random orientation of cells becomes a shell of even thickness.
  const GridBlock ring =
      curvilinear_block(lattice_block({25, 9, 1}, {0, 0, 0}, {2 * std::numbers::pi, 1, 0}), [](const Vec3& x) {
        return Vec3{std::cos(x.x), std::sin(x.x), x.y};
      });
  GridData data;
  GridBlock& block = data.blocks.emplace_back();
  block.kind = GridKind::unstructured;
  block.points = ring.points;
  std::mt19937 random(4);
  for (std::uint32_t j = 0; j < 8; ++j)
    for (std::uint32_t i = 0; i < 24; ++i) {
      const std::uint32_t p = i + 25 * j;
      block.flat_cells.push_back(random() % 2 == 0 ? std::array{p, p + 1, p + 26, p + 25}
                                                   : std::array{p, p + 25, p + 26, p + 1});
    }
  block.point_arrays.set("f", std::vector<double>(block.points.size(), 1.0));
  const auto volume = volume_of(data);
  EXPECT_EQ(volume->facts.inverted, 0u);
  EXPECT_EQ(volume->facts.degenerate, 0u);
  EXPECT_EQ(volume->size(), 2u * 24 * 9);
  const double half = volume->facts.layer / 2;
  for (const Vec3& p : volume->positions) EXPECT_NEAR(std::abs(std::hypot(p.x, p.y) - 1), half, 1e-9);
  const double area = 24 * 2 * std::sin(std::numbers::pi / 24);  // circumference of the polygon times 1
  EXPECT_NEAR(volume_of_cells(*volume), area * std::cos(std::numbers::pi / 24) * 2 * half, 1e-9);
}

TEST(AssembleVolume, HiddenAndNonFinitePointsRemoveTheirCells) {
  GridData data = bent_grid({5, 5, 5}, linear_function);
  data.blocks[0].hidden_points.assign(125, 0);
  data.blocks[0].hidden_points[62] = 1;
  data.blocks[0].points[0].y = std::numeric_limits<double>::quiet_NaN();
  const auto volume = volume_of(data);
  EXPECT_EQ(volume->cells.size(), 64u - 8 - 1);
  EXPECT_EQ(volume->facts.hidden, 1u);
  EXPECT_EQ(volume->facts.not_finite, 1u);
  EXPECT_EQ(volume->size(), 123u);
  GridData lattice = lattice_grid({4, 4, 4}, linear_function);
  lattice.blocks[0].hidden_cells.assign(27, 0);
  lattice.blocks[0].hidden_cells[13] = 1;
  const auto hollow = volume_of(lattice, Association::cells);
  EXPECT_EQ(hollow->size(), 26u);
  EXPECT_NEAR(measure_size(volume_boundary(*hollow)).volume, 26.0 / 27, 1e-6);
}

TEST(AssembleVolume, PartsAreNumbered) {
  GridData data = lattice_grid({3, 3, 3}, linear_function);
  GridBlock far = lattice_block({3, 3, 3}, {5, 5, 5}, {6, 6, 6});
  set_function(far, linear_function);
  data.blocks.push_back(far);
  const auto volume = volume_of(data);
  EXPECT_EQ(volume->facts.parts, 2u);
  ASSERT_EQ(volume->part.size(), 54u);
  EXPECT_EQ(std::count(volume->part.begin(), volume->part.end(), 0u), 27);
}

TEST(AssembleVolume, ScatteredPointsFillTheirHull) {
  const auto volume = volume_of(scattered_grid(3000, linear_function));
  EXPECT_TRUE(volume->scattered);
  EXPECT_EQ(volume->size(), 3000u);
  EXPECT_NEAR(volume_of_cells(*volume), 1, 1e-9);
  EXPECT_NEAR(measure_size(volume_boundary(*volume)).volume, 1, 1e-5);
  // No sample is inside the circumsphere of a cell: it would be nearer to the centre than the corners.
  for (std::size_t c = 0; c < volume->cells.size(); c += 97) {
    const auto corners = volume->cells[c];
    const Vec3 o = volume->positions[corners[0]];
    Matrix3 rows{{}, {}, {}};
    Vec3 right;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 d = volume->positions[corners[k + 1]] - o;
      (k == 0 ? rows.a : k == 1 ? rows.b : rows.c) = d;
      right[k] = squared_norm(d) / 2;
    }
    const Vec3 center = rows.solve_transposed(right);
    for (const Vec3& p : volume->positions) ASSERT_GE(norm(p - o - center), norm(center) * (1 - 1e-5) - 1e-7);
  }
}

TEST(AssembleVolume, OrderOfScatteredPointsHasNoEffect) {
  GridData data = scattered_grid(500, linear_function), other = data;
  std::reverse(other.blocks[0].points.begin(), other.blocks[0].points.end());
  set_function(other.blocks[0], linear_function);
  EXPECT_TRUE(same_but_for_blocks(*volume_of(data), *volume_of(other)));
  // Duplicate points give the same samples.
  GridData twice = data;
  twice.blocks[0].points.insert(twice.blocks[0].points.end(), data.blocks[0].points.begin(),
                                data.blocks[0].points.end());
  twice.blocks[0].point_arrays.clear();
  set_function(twice.blocks[0], linear_function);
  const auto one = volume_of(data), two = volume_of(twice);
  EXPECT_EQ(two->facts.merged, 500u);
  EXPECT_EQ(one->cells.corners, two->cells.corners);
}

TEST(AssembleVolume, BadDataGiveOneLineErrors) {
  Progress progress;
  const auto refused = [&](const GridData& data, Association a = Association::points) {
    try {
      assemble_volume(data, a, progress);
    } catch (const DataError& e) {
      return std::string(e.what()).find('\n') == std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused({}));
  GridBlock line = lattice_block({5, 1, 1});
  EXPECT_TRUE(refused(one_block(curvilinear_block(line, [](const Vec3& x) { return x; }), linear_function)));
  GridData broken = tetrahedra_grid({3, 3, 3}, linear_function);
  broken.blocks[0].cells.corners[5] = 1000;
  EXPECT_TRUE(refused(broken));
  GridData nowhere = bent_grid({3, 3, 3}, linear_function);
  for (Vec3& p : nowhere.blocks[0].points) p.x = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused(nowhere));
  GridData flat = bent_grid({3, 3, 3}, linear_function);
  for (Vec3& p : flat.blocks[0].points) p.z = 0;
  EXPECT_TRUE(refused(flat));
  for (const double scale : {1e38, 1e-40}) {
    GridData extreme = bent_grid({3, 3, 3}, linear_function);
    for (Vec3& p : extreme.blocks[0].points) p = p * scale;
    EXPECT_TRUE(refused(extreme));
    GridData lattice = one_block(lattice_block({3, 3, 3}), linear_function);
    for (std::vector<double>& axis : lattice.blocks[0].axes)
      for (double& x : axis) x *= scale;
    EXPECT_TRUE(refused(lattice));
  }
  GridData hidden = bent_grid({3, 3, 3}, linear_function);
  hidden.blocks[0].hidden_cells.assign(8, 1);
  EXPECT_TRUE(refused(hidden));
  GridData bare = bent_grid({3, 3, 3}, linear_function);
  bare.blocks[0].point_arrays.clear();
  EXPECT_TRUE(refused(bare));
  bare.blocks[0].cell_arrays.clear();  // a grid without arrays is valid
  EXPECT_EQ(assemble_volume(bare, Association::points, progress).size(), 27u);
  GridData few = scattered_grid(8, linear_function);
  few.blocks[0].points.resize(3);
  few.blocks[0].point_arrays.clear();
  set_function(few.blocks[0], linear_function);
  EXPECT_TRUE(refused(few));
  GridData plane = scattered_grid(50, linear_function);
  for (Vec3& p : plane.blocks[0].points) p.z = 0.5 * p.x - p.y;
  EXPECT_TRUE(refused(plane));
  EXPECT_TRUE(refused(plane, Association::cells));
}

TEST(AssembleVolume, NegligibleLengthsBecomeZero) {
  GridData data = bent_grid({3, 3, 3}, linear_function);
  for (std::size_t p = 0; p < 9; ++p) data.blocks[0].points[p].x = 1e-310 * static_cast<double>(p);
  Progress progress;
  const SampledVolume volume = assemble_volume(data, Association::points, progress);
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const double x = volume.position(i).x;
    EXPECT_TRUE(x == 0 || std::abs(x) > 1e-100) << x;
  }
}

}  // namespace
}  // namespace sansmesh::test
