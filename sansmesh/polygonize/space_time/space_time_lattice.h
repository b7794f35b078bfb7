// The J₁ᴬ triangulation of space and time around the zero set of a field that changes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "sansmesh/field/time_field.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangulation/block_tree_n.h"

namespace sansmesh::inline v1 {

/// Lattice vertex in quarters of the smallest blocks, with t in the highest bits: the order of keys is the order in
/// which all simplices list their vertices.
using LatticeKey = std::uint64_t;
inline LatticeKey key_of(const std::array<std::int64_t, 4>& v) {
  LatticeKey key = 0;
  for (std::size_t k = 4; k-- > 0;) key = key << 16 | static_cast<LatticeKey>(v[k]);
  return key;
}
inline std::int64_t coordinate(LatticeKey key, std::size_t k) {
  return static_cast<std::int64_t>(key >> (16 * k) & 0xffffu);
}

/// Simplices of a block; vertices are positions on its 5⁴ grid of quarter edges (x + 5y + 25z + 125t).
struct SpaceTimePattern {
  struct Simplex {
    std::array<std::uint16_t, 5> corner;  ///< indices into `slots`, increasing
    bool turned;                          ///< negatively oriented
  };
  std::vector<std::uint16_t> slots;  ///< positions that are vertices, increasing
  std::vector<Simplex> simplices;
};

/// Patterns by the set of the 64 neighbours sharing more than a corner that are divided.
class SpaceTimePatterns {
 public:
  /// References stay valid.
  const SpaceTimePattern& of(const BlockTreeN<4>& tree, std::uint32_t block);

 private:
  std::unordered_map<std::uint64_t, SpaceTimePattern> patterns_;
};

/// Some blocks with their lattice vertices and field values.
struct SpaceTimeBlocks {
  std::vector<std::uint32_t> blocks;
  SpaceTimePatterns table;
  std::vector<const SpaceTimePattern*> patterns;  ///< per block, in `table`
  std::vector<LatticeKey> keys;                   ///< lattice vertices, increasing
  std::vector<double> values;                     ///< per lattice vertex

  std::uint32_t find(LatticeKey key) const {
    return static_cast<std::uint32_t>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
  }
};

/// A tree of blocks in space and time, and the field on its lattice.
class SpaceTimeLattice {
 public:
  /// As SpaceTimeSurface, with its options `cell`, `time_cell` and `mesh_error`.
  SpaceTimeLattice(const TimeField& of, double cell, double time_cell, double flat, Progress& progress);

  std::int64_t quarters() const { return std::int64_t{4} << depth; }  ///< quarters across the cube
  double quarter() const { return edge_ / static_cast<double>(quarters()); }
  double quarter_time() const { return lasting_ / static_cast<double>(quarters()); }

  Vec3 position(LatticeKey key) const;

  double off_zero(double v) const;

  /// The blocks of these that the surface may cross, with their lattice vertices.
  SpaceTimeBlocks crossed(std::vector<std::uint32_t> blocks) const;

  LatticeKey key_at(std::uint32_t block, std::uint16_t slot) const;

  const TimeField& field;
  TimeRange times;
  BlockTreeN<4> tree;
  int depth = 0;  ///< level of the smallest blocks

 private:
  /// Distance to the box of the field, negative inside.
  double beyond(const Vec3& x) const;

  /// Values of the field within its box; constant after its last moment.
  void evaluate(std::span<const Vec3> x, std::span<double> t, std::span<double> values) const;

  void divide(Progress& progress);
  /// Whether the surface may cross the blocks of one level during the times of the field.
  std::vector<std::uint8_t> may_hold(std::span<const std::uint32_t> level) const;
  /// Selects the blocks, of any levels, that the surface may cross, in their order.
  std::vector<std::uint32_t> holding(std::vector<std::uint32_t> blocks) const;
  /// Whether the field is linear to within mesh_error in each block, tested at the midpoints between opposite corners
  /// and between the centres of opposite faces.
  std::vector<std::uint8_t> are_flat(std::span<const std::uint32_t> blocks) const;

  Box3 box_;
  Vec3 lower_;          ///< lower corner of the cube
  double edge_ = 0;     ///< edge of the cube (length)
  double lasting_ = 0;  ///< duration of the cube (time)
  double mesh_error_;
};

}  // namespace sansmesh::inline v1
