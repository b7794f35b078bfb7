// The little of XML that VTK writes: tags with quoted attributes, text between them.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "sansmesh/io/input.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

/// A start tag, an end tag (name begins with '/') or an element that closes itself; comments and the like are skipped.
struct XmlTag {
  std::string_view name;
  std::map<std::string_view, std::string_view> attributes;
  bool closed = false;

  std::string_view operator[](std::string_view key) const {
    const auto it = attributes.find(key);
    return it == attributes.end() ? std::string_view() : it->second;
  }
};

/// Walks over the tags of a file.
class XmlScanner {
 public:
  explicit XmlScanner(const Input& in) : in_(in), p_(in.bytes.data()), end_(p_ + in.bytes.size()) {}

  /// The next tag; nothing at the end. Throws FileError where a tag is cut or malformed.
  std::optional<XmlTag> next();
  /// Text up to the next tag.
  std::string_view text() const { return rest().substr(0, rest().find('<')); }
  std::string_view rest() const { return {p_, static_cast<std::size_t>(end_ - p_)}; }

 private:
  static bool is_space(char c) { return TextScanner::is_blank(c) || c == '\n'; }
  const Input& in_;
  const char* p_;
  const char* end_;
};

/// An attribute's value with its entities (&amp; &#65; …) as the characters that they stand for, and back.
std::string from_xml(std::string_view value);
std::string to_xml(std::string_view value);

/// Decodes groups of four characters until something else comes. A group that is padded does not end it: VTK puts
/// header and data one after the other, each padded for itself.
std::vector<char> decode_base64(std::string_view text);

}  // namespace sansmesh::inline v1::io
