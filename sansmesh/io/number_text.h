// Numbers in text, one after the other, wherever lines end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sansmesh/io/input.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

/// Walks over words and numbers; what follows a '#' up to the end of its line is skipped.
class NumberText {
 public:
  NumberText(const Input& in, std::string_view text) : in_(in), scanner_(text) {}

  /// The next word, on whatever line; empty at the end.
  std::string_view word();
  /// The rest of the line.
  std::string_view line() { return scanner_.line(); }
  /// Whether a number comes next; never moves past anything but blanks and comments.
  bool at_number();
  /// Whether nothing but comments and blanks is left of the line.
  bool at_line_end();
  bool at_end();

  // Numbers; `of` is what they are numbers of, in messages: "vertices". Throw FileError where there is none.
  double real(const char* of);
  std::int64_t whole(const char* of);
  /// A number that says how many entries follow, each at least `bytes` long.
  std::size_t count(const char* of, std::size_t bytes = 2);

  /// Throws FileError with the number of the line.
  [[noreturn]] void fail(const std::string& cause) const;
  TextScanner& scanner() { return scanner_; }

 private:
  void skip();
  [[noreturn]] void fail_number(const char* of);

  const Input& in_;
  TextScanner scanner_;
};

}  // namespace sansmesh::inline v1::io
