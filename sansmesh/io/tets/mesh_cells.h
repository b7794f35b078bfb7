// What readers of unstructured meshes share: points by the numbers that files give them, cells with their tags, and
// what is left out of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Finds points by their numbers.
class PointNumbers {
 public:
  /// Throws FileError where two points have the same number, or there are more points than can be.
  PointNumbers(const Input& in, std::vector<std::uint64_t> numbers);
  /// Place in the list. Throws FileError where `cell` names a point that is not there.
  std::uint32_t at(std::uint64_t number) const;
  /// Puts them into a block, unless they count from 0.
  void give_to(GridBlock& block);

 private:
  const Input& in_;
  std::vector<std::uint64_t> numbers_;
  bool in_row_ = true;                                          ///< each is one more than the last
  std::vector<std::pair<std::uint64_t, std::uint32_t>> index_;  ///< sorted; only where they are not
};

/// Takes the cells of a file as they come.
class MeshCells {
 public:
  /// `tags`: names of whole numbers that each cell has; those that are 0 everywhere become no array.
  explicit MeshCells(std::vector<std::string> tags) : tags_(std::move(tags)), volume_(tags_.size()), flat_(volume_) {}

  void add(CellShape shape, std::span<const std::uint32_t> corners, std::span<const std::int32_t> tags);
  /// A triangle or a quadrilateral.
  void add_flat(std::span<const std::uint32_t> corners, std::span<const std::int32_t> tags);
  /// Cells of a kind ("edge") that nobody asks for.
  void leave_out(const std::string& kind, std::size_t count = 1) { left_out_[kind] += count; }
  /// Cells of which only the corners are used.
  void simplify(std::size_t count = 1) { simplified_ += count; }
  /// Whether any of them fill space.
  bool solid() const { return !cells_.empty(); }
  bool empty() const { return cells_.empty() && rings_.empty(); }

  /// Moves all into the block, flat cells only where there are no others, and adds notes on what was left out.
  void give_to(GridBlock& block, GridData& data);

 private:
  std::vector<std::string> tags_;
  std::vector<std::vector<std::int32_t>> volume_, flat_;
  CellList cells_;
  std::vector<std::array<std::uint32_t, 4>> rings_;
  std::map<std::string, std::size_t> left_out_;
  std::size_t simplified_ = 0;
};

}  // namespace sansmesh::inline v1::io
