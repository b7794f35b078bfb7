// Common parts of readers of unstructured meshes: points by number, cells with tags, and notes on skipped elements.
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

/// Maps the point numbers of a file to indices.
class PointNumbers {
 public:
  /// Throws FileError if two points have the same number, or there are too many points.
  PointNumbers(const Input& in, std::vector<std::uint64_t> numbers);
  /// Index of a point. Throws FileError if it does not exist.
  std::uint32_t at(std::uint64_t number) const;
  /// Stores the numbers in a block, unless they count from 0.
  void give_to(GridBlock& block);

 private:
  const Input& in_;
  std::vector<std::uint64_t> numbers_;
  bool in_row_ = true;                                          ///< consecutive
  std::vector<std::pair<std::uint64_t, std::uint32_t>> index_;  ///< sorted; only for numbers that are not consecutive
};

/// Collects the cells of a file.
class MeshCells {
 public:
  /// `tags`: names of integers that each cell has; tags that are 0 everywhere become no array.
  explicit MeshCells(std::vector<std::string> tags) : tags_(std::move(tags)), volume_(tags_.size()), flat_(volume_) {}

  void add(CellShape shape, std::span<const std::uint32_t> corners, std::span<const std::int32_t> tags);
  /// A triangle or a quadrilateral.
  void add_flat(std::span<const std::uint32_t> corners, std::span<const std::int32_t> tags);
  /// Counts skipped cells of a kind ("edge").
  void leave_out(const std::string& kind, std::size_t count = 1) { left_out_[kind] += count; }
  /// Counts cells of which only the corners are used.
  void simplify(std::size_t count = 1) { simplified_ += count; }
  /// Whether any of the cells fill space.
  bool solid() const { return !cells_.empty(); }
  bool empty() const { return cells_.empty() && rings_.empty(); }

  /// Moves all cells into the block, flat cells only if there are no others, and adds notes on skipped ones.
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
