#include "sansmesh/io/points/point_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/points/table_columns.h"

namespace sansmesh::inline v1 {
namespace {

bool is_table(const std::string& file) {
  constexpr std::string_view endings[] = {"csv", "txt", "xyz", "asc", "dat", "tsv"};
  return std::find(std::begin(endings), std::end(endings), io::ending(file)) != std::end(endings);
}

/// A number, NaN for empty fields; empty for other words.
std::optional<double> number_of(std::string_view word) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (word.empty()) return value;
  io::TextScanner text(word);
  if (!text.number(value) || !text.at_end()) return std::nullopt;
  return value;
}

struct Row {
  std::vector<double> numbers;
  bool all = true;  ///< every word is a number
};

Row row_of(std::string_view line, char separator) {
  Row row;
  io::TableRow fields(line, separator);
  for (auto f = fields.field(); f; f = fields.field()) {
    const std::optional<double> v = number_of(*f);
    row.all = row.all && v.has_value();
    row.numbers.push_back(v.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return row;
}

}  // namespace

std::vector<Vec3> parse_point_table(std::string_view bytes, const std::string& file) {
  std::vector<Vec3> points;
  std::array<std::size_t, 3> column{0, 1, 2};
  io::TextScanner text(bytes);
  bool named = false;
  for (std::size_t number = 1; !text.at_end(); ++number) {
    const std::string_view line = text.line();
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || std::string_view("#%!").find(line[begin]) != std::string_view::npos)
      continue;
    const Row row = row_of(line, io::guess_separator(line));
    if (!row.all && points.empty() && !named) {
      const auto meaning = io::meaning_of_names(line);
      if (!meaning)
        throw FileError(file, fmt::format("line {}: neither numbers nor the names of columns x, y and z", number));
      for (std::size_t k = 0; k < 3; ++k) column[k] = static_cast<std::size_t>(meaning->column[k]);
      named = true;
      continue;
    }
    if (row.numbers.size() <= *std::max_element(column.begin(), column.end()))
      throw FileError(file, fmt::format("line {}: {}, but a point needs at least {}", grouped(number),
                                        counted(row.numbers.size(), "column"),
                                        1 + *std::max_element(column.begin(), column.end())));
    if (!row.all) throw FileError(file, fmt::format("line {}: not a row of numbers", grouped(number)));
    points.push_back({row.numbers[column[0]], row.numbers[column[1]], row.numbers[column[2]]});
  }
  if (points.empty()) throw FileError(file, "holds no points (no rows of numbers)");
  return points;
}

std::vector<Vec3> read_point_table(const std::string& file) {
  if (is_table(file)) return parse_point_table(io::FileContent(file).bytes(), file);
  const PointSet set = read_points(file);
  std::vector<Vec3> points;
  points.reserve(set.size());
  for (const Vec3f& p : set.positions) points.push_back(set.origin + Vec3(p));
  return points;
}

}  // namespace sansmesh::inline v1
