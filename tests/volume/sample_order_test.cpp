// The order of points, cells and blocks in a file does not change a bit of the reconstruction.
#include <algorithm>
#include <cstring>
#include <numeric>

#include "support/sanitizers.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

double wavy(const Vec3& x) { return std::sin(3 * x.x + 1) * std::cos(2 * x.y - x.z) + 0.3 * x.z * x.z; }

std::vector<std::uint32_t> shuffled(std::size_t n, std::mt19937& random) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

template <class T>
std::vector<T> rows_taken(const std::vector<T>& from, const std::vector<std::uint32_t>& rows) {
  std::vector<T> to;
  if (!from.empty())
    for (const std::uint32_t r : rows) to.push_back(from[r]);
  return to;
}

/// Permutes the points and cells of a block without structure; each cell keeps the order of its corners.
void shuffle_rows(GridBlock& b, std::mt19937& random) {
  const auto points = shuffled(b.points.size(), random);
  std::vector<std::uint32_t> now(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) now[points[i]] = static_cast<std::uint32_t>(i);
  b.points = rows_taken(b.points, points);
  b.hidden_points = rows_taken(b.hidden_points, points);
  b.point_arrays = b.point_arrays.taken(points);
  const bool flat = b.cells.empty();
  const auto rows = shuffled(flat ? b.flat_cells.size() : b.cells.size(), random);
  b.hidden_cells = rows_taken(b.hidden_cells, rows);
  b.cell_arrays = b.cell_arrays.taken(rows);
  b.flat_cells = rows_taken(b.flat_cells, rows);
  for (auto& ring : b.flat_cells)
    for (std::uint32_t& p : ring)
      if (p != GridBlock::kNone) p = now[p];
  CellList cells;
  for (const std::uint32_t r : rows) {
    if (flat) break;
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t p : b.cells[r]) corners.push_back(now[p]);
    cells.add(b.cells.shapes[r], corners);
  }
  b.cells = std::move(cells);
}

GridData shuffled_data(GridData data, unsigned seed) {
  std::mt19937 random(seed);
  for (GridBlock& b : data.blocks)
    if (b.kind == GridKind::unstructured || b.kind == GridKind::scattered) shuffle_rows(b, random);
  std::shuffle(data.blocks.begin(), data.blocks.end(), random);
  return data;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

struct Probed {
  std::vector<double> values;
  std::vector<Vec3> gradients;
  std::vector<std::uint8_t> inside;
};

Probed probe(const GridData& data, Association a, const std::string& method, const std::vector<Vec3>& x) {
  Probed p{std::vector<double>(x.size()), std::vector<Vec3>(x.size()), std::vector<std::uint8_t>(x.size())};
  field_of(volume_of(data, a), method)->evaluate(x, {p.values, p.gradients, p.inside});
  return p;
}

/// Two unstructured blocks of different tetrahedra side by side.
GridData two_unstructured() {
  GridData data;
  data.blocks.push_back(tetrahedra_of(lattice_block({5, 5, 5})));
  data.blocks.push_back(tetrahedra_of(lattice_block({6, 6, 6}, {1, 0, 0}, {2, 1, 1})));
  for (GridBlock& b : data.blocks) set_function(b, wavy);
  return data;
}

/// Tetrahedra with separate points: as many coincide as cells meet there, with different values.
GridData torn() {
  const GridBlock whole = tetrahedra_of(lattice_block({4, 4, 5}));
  GridBlock block;
  block.kind = GridKind::unstructured;
  for (std::size_t c = 0; c < whole.cells.size(); ++c) {
    std::array<std::uint32_t, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = static_cast<std::uint32_t>(block.points.size());
      block.points.push_back(whole.points[whole.cells[c][k]]);
    }
    block.cells.add(CellShape::tetrahedron, corners);
  }
  GridData data = one_block(block, wavy);
  std::vector<double> values = *data.blocks[0].point_arrays.find<double>("f");
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 1e-3 * std::sin(static_cast<double>(i));
  data.blocks[0].point_arrays.set("f", std::move(values));
  return data;
}

/// Triangles and quadrilaterals in a bent sheet.
GridData sheet() {
  GridBlock block;
  block.kind = GridKind::unstructured;
  constexpr std::uint32_t n = 9;
  for (std::uint32_t i = 0; i < n * n; ++i) {
    const std::uint32_t column = i % n, row = i / n;
    const double x = static_cast<double>(column) / (n - 1), y = static_cast<double>(row) / (n - 1);
    block.points.push_back({x + 0.05 * std::sin(9 * y), y, 0.2 * std::sin(2 * x)});
  }
  for (std::uint32_t j = 0; j + 1 < n; ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t p = i + n * j;
      if ((i + j) % 3 == 0)
        block.flat_cells.push_back({p, p + n, p + n + 1, p + 1});  // reversed orientation
      else if ((i + j) % 3 == 1)
        block.flat_cells.push_back({p, p + 1, p + n + 1, p + n});
      else
        block.flat_cells.insert(block.flat_cells.end(),
                                {{p, p + 1, p + n + 1, GridBlock::kNone}, {p, p + n + 1, p + n, GridBlock::kNone}});
    }
  std::vector<double> of_points, of_cells;
  for (const Vec3& p : block.points) of_points.push_back(wavy(p));
  for (std::size_t c = 0; c < block.flat_cells.size(); ++c)
    of_cells.push_back(wavy(block.points[block.flat_cells[c][0]]));
  block.point_arrays.set("f", std::move(of_points));
  block.cell_arrays.set("f", std::move(of_cells));
  GridData data;
  data.blocks.push_back(std::move(block));
  return data;
}

