#include "sansmesh/io/transform_file.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "sansmesh/core/json_text-inl.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1 {
namespace {

constexpr const char* kRowsOfFour = "must hold 4 rows of 4 numbers";

std::vector<double> numbers_of_text(const std::string& file, std::string_view bytes) {
  std::string text(bytes.substr(0, 1 << 16));  // enough to reject a cloud without reading all of it
  for (char& c : text)
    if (c == ',' || c == ';') c = ' ';
  std::vector<double> numbers;
  io::TextScanner lines(text);
  while (!lines.at_end()) {
    io::TextScanner line(lines.line());
    for (;;) {
      line.skip_blanks();
      if (line.at_end() || line.rest().starts_with('#') || line.rest().starts_with("//")) break;
      double value = 0;
      if (!line.number(value))
        throw FileError(file, std::string(kRowsOfFour) + ", not '" + std::string(line.word()) + "'");
      numbers.push_back(value);
    }
  }
  return numbers;
}

std::vector<double> numbers_of_json(const std::string& file, std::string_view bytes) {
  using nlohmann::json;
  const auto parsed = detail::parse_json_file<json>(file, bytes);
  const json* list = &parsed;
  if (parsed.is_object() && parsed.contains("matrix")) list = &parsed["matrix"];
  std::vector<double> numbers;
  const auto add = [&](const json& value) {
    if (!value.is_number()) throw FileError(file, std::string(kRowsOfFour) + " as a list, or as that of `matrix`");
    numbers.push_back(value.get<double>());
  };
  if (!list->is_array()) add(json());
  for (const json& row : *list) {
    if (!row.is_array())
      add(row);
    else
      for (const json& value : row) add(value);
  }
  return numbers;
}

}  // namespace

AffineMap read_transform(const std::string& file) { return parse_transform(io::FileContent(file).bytes(), file); }

AffineMap parse_transform(std::string_view text, const std::string& file) {
  const std::string_view bytes = io::without_byte_order_mark(text);
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  const bool json = begin != std::string_view::npos && (bytes[begin] == '[' || bytes[begin] == '{');
  const std::vector<double> m = json ? numbers_of_json(file, bytes) : numbers_of_text(file, bytes);
  if (m.size() != 12 && m.size() != 16)
    throw FileError(file, std::string(kRowsOfFour) + ", but it holds " + std::to_string(m.size()) + " numbers");
  const AffineMap map{{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
  if (m.size() == 16 && !(m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1)) {
    const bool columns = m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
    throw FileError(file, columns
                              ? "its last column is 0 0 0 1, not its last row: it has columns for rows, transpose it"
                              : "the last row of the matrix must be 0 0 0 1");
  }
  try {
    (void)map.inverse();
  } catch (const ArgumentError& error) {
    throw FileError(file, error.what());
  }
  return map;
}

void write_transform(const std::string& file, const AffineMap& map) {
  const bool json = io::ending(file) == "json";
  std::string text = json ? "{\"matrix\": [" : "";
  for (std::size_t row = 0; row < 4; ++row) {
    if (json) text += row > 0 ? ",\n            [" : "[";
    for (std::size_t column = 0; column < 4; ++column) {
      const double value = row == 3 ? (column == 3 ? 1 : 0)
                                    : (column == 0   ? map.x
                                       : column == 1 ? map.y
                                       : column == 2 ? map.z
                                                     : map.shift)[row];
      char number[io::number_width];
      text += column == 0 ? "" : json ? ", " : " ";
      text.append(number, io::put(number, value + 0.0));  // no -0
    }
    text += json ? "]" : "\n";
  }
  write_text(file, text + (json ? "]}\n" : ""));
}

}  // namespace sansmesh::inline v1
