#include "sansmesh/io/tets/mesh_cells.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/core/number_words.h"

namespace sansmesh::inline v1::io {

PointNumbers::PointNumbers(const Input& in, std::vector<std::uint64_t> numbers)
    : in_(in), numbers_(std::move(numbers)) {
  if (numbers_.size() >= GridBlock::kNone) in_.fail("holds more points than are supported (2^32)");
  for (std::size_t i = 1; i < numbers_.size() && in_row_; ++i) in_row_ = numbers_[i] == numbers_[0] + i;
  if (in_row_) return;
  index_.reserve(numbers_.size());
  for (std::size_t i = 0; i < numbers_.size(); ++i) index_.emplace_back(numbers_[i], static_cast<std::uint32_t>(i));
  std::sort(index_.begin(), index_.end());
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (const auto it = std::adjacent_find(index_.begin(), index_.end(), same); it != index_.end())
    in_.fail(fmt::format("gives two points the number {}", it->first));
}

std::uint32_t PointNumbers::at(std::uint64_t number) const {
  if (in_row_) {
    if (!numbers_.empty() && number >= numbers_[0] && number - numbers_[0] < numbers_.size())
      return static_cast<std::uint32_t>(number - numbers_[0]);
  } else if (const auto it = std::lower_bound(index_.begin(), index_.end(), std::pair(number, std::uint32_t{0}));
             it != index_.end() && it->first == number) {
    return it->second;
  }
  in_.fail(fmt::format("a cell refers to the missing point {}", static_cast<std::int64_t>(number)));
}

void PointNumbers::give_to(GridBlock& block) {
  if (in_row_ && (numbers_.empty() || numbers_[0] == 0)) return;
  block.point_numbers = std::move(numbers_);
}

namespace {

void append_tags(std::vector<std::vector<std::int32_t>>& columns, std::span<const std::int32_t> tags) {
  for (std::size_t k = 0; k < columns.size(); ++k) columns[k].push_back(k < tags.size() ? tags[k] : 0);
}

}  // namespace

void MeshCells::add(CellShape shape, std::span<const std::uint32_t> corners, std::span<const std::int32_t> tags) {
  cells_.add(shape, corners);
  append_tags(volume_, tags);
}

void MeshCells::add_flat(std::span<const std::uint32_t> corners, std::span<const std::int32_t> tags) {
  rings_.push_back({corners[0], corners[1], corners[2], corners.size() > 3 ? corners[3] : GridBlock::kNone});
  append_tags(flat_, tags);
}

void MeshCells::give_to(GridBlock& block, GridData& data) {
  const bool flat = cells_.empty();
  if (!flat) {
    const auto triangles = static_cast<std::size_t>(
        std::count_if(rings_.begin(), rings_.end(), [](const auto& r) { return r[3] == GridBlock::kNone; }));
    if (triangles > 0) leave_out("triangle", triangles);
    if (triangles < rings_.size()) leave_out("quadrilateral", rings_.size() - triangles);
    rings_.clear();
  }
  if (simplified_ > 0)
    data.notes.push_back(fmt::format("of {} of higher order only the corners are used", counted(simplified_, "cell")));
  for (const auto& [kind, n] : left_out_)
    data.notes.push_back(fmt::format("{} {} left out", counted(n, kind), n == 1 ? "was" : "were"));
  block.cells = std::move(cells_);
  block.flat_cells = std::move(rings_);
  for (std::size_t k = 0; k < tags_.size(); ++k) {
    std::vector<std::int32_t>& column = flat ? flat_[k] : volume_[k];
    if (std::any_of(column.begin(), column.end(), [](std::int32_t v) { return v != 0; }))
      block.cell_arrays.set(tags_[k], std::move(column));
  }
}

}  // namespace sansmesh::inline v1::io
