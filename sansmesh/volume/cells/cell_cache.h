// Cache of frequently found cells that answers point location without a search.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/cell_inverse.h"

namespace sansmesh::inline v1 {

/// Consecutive points (stages of a particle, samples of a ray) are in one cell or in neighbours. A walk through faces
/// from a cached cell reaches the next one without a search. The result equals that of a search where no other cell can
/// contain the point: the cache keeps a separating plane for each cell near a cached one. So answers are bit-identical
/// to those of the search, independent of the contents of the cache.
///
/// A cell enters the cache after several hits, up to a number of cells. Safe from any thread.
class CellCache {
 public:
  /// All arguments must outlive it. `folded` has one flag per cell, or is empty.
  CellCache(const SampledVolume& volume, const BoxTree& boxes, std::span<const std::uint8_t> folded);
  ~CellCache();
  CellCache(const CellCache&) = delete;
  CellCache& operator=(const CellCache&) = delete;

  /// The only cell that contains x (finite) with a margin of its parameters u, found from the cell `from` (may be
  /// kNoCell); kNoCell if that is not certain.
  std::uint32_t find(const Vec3& x, std::uint32_t from, double margin, Vec3& u) const;

  /// Counts a hit of a cell found by a search.
  void count(std::uint32_t cell) const;

 private:
  /// Another cell, entirely on the side dot(normal, x − first corner of the cached cell) >= from.
  struct Rival {
    Vec3 normal;
    double from;
  };
  struct Cell {
    CellInverse inverse;
    Vec3 corner;                            // first corner
    std::array<std::uint32_t, 6> beyond{};  // across u.x = 0, 1, u.y = 0, 1, u.z = 0, 1; four for a tetrahedron
    std::vector<Rival> rivals;              // nearby cells that no plane separates from the whole cell
  };

  static constexpr std::uint32_t kOften = 8;  // hits after which the cost of caching is recovered
  static constexpr std::uint32_t kNever = ~std::uint32_t{0};

  std::unique_ptr<Cell> make_entry(std::uint32_t cell) const;
  const Cell* known(std::uint32_t cell) const {
    const std::uint32_t state = state_[cell].load(std::memory_order_acquire);
    return state < kOften || state == kNever ? nullptr : cells_[state - kOften].get();
  }

  const SampledVolume& volume_;
  const BoxTree& boxes_;
  std::span<const std::uint8_t> folded_;
  std::size_t most_;
  mutable std::vector<std::atomic<std::uint32_t>>
      state_;  // number of hits; from kOften on the index in cells_ plus kOften
  mutable std::vector<std::unique_ptr<Cell>> cells_;
  mutable std::atomic<std::uint32_t> used_{0};
};

}  // namespace sansmesh::inline v1
