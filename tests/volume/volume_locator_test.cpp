#include "sansmesh/volume/cells/volume_locator.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

Vec3 corner_position(const SampledVolume& volume, std::uint32_t c) {
  return volume.lattice ? volume.lattice->position(c) : volume.corner(c);
}

TEST(VolumeLocator, FindsPointsByTheirWeights) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    const VolumeLocator locator(*volume);
    const auto x = points_within(*volume, 2000);
    std::vector<CellLocation> locations(x.size());
    locator.locate(x, locations);
    const double size = volume->bounds().diagonal();
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(locations[i].inside) << i;
      Vec3 there;
      double sum = 0;
      for (std::size_t c = 0; c < locations[i].corner_count; ++c) {
        there += corner_position(*volume, locations[i].corners[c]) * locations[i].weights[c];
        sum += locations[i].weights[c];
        if (!volume->lattice) ASSERT_GE(locations[i].weights[c], -1e-9) << i;
      }
      ASSERT_NEAR(sum, 1, 1e-12) << i;
      ASSERT_LT(norm(there - x[i]), 1e-9 * size) << i;
    }
  }
}

TEST(VolumeLocator, SlopesOfShapeFunctionsAreTheirDifferences) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    const VolumeLocator locator(*volume);
    for (const Vec3& x : points_within(*volume, 50)) {
      constexpr double kStep = 1e-6;
      CellLocation at;
      locator.locate({&x, 1}, {&at, 1});
      std::array<Vec3, 8> slopes;
      shape_gradients(*volume, at, x, slopes);
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 ahead = x, behind = x;
        ahead[k] += kStep, behind[k] -= kStep;
        CellLocation a, b;
        locator.locate({&ahead, 1}, {&a, 1});
        locator.locate({&behind, 1}, {&b, 1});
        if (a.cell != at.cell || b.cell != at.cell || !a.inside || !b.inside) continue;
        for (std::size_t c = 0; c < at.corner_count; ++c)
          ASSERT_NEAR((a.weights[c] - b.weights[c]) / (2 * kStep), slopes[c][k], 1e-3 * (1 + norm(slopes[c])));
      }
    }
  }
}

TEST(VolumeLocator, IsAccurateInThinLayersFarFromTheOrigin) {
  // Steps of 1e-5 next to steps of 1, bent, 1000 away from the origin.
  GridBlock layers = lattice_block({9, 9, 40}, {0, 0, 0}, {8, 8, 1});
  layers.axes[2] = axis_steps(40, 0, 1, 1.3);
  const GridBlock bent = curvilinear_block(layers, [](const Vec3& x) {
    return Vec3{x.x + 1000, x.y - 1000, x.z + 0.3 * std::sin(x.x) * std::cos(0.5 * x.y)};
  });
  const auto volume = volume_of(one_block(bent, linear_function));
  EXPECT_GT(volume->facts.aspect, 1e4);
  const VolumeLocator locator(*volume);
  const auto x = points_within(*volume, 5000);
  std::vector<CellLocation> locations(x.size());
  locator.locate(x, locations);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_TRUE(locations[i].inside) << i;
    Vec3 there;
    for (std::size_t c = 0; c < 8; ++c) there += volume->corner(locations[i].corners[c]) * locations[i].weights[c];
    ASSERT_LT(norm(there - x[i]), 1e-10) << i;
  }
}

/// Also on faces, edges and corners, and outside; for all starting cells and previous queries.
TEST(VolumeLocator, AnswersDependOnThePointAlone) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    if (volume->lattice) continue;
    std::vector<Vec3> x = points_within(*volume, 60);
    for (std::size_t i = 0; i < 60; ++i) x.push_back(x[i] * 0.3 + x[(i + 1) % 60] * 0.7);
    std::mt19937 random(5);
    for (int i = 0; i < 30; ++i) {
      const auto corners = volume->cells[random() % volume->cells.size()];
      const Vec3 a = volume->corner(corners[0]), b = volume->corner(corners[1]), c = volume->corner(corners[2]);
      x.insert(x.end(), {a, (a + b) * 0.5, (a + b + c) / 3});
    }
    std::vector<CellLocation> alone(x.size()), locations(x.size());
    for (std::size_t i = 0; i < x.size(); i += 5) {  // too few points for the cache of cells
      const std::size_t n = std::min<std::size_t>(5, x.size() - i);
      VolumeLocator(*volume).locate(std::span(x).subspan(i, n), std::span(alone).subspan(i, n));
    }
    const VolumeLocator locator(*volume);
    for (int pass = 0; pass < 30; ++pass) {
      std::vector<std::uint32_t> starts(x.size());
      for (std::size_t i = 0; i < x.size(); ++i)
        starts[i] = pass % 3 == 0   ? static_cast<std::uint32_t>(random())
                    : pass % 3 == 1 ? static_cast<std::uint32_t>(random() % volume->cells.size())
                                    : alone[i].cell;
      if (pass % 5 == 4)
        locator.locate(x, locations);
      else
        locator.locate(x, locations, starts);
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_EQ(locations[i].cell, alone[i].cell) << i;
        ASSERT_EQ(locations[i].inside, alone[i].inside) << i;
        ASSERT_EQ(locations[i].weights, alone[i].weights) << i;
      }
    }
  }
}

TEST(VolumeLocator, OutsideFindsTheNearestPointOfTheVolume) {
  // Points in all directions around the o-grid's cylinder (radius 1, z in 0..2), whose facets are known.
  const auto volume = volume_of(o_grid({33, 5, 6}, linear_function));
  const VolumeLocator locator(*volume);
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.1 + 0.37 * i, z = 2.0 * ((i * 7) % 20) / 19;
    const Vec3 x{1.5 * std::cos(angle), 1.5 * std::sin(angle), z};
    CellLocation location;
    locator.locate({&x, 1}, {&location, 1});
    ASSERT_FALSE(location.inside);
    Vec3 there;
    for (std::size_t c = 0; c < location.corner_count; ++c)
      there += volume->corner(location.corners[c]) * location.weights[c];
    EXPECT_NEAR(norm(there - x), 0.5, 0.01);
  }
}

}  // namespace
}  // namespace sansmesh::test
