#include "sansmesh/io/meshes/vtk_xml.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace sansmesh::inline v1::io {

std::optional<XmlTag> XmlScanner::next() {
  for (;;) {
    const std::size_t start = rest().find('<');
    if (start == std::string_view::npos) return std::nullopt;
    p_ += start + 1;
    const char* skip = rest().starts_with("!--") ? "-->"
                       : rest().starts_with("?") ? "?>"
                       : rest().starts_with("!") ? ">"
                                                 : nullptr;
    if (!skip) break;
    const std::size_t stop = rest().find(skip);
    if (stop == std::string_view::npos) in_.fail("truncated: the XML ends inside a comment or declaration");
    p_ += stop + std::strlen(skip);
  }
  XmlTag tag;
  const char* start = p_;
  while (p_ != end_ && !is_space(*p_) && *p_ != '>' && (*p_ != '/' || p_ == start)) ++p_;
  tag.name = {start, static_cast<std::size_t>(p_ - start)};
  for (;;) {
    while (p_ != end_ && is_space(*p_)) ++p_;
    if (p_ == end_) in_.fail("truncated: the XML ends inside a tag");
    if (*p_ == '>') return ++p_, tag;
    if (*p_ == '/') {
      tag.closed = true;
      ++p_;
      continue;
    }
    const char* key = p_;
    while (p_ != end_ && *p_ != '=' && *p_ != '>' && !is_space(*p_)) ++p_;
    const std::string_view name(key, static_cast<std::size_t>(p_ - key));
    while (p_ != end_ && (is_space(*p_) || *p_ == '=')) ++p_;
    if (p_ == end_) in_.fail("truncated: the XML ends inside a tag");
    const char quote = *p_;
    if (quote != '"' && quote != '\'') in_.fail("malformed XML: an attribute without quotes");
    const std::size_t stop = rest().substr(1).find(quote);
    if (stop == std::string_view::npos) in_.fail("truncated: the XML ends inside an attribute");
    tag.attributes[name] = rest().substr(1, stop);
    p_ += stop + 2;
  }
}

namespace {

constexpr const char* kVtkTypes[] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                     "UInt32", "Int64", "UInt64", "Float32", "Float64"};

}  // namespace

const char* vtk_type_name(NumberType type) { return kVtkTypes[static_cast<std::size_t>(type)]; }

std::optional<NumberType> vtk_type_of_name(std::string_view name) {
  const auto* const at = std::find(std::begin(kVtkTypes), std::end(kVtkTypes), name);
  if (at == std::end(kVtkTypes)) return std::nullopt;
  return static_cast<NumberType>(at - std::begin(kVtkTypes));
}

std::string from_xml(std::string_view value) {
  static constexpr std::pair<std::string_view, char> entities[] = {
      {"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}};
  constexpr std::size_t longest = 12;  // "&#0000065;"
  std::string text;
  while (!value.empty()) {
    const std::size_t plain = value.find('&');
    text += value.substr(0, plain);
    if (plain == std::string_view::npos) break;
    value.remove_prefix(plain);
    if (const std::size_t stop = value.substr(0, longest).find(';'); stop != std::string_view::npos) {
      const std::string_view name = value.substr(1, stop - 1);
      const auto* const known =
          std::find_if(std::begin(entities), std::end(entities), [&](const auto& e) { return e.first == name; });
      unsigned code = 0;
      if (known != std::end(entities)) code = static_cast<unsigned char>(known->second);
      if (name.size() > 1 && name[0] == '#') TextScanner(name.substr(1)).number(code);
      if (code > 0 && code < 128) {  // non-ASCII characters are UTF-8 in files
        text += static_cast<char>(code);
        value.remove_prefix(stop + 1);
        continue;
      }
    }
    text += '&';
    value.remove_prefix(1);
  }
  return text;
}

std::string to_xml(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == '&')
      text += "&amp;";
    else if (c == '<')
      text += "&lt;";
    else if (c == '>')
      text += "&gt;";
    else if (c == '"')
      text += "&quot;";
    else
      text += static_cast<unsigned char>(c) < ' ' ? '_' : c;
  }
  return text;
}

std::vector<char> decode_base64(std::string_view text) {
  static const auto table = [] {
    std::array<signed char, 256> t;
    t.fill(-1);
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int k = 0; k < 64; ++k) t[static_cast<unsigned char>(digits[k])] = static_cast<signed char>(k);
    return t;
  }();
  std::vector<char> bytes;
  bytes.reserve(text.size() / 4 * 3);
  unsigned group = 0, digits = 0, padding = 0;
  for (const char c : text) {
    if (TextScanner::is_blank(c) || c == '\n') continue;
    const int v = c == '=' ? 0 : table[static_cast<unsigned char>(c)];
    if (v < 0) break;
    padding += c == '=';
    group = group << 6 | static_cast<unsigned>(v);
    if (++digits < 4) continue;
    for (unsigned k = 0; k < 3 && k + padding < 3; ++k) bytes.push_back(static_cast<char>(group >> (16 - 8 * k)));
    group = digits = padding = 0;
  }
  return bytes;
}

}  // namespace sansmesh::inline v1::io
