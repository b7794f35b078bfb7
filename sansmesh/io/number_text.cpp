#include "sansmesh/io/number_text.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::io {

void NumberText::skip() {
  for (;;) {
    scanner_.skip_space();
    if (scanner_.at_end() || *scanner_.position() != '#') return;
    scanner_.line();
  }
}

std::string_view NumberText::word() {
  skip();
  return scanner_.word();
}

bool NumberText::at_number() {
  skip();
  if (scanner_.at_end()) return false;
  const char c = *scanner_.position();
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
}

bool NumberText::at_line_end() {
  scanner_.skip_blanks();
  return scanner_.at_end() || *scanner_.position() == '\n' || *scanner_.position() == '#';
}

bool NumberText::at_end() {
  skip();
  return scanner_.at_end();
}

double NumberText::real(const char* of) {
  skip();
  double value = 0;
  TextScanner ahead = scanner_;
  if (!scanner_.number(value)) fail_number(of);
  // Rejects "1.5.5": the rest would be read as the next number.
  if (!scanner_.at_end() && !TextScanner::is_blank(*scanner_.position()) && *scanner_.position() != '\n' &&
      *scanner_.position() != '#')
    fail(fmt::format("'{}' is not a number, among its {}", printable(ahead.word(), 30), of));
  return value;
}

std::int64_t NumberText::whole(const char* of) {
  skip();
  std::int64_t value = 0;
  if (!scanner_.number(value)) fail_number(of);
  // Rejects "1.0": the rest would be read as the next number.
  if (!scanner_.at_end() && (*scanner_.position() == '.' || *scanner_.position() == 'e'))
    fail(fmt::format("an integer is required among its {}", of));
  return value;
}

std::size_t NumberText::count(const char* of, std::size_t bytes) {
  const std::int64_t n = whole(of);
  if (n < 0) fail(fmt::format("an impossible number of {1}: {0}", n, of));
  const auto wanted = static_cast<std::uint64_t>(n);
  const std::size_t left = scanner_.rest().size();
  if (wanted > (left + 1) / bytes)
    in_.fail(fmt::format("truncated: {} bytes are left for {} {}", grouped(left), grouped(wanted), of));
  return static_cast<std::size_t>(wanted);
}

void NumberText::fail(const std::string& cause) const {
  const std::size_t at = in_.bytes.size() - scanner_.rest().size();
  // The text may be a copy of a part of the file: line numbers are known only if it is the file's own text.
  const char* const first = in_.bytes.data();
  if (scanner_.rest().data() + scanner_.rest().size() != first + in_.bytes.size()) in_.fail(cause);
  in_.fail(fmt::format("line {}: {}", 1 + std::count(first, first + at, '\n'), cause));
}

void NumberText::fail_number(const char* of) {
  if (scanner_.at_end()) in_.fail(fmt::format("truncated: it ends within its {}", of));
  TextScanner ahead = scanner_;
  fail(fmt::format("'{}' is not a number, among its {}", ahead.word().substr(0, 30), of));
}

}  // namespace sansmesh::inline v1::io