GridData with_holes() {
  GridData data = tetrahedra_grid({6, 5, 5}, wavy);
  GridBlock& b = data.blocks[0];
  b.hidden_cells.assign(b.cells.size(), 0);
  b.hidden_points.assign(b.points.size(), 0);
  for (std::size_t c = 0; c < b.cells.size(); c += 17) b.hidden_cells[c] = 1;
  b.hidden_points[40] = 1;
  b.points[3].x = std::numeric_limits<double>::quiet_NaN();
  return data;
}

TEST(SampleOrder, HasNoEffectOnAnyAnswer) {
  SANSMESH_NOT_SANITIZED("compares results; others make the same fields");
  std::vector<NamedGrid> grids;
  const auto add = [&](const char* name, const GridData& data) {
    for (const Association a : {Association::points, Association::cells}) grids.push_back({name, data, a});
  };
  add("tetrahedra", tetrahedra_grid({6, 5, 5}, wavy));
  add("tetrahedra of an o-grid", one_block(tetrahedra_of(o_grid_block({13, 4, 5})), wavy));
  add("mixed", mixed_grid({7, 4, 4}, wavy));
  add("two blocks", two_unstructured());
  add("torn", torn());
  add("sheet", sheet());
  add("holes", with_holes());
  grids.push_back({"scattered", scattered_grid(400, wavy)});
  GridData twice = scattered_grid(200, wavy);
  twice.blocks.push_back(scattered_grid(150, [](const Vec3& x) { return wavy(x) + 0.01; }).blocks[0]);
  grids.push_back({"scattered in two blocks, some points the same", twice});
  const std::string kMethods[] = {"linear", "mls", "mls-detail", "amls"};
  for (const NamedGrid& grid : grids) {
    SCOPED_TRACE(grid.name + (grid.association == Association::cells ? ", cells" : ""));
    std::vector<Vec3> x = points_within(*volume_of(grid.data, grid.association), 300);
    for (const Vec3& more : {Vec3{-1, 0.5, 0.5}, Vec3{1.2, 3, -0.5}, Vec3{0.5, 0.5, 0.5}}) x.push_back(more);
    const GridData other = shuffled_data(grid.data, 11);
    for (const std::string& method : kMethods) {
      const Probed one = probe(grid.data, grid.association, method, x);
      const Probed two = probe(other, grid.association, method, x);
      EXPECT_TRUE(same_bytes(one.values, two.values)) << method;
      EXPECT_TRUE(same_bytes(one.gradients, two.gradients)) << method;
      EXPECT_TRUE(same_bytes(one.inside, two.inside)) << method;
    }
  }
}

TEST(SampleOrder, NeighboursInSpaceAreNeighboursInMemory) {
  // Along a space-filling curve most links between n samples span far less than n / 4, the expectation for a random
  // order.
  for (const GridData& data :
       {shuffled_data(tetrahedra_grid({16, 16, 16}, wavy), 3), shuffled_data(scattered_grid(4000, wavy), 3)}) {
    const auto volume = volume_of(data);
    std::vector<double> spans;
    for (std::uint32_t i = 0; i < volume->size(); ++i)
      for (const std::uint32_t j : volume->stars[i]) spans.push_back(std::abs(static_cast<double>(j) - i));
    std::nth_element(spans.begin(), spans.begin() + static_cast<std::ptrdiff_t>(spans.size() / 2), spans.end());
    EXPECT_LT(spans[spans.size() / 2], static_cast<double>(volume->size()) / 50);
  }
}

TEST(SampleOrder, SamplesKeepTheirValues) {
  const auto volume = volume_of(shuffled_data(tetrahedra_grid({6, 5, 5}, wavy), 5));
  const Attribute& f = *volume->attributes.find("f");
  ASSERT_EQ(volume->size(), 150u);
  for (std::size_t i = 0; i < volume->size(); ++i) EXPECT_EQ(f.number(i), wavy(volume->positions[i]));
  const auto cells = volume_of(shuffled_data(tetrahedra_grid({6, 5, 5}, wavy), 5), Association::cells);
  const Attribute& g = *cells->attributes.find("f");
  for (std::size_t i = 0; i < cells->size(); ++i) EXPECT_NEAR(g.number(i), wavy(cells->positions[i]), 1e-12);
}

}  // namespace
}  // namespace sansmesh::test
