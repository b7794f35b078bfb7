// Points as rows of text: XYZ, TXT, CSV, ASC, PTS, PWN. The meaning of columns follows from a header, if there is one,
// else from their number and values.
#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/points/table_columns.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::inline v1::io {
namespace {

/// Leaves `value` unchanged unless the whole word is a number: 2020-01-02 is not 2020.
bool parse(std::string_view word, double& value) {
  TextScanner s(word);
  double found = 0;
  if (!s.number(found) || !s.at_end()) return false;
  value = found;
  return true;
}

bool is_comment(std::string_view line) {
  TextScanner s(line);
  s.skip_blanks();
  const std::string_view r = s.rest();
  return r.starts_with('#') || r.starts_with("//") || r.starts_with('%') || r.starts_with('!');
}

bool is_blank_line(std::string_view line) {
  TextScanner s(line);
  s.skip_blanks();
  return s.at_end();
}

constexpr std::size_t most_columns = 256;

/// Numbers of the fields of a line, NaN for others; `bad` counts fields that are neither a number nor empty.
std::vector<double> numbers_of(std::string_view line, char separator, std::size_t& bad) {
  std::vector<double> values;
  TableRow row(line, separator);
  for (auto f = row.field(); f && values.size() < most_columns; f = row.field()) {
    double v = std::numeric_limits<double>::quiet_NaN();
    if (!f->empty() && !parse(*f, v)) ++bad;
    values.push_back(v);
  }
  return values;
}

/// Content before the rows: comments, a line of names, a count of points.
struct Head {
  std::optional<ColumnMeaning> names;
  std::optional<std::uint64_t> announced;
  char separator = ' ';
  std::uint64_t lines = 0;
  std::string_view body;  ///< from the first row on
  std::size_t columns = 0;
};

/// Reads up to the first row. If commas are decimal points, `with_points` receives the text with points, and the body
/// refers to it.
Head read_head(const Input& in, std::string_view bytes, std::string& with_points) {
  Head head;
  TextScanner text(bytes);
  while (!text.at_end()) {
    head.body = text.rest();
    const std::string_view line = text.line();
    if (is_blank_line(line)) {
      ++head.lines;
      continue;
    }
    if (is_comment(line)) {
      if (auto m = meaning_of_names(line)) head.names = m;
      ++head.lines;
      continue;
    }
    head.separator = guess_separator(line);
    std::size_t bad = 0;
    const std::vector<double> values = numbers_of(line, head.separator, bad);
    // "1,5;2,5;3,5" and the same with tabs: a comma inside the numbers.
    const bool comma_decimals = (head.separator == ';' || line.find('\t') != std::string_view::npos) &&
                                line.find(',') != std::string_view::npos && line.find('.') == std::string_view::npos;
    if (comma_decimals && with_points.empty() && bad > 0) {
      with_points = std::string(head.body);
      std::replace(with_points.begin(), with_points.end(), ',', '.');
      text = TextScanner(with_points);
      continue;
    }
    if (bad > 0 && bad >= std::min<std::size_t>(3, values.size())) {
      if (head.names || head.lines > 50) in.fail(fmt::format("line {}: not a row of numbers", head.lines + 1));
      head.names = meaning_of_names(line);
      if (!head.names && head.lines > 20) in.fail("holds no rows of numbers");
      ++head.lines;
      continue;
    }
    if (values.size() == 1 && !head.announced && values[0] >= 0 && values[0] == std::floor(values[0]) &&
        values[0] < 1e18) {
      head.announced = static_cast<std::uint64_t>(values[0]);
      ++head.lines;
      continue;
    }
    if (values.size() < 3) {
      in.fail(fmt::format("line {}: {}, but a point needs at least 3", grouped(head.lines + 1),
                          counted(values.size(), "column")));
    }
    head.columns = values.size();
    return head;
  }
  in.fail("holds no points (no rows of numbers)");
}

/// The first thousand complete rows.
std::vector<std::vector<double>> first_rows(const Head& head) {
  std::vector<std::vector<double>> rows;
  TextScanner text(head.body);
  for (std::size_t k = 0; k <= 1000 && !text.at_end(); ++k) {
    std::size_t bad = 0;
    std::vector<double> values = numbers_of(text.line(), head.separator, bad);
    if (values.size() < head.columns) continue;
    values.resize(head.columns);
    rows.push_back(std::move(values));
  }
  return rows;
}

/// The used columns from left to right, and the position of each in the table.
struct Layout {
  int slot[most_columns];
  bool required[most_columns] = {};  ///< coordinates: a row without them is an error
  NumberType type[most_columns];     ///< cell types: doubles, unless the numbers need 64 bits
  int width = 0;
  int last_column = 0;  ///< a row that ends before it is an error
  int last_used = 0;    ///< including optional columns
};

Layout make_layout(const Input& in, const ColumnMeaning& meaning, std::size_t columns) {
  Layout layout;
  std::fill(layout.slot, layout.slot + most_columns, no_column);
  std::fill(layout.type, layout.type + most_columns, NumberType::f64);
  for (int k = 0; k < ColumnMeaning::kinds; ++k) {
    const int c = meaning.column[k];
    if (c < 0) continue;
    if (c >= static_cast<int>(columns))
      in.fail(fmt::format("its header names more columns than the {} of its rows", columns));
    if (layout.slot[c] < 0) layout.slot[c] = layout.width++;
    layout.required[c] = k < 3;
    layout.last_column = std::max(layout.last_column, c);
  }
  layout.last_used = layout.last_column;
  for (const ColumnMeaning::Other& other : meaning.others) {
    if (other.column >= static_cast<int>(columns) || other.name.empty()) continue;
    layout.slot[other.column] = layout.width++;
    layout.last_used = std::max(layout.last_used, other.column);
  }
  return layout;
}

/// The rows of some of the lines.
struct Block {
  std::vector<double> values;
  std::vector<std::uint8_t>
      real;                     ///< per column of the table: whether a number is missing or not written as an integer
  std::uint64_t announced = 0;  ///< sum of the counts between the rows (PTS)
  std::string error;
};

Block read_block(std::string_view lines, std::size_t number, const Head& head, const Layout& layout, bool last) {
  Block block;
  const std::size_t width = static_cast<std::size_t>(layout.width);
  block.real.assign(width, 0);
  TextScanner text(lines);
  for (; !text.at_end(); ++number) {
    const std::string_view line = text.line();
    const std::size_t base = block.values.size();
    block.values.resize(base + width, std::numeric_limits<double>::quiet_NaN());
    TableRow row(line, head.separator);
    int column = 0;
    double first = 0;
    for (; column <= layout.last_used; ++column) {
      const auto f = row.field();
      if (!f) break;
      if (column > 0 && layout.slot[column] < 0) continue;
      double v = std::numeric_limits<double>::quiet_NaN();
      if (!f->empty() && !parse(*f, v) && (layout.required[column] || column == 0)) {
        if (is_comment(line)) {
          column = 0;
          break;
        }
        if (layout.required[column]) {
          block.error = fmt::format("line {}: '{}' is not a number", grouped(number), f->substr(0, 40));
          return block;
        }
      }
      if (column == 0) first = v;
      if (layout.slot[column] < 0) continue;
      const std::size_t slot = static_cast<std::size_t>(layout.slot[column]);
      double& cell = block.values[base + slot];
      cell = v;
      if (layout.type[column] != NumberType::f64) {
        TextScanner whole(*f);
        read_cell(whole, layout.type[column], cell);
      } else if (std::isnan(v) || f->find_first_not_of("+-0123456789") != std::string_view::npos) {
        block.real[slot] = 1;
      }
    }
    if (column > layout.last_column) {
      for (int c = column; c <= layout.last_used; ++c) {
        if (layout.slot[c] >= 0) block.real[static_cast<std::size_t>(layout.slot[c])] = 1;
      }
      continue;
    }
    block.values.resize(base);
    if (column == 0) continue;                                                        // blank or comment
    if (column == 1 && head.announced && first >= 0 && first == std::floor(first)) {  // the count of another block
      block.announced += static_cast<std::uint64_t>(std::min(first, 1e15));
      continue;
    }
    block.error = fmt::format("{}line {} has {} of {} columns", last && text.at_end() ? "truncated: " : "",
                              grouped(number), column, head.columns);
    return block;
  }
  return block;
}

struct Rows {
  std::vector<double> cells;
  std::vector<std::uint8_t> real;  ///< as in Block, for all blocks
  std::uint64_t announced = 0;
};

/// All rows, read in parallel and joined in order.
Rows read_rows(const Input& in, const Head& head, const Layout& layout) {
  const std::size_t chunk = 1 << 13;
  std::vector<const char*> starts;  // beginning of every chunk-th line
  const char* p = head.body.data();
  const char* const end = p + head.body.size();
  for (std::size_t line = 0; p != end; ++line) {
    if (line % chunk == 0) starts.push_back(p);
    const char* stop = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
    p = stop ? stop + 1 : end;
  }
  starts.push_back(end);
  std::vector<Block> blocks(starts.size() - 1);
  parallel_for(0, blocks.size(), 1, [&](std::size_t c) {
    const std::string_view lines(starts[c], static_cast<std::size_t>(starts[c + 1] - starts[c]));
    blocks[c] = read_block(lines, head.lines + c * chunk + 1, head, layout, c + 1 == blocks.size());
  });
  std::vector<std::size_t> begins;
  std::size_t size = 0;
  Rows rows;
  rows.real.assign(static_cast<std::size_t>(layout.width), 0);
  for (const Block& b : blocks) {
    if (!b.error.empty()) in.fail(b.error);
    begins.push_back(size);
    size += b.values.size();
    rows.announced += b.announced;
    for (std::size_t k = 0; k < b.real.size(); ++k) rows.real[k] |= b.real[k];
  }
  std::vector<double>& table = rows.cells;
  table.resize(size);
  parallel_for(0, blocks.size(), 1, [&](std::size_t c) {
    std::copy(blocks[c].values.begin(), blocks[c].values.end(), table.begin() + static_cast<std::ptrdiff_t>(begins[c]));
  });
  return rows;
}

struct ColumnType {
  NumberType type;    ///< the integer type that holds all numbers, or double
  bool exact = true;  ///< doubles hold them exactly
};

/// Type of a further column; empty if it has no numbers.
std::optional<ColumnType> type_of_column(const std::vector<double>& cells, std::size_t width, std::size_t slot,
                                         bool real) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t i = slot; i < cells.size(); i += width) {
    if (std::isnan(cells[i])) continue;
    least = std::min(least, cells[i]), most = std::max(most, cells[i]);
  }
  if (least > most) return std::nullopt;
  // The largest integers of 64 bits round up to the next power of two.
  const bool exact = least > -0x1p53 && most < 0x1p53;
  if (real) return ColumnType{NumberType::f64};
  if (least >= -0x1p31 && most < 0x1p31) return ColumnType{NumberType::i32};
  if (least >= -0x1p63 && (least < 0 ? most <= 0x1p63 : most < 0x1p63)) return ColumnType{NumberType::i64, exact};
  if (least >= 0 && most <= 0x1p64) return ColumnType{NumberType::u64, exact};
  return ColumnType{NumberType::f64};
}

