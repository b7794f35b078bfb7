// Numbers in free-form text, independent of line breaks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sansmesh/io/input.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

/// Iterates over words and numbers; text from a '#' to the end of its line is skipped.
class NumberText {
 public:
  NumberText(const Input& in, std::string_view text) : in_(in), scanner_(text) {}

  /// The next word on any line; empty at the end.
  std::string_view word();
  /// The rest of the line.
  std::string_view line() { return scanner_.line(); }
  /// Whether a number comes next; skips only blanks and comments.
  bool at_number();
  /// Whether the rest of the line holds only comments and blanks.
  bool at_line_end();
  bool at_end();

  // Numbers. `of` names them in messages: "vertices". Throw FileError if there is none.
  double real(const char* of);
  std::int64_t whole(const char* of);
  /// A number of following entries, each at least `bytes` long.
  std::size_t count(const char* of, std::size_t bytes = 2);

  /// Throws FileError with the line number.
  [[noreturn]] void fail(const std::string& cause) const;
  TextScanner& scanner() { return scanner_; }

 private:
  void skip();
  [[noreturn]] void fail_number(const char* of);

  const Input& in_;
  TextScanner scanner_;
};

}  // namespace sansmesh::inline v1::io
