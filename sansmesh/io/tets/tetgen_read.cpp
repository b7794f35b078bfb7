// TetGen's pair of files: points in NAME.node, tetrahedra in NAME.ele.
// Layout: H. Si, "TetGen, a quality tetrahedral mesh generator: user's manual", chapter 5.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "sansmesh/core/option_text.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/number_text.h"
#include "sansmesh/io/tets/mesh_cells.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kMostAttributes = 1000;

/// Attributes by rows, and an optional last column of integers.
class TetgenColumns {
 public:
  TetgenColumns(std::size_t attributes, bool marks) : columns_(attributes), with_marks_(marks) {}

  void read(NumberText& text, const char* of) {
    for (std::vector<double>& column : columns_) column.push_back(text.real(of));
    if (with_marks_) marks_.push_back(static_cast<std::int32_t>(text.whole(of)));
  }
  void give_to(AttributeTable& table, const std::string& one, const std::string& mark) {
    for (std::size_t k = 0; k < columns_.size(); ++k)
      table.set(columns_.size() == 1 ? one : fmt::format("{}_{}", one, k + 1), std::move(columns_[k]));
    if (std::any_of(marks_.begin(), marks_.end(), [](std::int32_t v) { return v != 0; }))
      table.set(mark, std::move(marks_));
  }

 private:
  std::vector<std::vector<double>> columns_;
  std::vector<std::int32_t> marks_;
  bool with_marks_;
};

/// The next number in the header's line; 0 if there is none.
std::int64_t number_of_line(NumberText& text) {
  std::int64_t n = 0;
  if (!text.at_line_end()) n = text.whole("header");
  return n;
}

/// An extra column would be read as the beginning of the next row.
void end_row(NumberText& text, const char* of) {
  if (!text.at_line_end()) text.fail(fmt::format("a row of its {} has more columns than its header says", of));
}

PointNumbers read_tetgen_nodes(const Input& in, GridBlock& block) {
  NumberText text(in, in.bytes);
  const char* const of = "points";
  const std::size_t count = text.count(of, 6);
  if (count == 0) in.fail("holds no points");
  const std::int64_t dimension = number_of_line(text), attributes = number_of_line(text), marks = number_of_line(text);
  if (dimension != 3) in.fail(fmt::format("its points have {} coordinates, not 3", dimension));
  if (attributes < 0 || attributes > static_cast<std::int64_t>(kMostAttributes) || marks < 0 || marks > 1)
    in.fail("its header cannot be understood: points, 3, attributes, 0 or 1 are required");
  TetgenColumns columns(static_cast<std::size_t>(attributes), marks == 1);
  std::vector<std::uint64_t> numbers;
  numbers.reserve(count);
  block.points.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    numbers.push_back(static_cast<std::uint64_t>(text.whole(of)));
    const double x = text.real(of), y = text.real(of), z = text.real(of);
    block.points.push_back({x, y, z});
    columns.read(text, of);
    end_row(text, of);
  }
  if (!text.at_end()) text.fail("more points than its header says");
  columns.give_to(block.point_arrays, "attribute", "marker");
  return {in, std::move(numbers)};
}

void read_tetgen_cells(const Input& in, const PointNumbers& points, GridBlock& block, GridData& data) {
  NumberText text(in, in.bytes);
  const char* const of = "tetrahedra";
  const std::size_t count = text.count(of, 10);
  const std::int64_t nodes = number_of_line(text), attributes = number_of_line(text);
  if (nodes != 4 && nodes != 10) in.fail(fmt::format("its tetrahedra have {} points, not 4 (nor 10)", nodes));
  if (attributes < 0 || attributes > static_cast<std::int64_t>(kMostAttributes))
    in.fail("its header cannot be understood: tetrahedra, 4 or 10, attributes are required");
  TetgenColumns columns(static_cast<std::size_t>(attributes), false);
  MeshCells cells({});
  for (std::size_t k = 0; k < count; ++k) {
    text.whole(of);  // its number
    std::array<std::uint32_t, 4> corners{};
    for (std::int64_t c = 0; c < nodes; ++c) {
      const auto named = static_cast<std::uint64_t>(text.whole(of));
      if (c < 4) corners[static_cast<std::size_t>(c)] = points.at(named);
    }
    if (nodes > 4) cells.simplify();
    cells.add(CellShape::tetrahedron, corners, {});
    columns.read(text, of);
    end_row(text, of);
  }
  if (!text.at_end()) text.fail("more tetrahedra than its header says");
  cells.give_to(block, data);
  columns.give_to(block.cell_arrays, "region", "region");
}

/// The other file of the pair: `file` with another ending.
std::string tetgen_beside(const std::string& file, const char* wanted) {
  std::filesystem::path path(file);
  if (lower_case(path.extension().string()) == ".gz") path.replace_extension();
  path.replace_extension(wanted);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored) && std::filesystem::exists(path.string() + ".gz", ignored))
    return path.string() + ".gz";
  return path.string();
}

}  // namespace

GridData read_tetgen(const Input& nodes, const Input* cells) {
  GridData data;
  data.format = "TetGen";
  GridBlock& block = data.blocks.emplace_back();
  PointNumbers numbers = read_tetgen_nodes(nodes, block);
  if (cells) {
    read_tetgen_cells(*cells, numbers, block, data);
  } else {
    block.kind = GridKind::scattered;
  }
  numbers.give_to(block);
  return data;
}

GridData read_tetgen_pair(const Input& in) {
  const bool given_nodes = ending(in.file) == "node";
  const std::string other = tetgen_beside(in.file, given_nodes ? ".ele" : ".node");
  std::error_code ignored;
  if (!std::filesystem::exists(other, ignored)) {
    if (!given_nodes)
      in.fail(fmt::format("holds tetrahedra without points: {} does not exist",
                          std::filesystem::path(other).filename().string()));
    in.warn(fmt::format("there is no {} with tetrahedra beside it: only points are read",
                        std::filesystem::path(other).filename().string()));
    return read_tetgen(in, nullptr);
  }
  const FileContent content(other);
  const Input second{other, content.bytes(), in.report};
  return given_nodes ? read_tetgen(in, &second) : read_tetgen(second, &in);
}

}  // namespace sansmesh::inline v1::io
