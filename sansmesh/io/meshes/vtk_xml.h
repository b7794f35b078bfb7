// Parser for the subset of XML that VTK writes: tags with quoted attributes, text between them.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/io/input.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {

/// A start tag, an end tag (name begins with '/') or a self-closing element. Comments and processing instructions are
/// skipped.
struct XmlTag {
  std::string_view name;
  std::map<std::string_view, std::string_view> attributes;
  bool closed = false;

  std::string_view operator[](std::string_view key) const {
    const auto it = attributes.find(key);
    return it == attributes.end() ? std::string_view() : it->second;
  }
};

/// Iterates over the tags of a file.
class XmlScanner {
 public:
  explicit XmlScanner(const Input& in) : in_(in), p_(in.bytes.data()), end_(p_ + in.bytes.size()) {}

  /// The next tag; empty at the end. Throws FileError if a tag is cut or malformed.
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

/// VTK's name of a type: "Float32".
const char* vtk_type_name(NumberType type);
std::optional<NumberType> vtk_type_of_name(std::string_view name);

/// Replaces the entities of an attribute's value (&amp; &#65; …) by their characters, and back.
std::string from_xml(std::string_view value);
std::string to_xml(std::string_view value);

/// Decodes groups of four characters up to the first other character. A padded group does not end the data: VTK joins
/// header and data, each padded separately.
std::vector<char> decode_base64(std::string_view text);

}  // namespace sansmesh::inline v1::io
