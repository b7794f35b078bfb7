// Well-known text of coordinate reference systems (OGC 01-009, ISO 19162) as a tree.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// KEYWORD["text", 1.5, CHILD[…], …].
struct WktNode {
  std::string keyword;              ///< in upper case
  std::vector<std::string> values;  ///< texts, numbers and bare words, in order
  std::vector<WktNode> children;

  /// First child with one of the keywords; null if there is none.
  const WktNode* child(std::initializer_list<std::string_view> keywords) const;
  /// First text; empty if there is none.
  std::string name() const { return values.empty() ? std::string() : values[0]; }
};

/// The root; empty if the text is no WKT. "PROJCS[…],VERTCS[…]", the form of ESRI, becomes a compound system with the
/// name of its first part.
std::optional<WktNode> parse_wkt(std::string_view text);

}  // namespace sansmesh::inline v1
