// Cells that many points were found in: where the next points are looked for first.
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

/// Points that come one after the other (stages of a particle, samples of a ray) lie in one cell or in neighbours. From
/// a cell that is familiar the next one is reached through faces, without a search, and what a search would find is
/// known wherever no other cell holds the point too: of every cell near a familiar one there is a plane that it lies
/// beyond. So the answers are those of the search, bit by bit, whatever became familiar and when.
///
/// A cell becomes familiar when it was found some times, up to a number of cells. From any thread.
class FamiliarCells {
 public:
  /// All must outlive it. `folded` has a flag for each cell, or none.
  FamiliarCells(const SampledVolume& volume, const BoxTree& boxes, std::span<const std::uint8_t> folded);
  ~FamiliarCells();
  FamiliarCells(const FamiliarCells&) = delete;
  FamiliarCells& operator=(const FamiliarCells&) = delete;

  /// The only cell that holds x (finite) by more than `margin` of its parameters u, starting from the cell `from`;
  /// kNoCell where that is not certain. `from` may be kNoCell.
  std::uint32_t find(const Vec3& x, std::uint32_t from, double margin, Vec3& u) const;

  /// Of a cell that a search found.
  void count(std::uint32_t cell) const;

 private:
  /// Another cell, all of which lies where dot(normal, x − first corner of the familiar one) >= from.
  struct Rival {
    Vec3 normal;
    double from;
  };
  struct Cell {
    CellInverse inverse;
    Vec3 corner;                            // its first
    std::array<std::uint32_t, 6> beyond{};  // across u.x = 0, 1, u.y = 0, 1, u.z = 0, 1; of a tetrahedron four
    std::vector<Rival> rivals;              // that no plane parts from the whole of it
  };

  static constexpr std::uint32_t kOften = 8;  // what it takes to know a cell is gained again by so many points
  static constexpr std::uint32_t kNever = ~std::uint32_t{0};

  std::unique_ptr<Cell> familiar(std::uint32_t cell) const;
  const Cell* known(std::uint32_t cell) const {
    const std::uint32_t state = state_[cell].load(std::memory_order_acquire);
    return state < kOften || state == kNever ? nullptr : cells_[state - kOften].get();
  }

  const SampledVolume& volume_;
  const BoxTree& boxes_;
  std::span<const std::uint8_t> folded_;
  std::size_t most_;
  mutable std::vector<std::atomic<std::uint32_t>> state_;  // how often; from kOften on where in cells_
  mutable std::vector<std::unique_ptr<Cell>> cells_;
  mutable std::atomic<std::uint32_t> used_{0};
};

}  // namespace sansmesh::inline v1
