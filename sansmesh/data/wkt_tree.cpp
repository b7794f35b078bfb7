#include "sansmesh/data/wkt_tree.h"
#include "sansmesh/core/option_text.h"

#include <algorithm>
#include <cctype>

namespace sansmesh::inline v1 {
namespace {

constexpr int kDeepestNode = 64;

class WktParser {
 public:
  explicit WktParser(std::string_view text) : rest_(text) {}

  std::optional<WktNode> parse() {
    WktNode root, heights;
    if (!read_root(root)) return std::nullopt;
    if (take(",")) {
      if (!read_root(heights) || !heights.keyword.starts_with("VERT")) return std::nullopt;
      root = {"COMPD_CS", {root.name()}, {root, heights}};
    }
    skip_space();
    return rest_.empty() ? std::optional(std::move(root)) : std::nullopt;
  }

 private:
  bool read_root(WktNode& root) {
    std::string word;
    skip_space();
    return read_word(word) && read_node(word, 0, root);
  }
  void skip_space() {
    while (!rest_.empty() && (std::isspace(static_cast<unsigned char>(rest_[0])) != 0 || rest_[0] == '\0'))
      rest_.remove_prefix(1);
  }
  bool take(std::string_view one_of) {
    skip_space();
    if (rest_.empty() || one_of.find(rest_[0]) == std::string_view::npos) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool read_word(std::string& word) {
    const auto part = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-' || c == '+' ||
             c == ':';
    };
    const auto end = std::find_if_not(rest_.begin(), rest_.end(), part);
    word.assign(rest_.begin(), end);
    rest_.remove_prefix(word.size());
    return !word.empty();
  }
  /// A text; two quotes are one.
  bool read_text(std::string& text) {
    rest_.remove_prefix(1);
    for (;;) {
      const std::size_t quote = rest_.find('"');
      if (quote == std::string_view::npos) return false;
      text += rest_.substr(0, quote);
      rest_.remove_prefix(quote + 1);
      if (!rest_.starts_with('"')) return true;
      text += '"';
      rest_.remove_prefix(1);
    }
  }
  /// The part behind the keyword.
  bool read_node(std::string_view keyword, int depth, WktNode& node) {
    node.keyword = upper_case(keyword);
    if (depth == kDeepestNode || !take("[(")) return false;
    do {
      skip_space();
      std::string word;
      if (rest_.starts_with('"')) {
        if (!read_text(word)) return false;
        node.values.push_back(std::move(word));
        continue;
      }
      if (!read_word(word)) return false;
      skip_space();
      if (rest_.starts_with('[') || rest_.starts_with('(')) {
        if (!read_node(word, depth + 1, node.children.emplace_back())) return false;
      } else {
        node.values.push_back(std::move(word));
      }
    } while (take(","));
    return take("])");
  }

  std::string_view rest_;
};

}  // namespace

const WktNode* WktNode::child(std::initializer_list<std::string_view> keywords) const {
  for (const WktNode& c : children)
    if (std::find(keywords.begin(), keywords.end(), c.keyword) != keywords.end()) return &c;
  return nullptr;
}

std::optional<WktNode> parse_wkt(std::string_view text) { return WktParser(text).parse(); }

}  // namespace sansmesh::inline v1
