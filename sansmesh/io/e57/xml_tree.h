// Small XML documents as trees: elements with attributes and text.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sansmesh::inline v1::io {

/// One element. Comments, processing instructions and the order of text and children are not kept.
struct XmlElement {
  std::string_view name;                                                  ///< with its prefix: "nor:normalX"
  std::vector<std::pair<std::string_view, std::string_view>> attributes;  ///< values as in the document
  std::string text;                     ///< all text and CDATA of the element itself, entities replaced
  std::vector<std::uint32_t> children;  ///< indices of elements, in order

  /// Value of an attribute; empty if there is none.
  std::string_view operator[](std::string_view key) const;
};

/// A parsed document, which refers to the text. Element 0 is the root.
///
/// A subset of XML 1.0 without document types: no entity is defined, so the time and the memory are linear in the
/// length of the text. The shortest element, <a/>, takes about 100 bytes. The parser has 120 lines; expat or pugixml
/// would be a further package of every build.
class XmlTree {
 public:
  /// Parses `text`; calls `fail` with the cause, which must throw, if it is not well-formed or too deep.
  XmlTree(std::string_view text, const std::function<void(const std::string&)>& fail);

  const XmlElement& root() const { return elements_[0]; }
  const XmlElement& operator[](std::uint32_t element) const { return elements_[element]; }
  /// First child with that name; null if there is none.
  const XmlElement* child(const XmlElement& parent, std::string_view name) const;
  /// Descendant with that path of names: {"pose", "translation", "x"}.
  const XmlElement* find(const XmlElement& parent, std::initializer_list<std::string_view> path) const;

 private:
  std::deque<XmlElement> elements_;  ///< a vector would take three times the memory while it grows
};

}  // namespace sansmesh::inline v1::io
