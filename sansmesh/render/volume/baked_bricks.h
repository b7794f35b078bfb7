// Adaptive tree of bricks that samples a field: the data of a baked volume.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/volume/bake_options.h"
#include "sansmesh/render/volume/baked_kernels.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1::detail {

constexpr int kMostBrickLevels = 12;
constexpr std::size_t kBakeCheckPoints = 20000;
constexpr std::size_t kNodesOfBrick = kBrickSize / 4;

constexpr std::size_t node_at(int i, int j, int k) {
  return static_cast<std::size_t>(i + kBrickNodes * (j + kBrickNodes * k));
}

struct BakedBrick {
  enum class Inside : std::uint8_t { none, some, all };

  std::int32_t branch = 0;  ///< its entry in `branches`
  int level = 0;
  std::array<int, 3> at{};    ///< in bricks of its level
  float least = 0, most = 0;  ///< range of its nodes
  double error = 0;           ///< at the centres of its cells in the volume
  double spacing = 0;         ///< spacing of the field
  double parent_error = 0;
  double held = std::numeric_limits<double>::infinity();  ///< least spacing at the samples in it, for `none`
  int stubborn = 0;                                       ///< consecutive generations without improvement by splitting
  Inside inside = Inside::none;
  std::vector<std::uint8_t> mask;  ///< mask of nodes, for `some`
};

/// Bricks and their nodes. `branches`, `bricks` and `nodes` describe a BrickTree.
struct BakedBricks {
  const VolumeField* field;
  BakeOptions options;
  bool whole = false;  ///< the volume fills the whole box
  BakeReport report;
  Box3 box;
  std::array<int, 3> counts{1, 1, 1};
  Vec3 root;  ///< edges of a root
  double value_scale = 1,
         slope_scale = 1;  ///< powers of two: nodes store the value times the first, its slopes times both
  std::vector<std::int32_t> branches;
  std::vector<BakedBrick> bricks;
  std::vector<float> nodes;
  std::vector<std::size_t> pending;  ///< samples whose bricks are not entirely inside
  std::vector<Vec3> known;           ///< some of the samples, with the field's values
  std::vector<double> known_values;
  /// Nodes with values from a coarser brick (brick_cracks.h), and their original values.
  std::vector<std::pair<std::size_t, std::array<float, 4>>> hanging;

  /// Throws as BakedVolume does.
  BakedBricks(const VolumeField& f, const BakeOptions& o);

  BrickTree tree() const {
    return {branches.data(),
            nodes.data(),
            box.lower,
            {1 / root.x, 1 / root.y, 1 / root.z},
            {counts[0], counts[1], counts[2]}};
  }
  Vec3 edges(int level) const { return root * std::ldexp(1.0, -level); }
  double longest_cell(const BakedBrick& b) const {
    const Vec3 e = edges(b.level);
    return std::max({e.x, e.y, e.z}) / kBrickCells;
  }
  /// Values and slopes as floats, scaled to order 1.
  float kept_value(double v) const { return kept(v * value_scale); }
  float kept_slope(double v) const { return kept(v * value_scale * slope_scale); }
  static float kept(double v) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(v, -kMost, kMost));
  }
  double range() const { return report.most > report.least ? report.most - report.least : 1; }

  /// Creates and samples the roots of the tree.
  void add_roots(Progress& progress);
  /// Splits all bricks with too large errors once, within the memory limit. False if there was none.
  bool split(Progress& progress);
  /// Updates the ranges of the bricks, and the report except for the errors at check points.
  void summarize();

 private:
  void note_sample_spacings(Progress& progress);
  void fill(std::vector<BakedBrick>& made, std::span<const std::size_t> slots, Progress& progress);
  double urgency(const BakedBrick& b) const;
  void restore_hanging();
};

}  // namespace sansmesh::inline v1::detail
