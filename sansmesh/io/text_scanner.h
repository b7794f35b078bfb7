// Scans text for words, lines and numbers, without copies and independent of the locale.
#pragma once

#include <charconv>
#include <cstring>
#include <string_view>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Text without the byte order mark that some editors write.
inline std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

/// A position in text. Blanks are space, tab, carriage return, form feed and vertical tab; a line ends at a line feed.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : p_(text.data()), end_(text.data() + text.size()) {}

  bool at_end() const { return p_ == end_; }
  const char* position() const { return p_; }
  std::string_view rest() const { return {p_, static_cast<std::size_t>(end_ - p_)}; }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

  void skip_blanks() {
    while (p_ != end_ && is_blank(*p_)) ++p_;
  }
  /// Skips blanks and line ends.
  void skip_space() {
    while (p_ != end_ && (is_blank(*p_) || *p_ == '\n')) ++p_;
  }

  /// The line up to the next line feed (without it and a carriage return before it); moves past it.
  std::string_view line() {
    const char* start = p_;
    const char* stop = static_cast<const char*>(std::memchr(p_, '\n', static_cast<std::size_t>(end_ - p_)));
    p_ = stop ? stop + 1 : end_;
    if (!stop) stop = end_;
    if (stop != start && stop[-1] == '\r') --stop;
    return {start, static_cast<std::size_t>(stop - start)};
  }

  /// The next word of this line, empty at the line's end.
  std::string_view word() {
    skip_blanks();
    const char* start = p_;
    while (p_ != end_ && !is_blank(*p_) && *p_ != '\n') ++p_;
    return {start, static_cast<std::size_t>(p_ - start)};
  }

  /// Reads a number at this position (after blanks); false, without moving past the blanks, if there is none.
  template <class T>
  bool number(T& value) {
    skip_blanks();
    const char* start = p_;
    if (start != end_ && *start == '+') ++start;
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (error == std::errc::result_out_of_range) {
      // Underflow and overflow are data, not damage; callers drop non-finite values.
      if constexpr (std::is_floating_point_v<T>)
        value = overflowed(start, stop) ? T(1e300) * T(1e300) : T(0);
      else
        return false;
    } else if (error != std::errc()) {
      return false;
    }
    p_ = stop;
    return true;
  }

  /// Reads three numbers.
  bool vector(Vec3& v) { return number(v.x) && number(v.y) && number(v.z); }

 private:
  static bool overflowed(const char* start, const char* stop) {
    const std::string_view s(start, static_cast<std::size_t>(stop - start));
    const std::size_t e = s.find_first_of("eE");
    return e == std::string_view::npos ? s.find_first_not_of("-0") != s.find('.')
                                       : s.substr(e + 1).find('-') == std::string_view::npos;
  }

  const char* p_;
  const char* end_;
};

}  // namespace sansmesh::inline v1::io
