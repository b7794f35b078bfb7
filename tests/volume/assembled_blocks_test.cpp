// Assembly of several blocks: order, levels, overlaps, borders, arrays.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "support/any_threads.h"
#include "volume/volume_checks.h"
#include "volume/volume_sizes.h"

namespace sansmesh::test {
namespace {

TEST(AssembleVolume, OrderOfBlocksHasNoEffect) {
  for (const auto& [name, data] : {std::pair{"overlapping", three_overlapping_blocks(6, linear_function)},
                                   std::pair{"amr", two_level_amr(8, linear_function)},
                                   std::pair{"amr, not blanked", two_level_amr(8, linear_function, false)},
                                   std::pair{"abutting", abutting_blocks(5, 7, linear_function)}})
    for (const Association a : {Association::points, Association::cells}) {
      SCOPED_TRACE(name);
      GridData other = data;
      std::reverse(other.blocks.begin(), other.blocks.end());
      const auto one = volume_of(data, a), two = volume_of(other, a);
      EXPECT_TRUE(same_but_for_blocks(*one, *two));
      ASSERT_EQ(one->block.size(), one->size());
      for (std::size_t i = 0; i < one->size(); ++i)
        ASSERT_EQ(one->block[i] + two->block[i] + 1u, data.blocks.size()) << i;
    }
}

TEST(AssembleVolume, SameOnAnyNumberOfThreads) {
  compare_threads([] { return volume_of(three_overlapping_blocks(8, linear_function)); },
                  [](const auto& a, const auto& b) { EXPECT_TRUE(same_but_for_blocks(*a, *b)); });
}

TEST(AssembleVolume, LeavesOfLevelsCoverAllSpaceOnce) {
  for (const bool blanked : {true, false}) {
    const auto volume = volume_of(two_level_amr(8, linear_function, blanked), Association::cells);
    EXPECT_EQ(volume->size(), 512u - 64 + 512);
    EXPECT_EQ(volume->cells.size(), volume->size());
    EXPECT_EQ(volume->facts.hidden, 64u);
    EXPECT_EQ(volume->facts.grid, "AMR, 2 levels");
    EXPECT_EQ(volume->facts.parts, 1u);
    EXPECT_NEAR(volume_of_cells(*volume), 1, 1e-12);
    EXPECT_NEAR(measure_size(volume_boundary(*volume)).volume, 1, 1e-6);
    // A coarse cell next to the fine block has four neighbours there and five others.
    std::size_t coarse_links = 0;
    for (std::size_t i = 0; i < volume->size(); ++i)
      for (const std::uint32_t j : volume->stars[i]) coarse_links += volume->level[i] == 0 && volume->level[j] == 1;
    EXPECT_EQ(coarse_links, 6 * 64u);
  }
}

// Ghosts or blanked cells: only the coarse cells below exist.
TEST(AssembleVolume, HiddenFineCellsCoverNothing) {
  const auto hide = [](GridData& data, std::size_t planes) {
    data.blocks[1].hidden_cells.assign(512, 0);
    for (std::size_t c = 0; c < 512; ++c) data.blocks[1].hidden_cells[c] = c % 8 < planes;
  };
  GridData data = two_level_amr(8, linear_function, false);
  hide(data, 2);  // as thick as one coarse cell
  const auto even = volume_of(data, Association::cells);
  EXPECT_EQ(even->size(), 512u - 48 + 384);
  EXPECT_NEAR(volume_of_cells(*even), 1, 1e-12);

  hide(data, 1);  // half a coarse cell: these stay, and overlap
  EXPECT_EQ(volume_of(data, Association::cells)->size(), 512u - 48 + 448);
  EXPECT_NEAR(volume_by_chance(*volume_of(data, Association::cells)), 1, 1e-12);

  data.blocks[1].hidden_cells.clear();
  data.blocks[1].hidden_points.assign(729, 0);
  data.blocks[1].hidden_points[0] = 1;  // removes one cell
  const auto points = volume_of(data, Association::cells);
  EXPECT_EQ(points->size(), 512u - 63 + 511);
  EXPECT_NEAR(volume_by_chance(*points), 1, 1e-12);
}

TEST(AssembleVolume, OverlapsKeepTheFinerSamplesAndNoHoles) {
  for (const Association a : {Association::points, Association::cells}) {
    const GridData data = three_overlapping_blocks(8, linear_function);
    const auto volume = volume_of(data, a);
    EXPECT_GT(volume->facts.overlapped, 0u);
    EXPECT_EQ(volume->facts.parts, 1u);
    EXPECT_EQ(volume->facts.grid, "3 overlapping curvilinear blocks");
    const VolumeLocator locator(*volume);
    std::array<std::size_t, 3> held{};
    for (std::size_t b = 0; b < 3; ++b) {
      GridData single;
      single.blocks = {data.blocks[b]};
      const auto x = points_within(*volume_of(single, a), 2000);
      std::vector<CellLocation> locations(x.size());
      locator.locate(x, locations);
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_TRUE(locations[i].inside) << "block " << b << ", point " << i;
        const std::uint32_t sample =
            a == Association::cells ? volume->cell_sample[locations[i].cell] : locations[i].corners[0];
        held[b] += volume->block[sample] == b;
      }
    }
    EXPECT_EQ(held[2], 2000u);  // wherever the finest one exists
    EXPECT_LT(held[0], 2000u);
  }
}

TEST(AssembleVolume, StarsConnectNonConformingBlocks) {
  for (const Association a : {Association::points, Association::cells}) {
    const auto volume = volume_of(abutting_blocks(5, 7, linear_function), a);
    EXPECT_EQ(volume->facts.parts, 1u);
    for (std::size_t i = 0; i < volume->size(); ++i) {
      if (std::abs(volume->positions[i].x - 1) > (a == Association::cells ? 0.13 : 1e-9)) continue;
      bool reaches = false;
      for (const std::uint32_t j : volume->stars[i]) reaches = reaches || volume->block[j] != volume->block[i];
      EXPECT_TRUE(reaches) << i;
    }
  }
}

TEST(AssembleVolume, DuplicateCellsCountOnce) {
  // Each block repeats a layer of the other, as in output of parallel programs; and a duplicate block.
  const auto box = [](double from, double to, std::size_t n) {
    GridBlock block =
        curvilinear_block(lattice_block({n, 4, 4}, {from, 0, 0}, {to, 1, 1}), [](const Vec3& x) { return x; });
    set_function(block, linear_function);
    return block;
  };
  GridData data;
  data.blocks = {box(0, 1.25, 6), box(0.75, 2, 6), box(0.75, 2, 6)};
  for (const Association a : {Association::points, Association::cells}) {
    const auto volume = volume_of(data, a);
    EXPECT_EQ(volume->cells.size(), 8 * 9u);
    EXPECT_EQ(volume->size(), a == Association::cells ? 8 * 9u : 9 * 16u);
    EXPECT_NEAR(volume_of_cells(*volume), 2, 1e-12);
  }
}

TEST(AssembleVolume, ConformingBlocksAreOne) {
  const auto volume = volume_of(abutting_blocks(5, 5, linear_function));
  EXPECT_EQ(volume->size(), 9 * 25u);
  EXPECT_EQ(volume->facts.merged, 25u);
  EXPECT_EQ(volume->facts.overlapped, 0u);
}

template <class T>
void set_rounded(GridBlock& block, const std::string& name, std::size_t components = 1) {
  std::vector<T> values;
  for (std::size_t i = 0; i < components * block_point_count(block); ++i)
    values.push_back(static_cast<T>(40 + 10 * block_point(block, i / components).x));
  block.point_arrays.set(name, std::move(values), components);
}

// Two blocks of 125 points each with 25 common points.
TEST(AssembleVolume, ArraysOfSeveralTypesKeepTheirNumbers) {
  GridData data = abutting_blocks(5, 5, linear_function);
  GridBlock &left = data.blocks[0], &right = data.blocks[1];
  set_rounded<float>(left, "reals"), set_rounded<double>(right, "reals");
  set_rounded<std::int32_t>(left, "mixed"), set_rounded<float>(right, "mixed");
  set_rounded<std::uint8_t>(left, "short"), set_rounded<float>(right, "short");
  set_rounded<std::int32_t>(left, "integers"), set_rounded<std::int64_t>(right, "integers");
  set_rounded<std::int16_t>(left, "alike"), set_rounded<std::int16_t>(right, "alike");
  for (int order = 0; order < 2; ++order) {
    const auto volume = volume_of(data);
    ASSERT_EQ(volume->size(), 225u);
    const std::pair<std::string, NumberType> all[] = {{"reals", NumberType::f64},
                                                      {"mixed", NumberType::f64},
                                                      {"short", NumberType::f32},
                                                      {"integers", NumberType::i64},
                                                      {"alike", NumberType::i16}};
    for (const auto& [name, type] : all) {
      SCOPED_TRACE(name);
      const Attribute& array = *volume->attributes.find(name);
      EXPECT_EQ(array.type(), type);
      for (std::size_t i = 0; i < 225; ++i) ASSERT_NEAR(array.number(i), 40 + 10 * volume->positions[i].x, 0.51) << i;
    }
    std::swap(data.blocks[0], data.blocks[1]);
  }
}

TEST(AssembleVolume, MissingArraysAreUnknown) {
  GridData data = abutting_blocks(5, 5, linear_function);
  set_rounded<std::int32_t>(data.blocks[0], "integers"), set_rounded<float>(data.blocks[0], "reals");
  // The array of the block with more points determines the type.
  data.blocks.push_back(
      curvilinear_block(lattice_block({6, 5, 5}, {2, 0, 0}, {3, 1, 1}), [](const Vec3& x) { return x; }));
  set_function(data.blocks[2], linear_function);
  set_rounded<double>(data.blocks[1], "wide", 3), set_rounded<double>(data.blocks[2], "wide", 2);
  for (int order = 0; order < 2; ++order) {
    const auto volume = volume_of(data);
    const Attribute& wide = *volume->attributes.find("wide");
    EXPECT_EQ(wide.components, 2u);
    for (const std::string name : {"integers", "reals"}) {
      const Attribute& array = *volume->attributes.find(name);
      EXPECT_TRUE(is_real(array.type()));
      for (std::size_t i = 0; i < volume->size(); ++i) {
        // At common points the known value counts.
        const double x = volume->positions[i].x;
        if (x < 1 + 1e-9)
          ASSERT_NEAR(array.number(i), 40 + 10 * x, 1) << i;
        else
          ASSERT_TRUE(std::isnan(array.number(i))) << i;
        ASSERT_EQ(std::isnan(wide.number(2 * i)), x < 2 - 1e-9) << i;
      }
    }
    std::swap(data.blocks[0], data.blocks[2]);
  }
}

}  // namespace
}  // namespace sansmesh::test