/// The further columns as attributes, whose types are known only after the rows were read. 64-bit integers are read
/// again, because a double rounds them.
std::vector<NamedColumns> other_columns(const Input& in, const Head& head, const ColumnMeaning& meaning, Layout& layout,
                                        Rows& read) {
  const std::size_t width = static_cast<std::size_t>(layout.width);
  std::vector<NamedColumns> others;
  std::string without;
  bool again = false;
  for (const ColumnMeaning::Other& other : meaning.others) {
    const int slot = other.column < static_cast<int>(most_columns) ? layout.slot[other.column] : no_column;
    if (slot < 0) continue;
    const std::size_t k = static_cast<std::size_t>(slot);
    const auto type = type_of_column(read.cells, width, k, read.real[k] != 0);
    if (!type) {
      without += (without.empty() ? "" : ", ") + other.name;
      continue;
    }
    if (!type->exact) layout.type[other.column] = type->type, again = true;
    others.push_back({other.name, type->type, {Column{nullptr, k, layout.type[other.column], false}}});
  }
  if (!without.empty()) in.warn("columns without numbers were left out: " + without);
  if (again) read = read_rows(in, head, layout);
  for (NamedColumns& other : others) {
    Column& c = other.components[0];
    c.at = reinterpret_cast<const char*>(read.cells.data() + c.stride);
    c.stride = width * sizeof(double);
  }
  return others;
}

