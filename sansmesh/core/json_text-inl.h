// JSON parsing with the library's own error messages. Include it only in sources: the JSON library is slow to compile.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {

/// Returns "line 3, column 14" for the last byte read; `byte` counts from 1.
inline std::string json_location(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte > 0 ? byte - 1 : 0, text.size()));
  const std::size_t line = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t begin = before.rfind('\n');
  return fmt::format("line {}, column {}", line, 1 + before.size() - (begin == std::string_view::npos ? 0 : begin + 1));
}

/// Error text of one line, without the parser's class names.
inline std::string json_error(std::string_view text, const nlohmann::json::parse_error& error) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return "is not JSON: it is blank";
  if (error.byte > text.size()) {
    const std::string_view all = text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
    return "is not JSON: it ends unexpectedly at " + json_location(text, all.size());
  }
  const std::string what = error.what(), location = json_location(text, error.byte);
  const char c = error.byte > 0 ? text[error.byte - 1] : ' ';
  if (what.find("ill-formed UTF-8") != std::string::npos)
    return fmt::format("is not JSON: {} is not valid UTF-8", location);
  if (what.find("control character") != std::string::npos)
    return fmt::format("is not JSON: at {} a string is unterminated or contains a control character", location);
  return fmt::format("is not JSON: unexpected '{}' at {}", printable(std::string_view(&c, 1)), location);
}

/// `look` receives the parser's events (nlohmann's callback). Throws ArgumentError, with the location, if the text is
/// not JSON or holds a number outside the range of double.
template <class Json>
Json parse_json(std::string_view text, const typename Json::parser_callback_t& look = nullptr, bool comments = false) {
  try {
    return Json::parse(text.begin(), text.end(), look, true, comments);
  } catch (const nlohmann::json::parse_error& error) {
    throw ArgumentError(json_error(text, error));
  } catch (const nlohmann::json::out_of_range&) {
    throw ArgumentError("contains a number that is too large");
  }
}

/// Same as parse_json, but throws FileError.
template <class Json>
Json parse_json_file(const std::string& file, std::string_view text) {
  try {
    return parse_json<Json>(text);
  } catch (const ArgumentError& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace sansmesh::inline v1::detail
