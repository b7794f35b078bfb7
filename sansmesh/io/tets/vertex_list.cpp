#include "sansmesh/io/tets/vertex_list.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/error.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1 {

std::vector<std::uint64_t> read_vertex_list(const std::string& file) {
  return parse_vertex_list(io::FileContent(file).bytes(), file);
}

std::vector<std::uint64_t> parse_vertex_list(std::string_view bytes, const std::string& file) {
  std::vector<std::uint64_t> numbers;
  io::TextScanner text(bytes);
  for (std::size_t line = 1; !text.at_end(); ++line) {
    const std::string_view all = text.line();
    std::string row(all.substr(0, all.find('#')));
    std::replace(row.begin(), row.end(), ',', ' ');
    io::TextScanner s(row);
    for (std::string_view word = s.word(); !word.empty(); word = s.word()) {
      io::TextScanner digits(word);
      std::uint64_t n = 0;
      if (!digits.number(n) || !digits.at_end())
        throw FileError(file, fmt::format("line {}: '{}' is not a vertex number", line, word.substr(0, 30)));
      numbers.push_back(n);
    }
  }
  if (numbers.empty()) throw FileError(file, "names no vertices");
  return numbers;
}

}  // namespace sansmesh::inline v1