/// Positions, normals and colours of n points; `normals_below`: as many rows of normals follow the positions.
CloudColumns cloud_columns(const ColumnMeaning& meaning, const Layout& layout, const std::vector<double>& table,
                           std::size_t n, bool normals_below) {
  const std::size_t width = static_cast<std::size_t>(layout.width);
  const auto column = [&](int k, std::size_t first_row = 0) {
    const int c = meaning.column[k];
    if (c < 0) return Column{};
    const double* at = table.data() + first_row * width + static_cast<std::size_t>(layout.slot[c]);
    return Column{reinterpret_cast<const char*>(at), width * sizeof(double), NumberType::f64, false};
  };
  CloudColumns cloud;
  for (int k = 0; k < 3; ++k) {
    cloud.position[k] = column(k);
    if (normals_below)
      cloud.normal[k] = column(k, n);
    else if (meaning.has(3))
      cloud.normal[k] = column(3 + k);
    if (meaning.has(6)) cloud.color[k] = column(6 + k);
  }
  if (!meaning.has(6)) return cloud;
  // Fractions only if some colour is not an integer.
  cloud.whole_colors = true;
  for (std::size_t i = 0; i < n && cloud.whole_colors; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double c = cloud.color[k][i];
      if (std::isfinite(c) && c != std::floor(c)) cloud.whole_colors = false;
    }
  }
  return cloud;
}

}  // namespace

PointSet read_table(const Input& in) {
  const std::string_view bytes = without_byte_order_mark(in.bytes);
  if (bytes.substr(0, 4096).find('\0') != std::string_view::npos)
    in.fail("is not text, as its ending says it should be");
  std::string with_points;
  Head head = read_head(in, bytes, with_points);
  const std::string extension = ending(in.file);
  const bool normals_by_ending =
      head.columns == 6 && (extension == "pwn" || extension == "xyzn" || extension == "npts");
  const ColumnMeaning meaning = head.names ? *head.names : meaning_of_values(first_rows(head), normals_by_ending);
  Layout layout = make_layout(in, meaning, head.columns);
  Rows read = read_rows(in, head, layout);
  if (head.announced) *head.announced += read.announced;
  const std::vector<NamedColumns> others = other_columns(in, head, meaning, layout, read);
  const std::size_t rows = read.cells.size() / static_cast<std::size_t>(layout.width);
  if (rows == 0) in.fail("holds no points");

  // Count, points, then as many normals.
  const bool normals_below = head.announced && head.columns == 3 && *head.announced > 0 && rows == 2 * *head.announced;
  const std::size_t n = normals_below ? rows / 2 : rows;
  if (head.announced && n < *head.announced)
    in.fail(fmt::format("truncated: announces {} points, holds {}", grouped(*head.announced), grouped(n)));
  if (head.announced && n > *head.announced)
    in.warn(fmt::format("announces {} points, holds {}", grouped(*head.announced), grouped(n)));

  PointSet points;
  decode_columns(in, cloud_columns(meaning, layout, read.cells, n, normals_below), n, points);
  points.attributes = decode_attributes(in, others, n);
  in.report.format = fmt::format("text, {} columns{}{}", head.columns, points.has_normals() ? ", normals" : "",
                                 points.has_colors() ? ", colours" : "");
  finish(in, points);
  return points;
}

}  // namespace sansmesh::inline v1::io
