#include "sansmesh/io/e57/xml_tree.h"

#include <cstring>

#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kDeepestElement = 256;

class TreeParser {
 public:
  TreeParser(std::string_view text, const std::function<void(const std::string&)>& fail, std::deque<XmlElement>& out)
      : rest_(without_byte_order_mark(text)), fail_(fail), elements_(out) {}

  void parse() {
    while (!rest_.empty()) {
      const std::size_t tag = rest_.find('<');
      const std::string_view text = rest_.substr(0, tag);
      if (!open_.empty()) {
        elements_[open_.back()].text += from_xml(text);
      } else if (text.find_first_not_of(" \t\r\n\0", 0, 5) != std::string_view::npos) {
        fail_("malformed XML: text outside of the elements");
      }
      if (tag == std::string_view::npos) break;
      rest_.remove_prefix(tag);
      markup();
    }
    if (!open_.empty() || elements_.empty()) fail_("truncated: the XML ends inside an element");
  }

 private:
  /// Removes the text up to `stop` and `stop`; returns the text.
  std::string_view until(std::string_view stop, const char* what) {
    const std::size_t at = rest_.find(stop);
    if (at == std::string_view::npos) fail_(std::string("truncated: the XML ends inside ") + what);
    const std::string_view text = rest_.substr(0, at);
    rest_.remove_prefix(at + stop.size());
    return text;
  }

  void markup() {
    if (rest_.starts_with("<!--")) {
      until("-->", "a comment");
    } else if (rest_.starts_with("<?")) {
      until("?>", "a declaration");
    } else if (rest_.starts_with("<![CDATA[")) {
      rest_.remove_prefix(9);
      const std::string_view text = until("]]>", "a text");
      if (open_.empty()) fail_("malformed XML: text outside of the elements");
      elements_[open_.back()].text += text;
    } else if (rest_.starts_with("<!")) {
      fail_("malformed XML: document types are not supported");
    } else if (rest_.starts_with("</")) {
      rest_.remove_prefix(2);
      std::string_view name = until(">", "a tag");
      while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
      if (open_.empty() || elements_[open_.back()].name != name) fail_("malformed XML: an end tag without a start");
      open_.pop_back();
    } else {
      rest_.remove_prefix(1);
      start_tag();
    }
  }

  void start_tag() {
    if (open_.empty() && !elements_.empty()) fail_("malformed XML: more than one root element");
    if (open_.size() == kDeepestElement) fail_("malformed XML: more than 256 levels of elements");
    const auto number = static_cast<std::uint32_t>(elements_.size());
    if (!open_.empty()) elements_[open_.back()].children.push_back(number);
    XmlElement& element = elements_.emplace_back();
    element.name = word();
    if (element.name.empty()) fail_("malformed XML: a tag without a name");
    for (;;) {
      skip_space();
      if (rest_.empty()) fail_("truncated: the XML ends inside a tag");
      if (rest_.starts_with(">")) {
        rest_.remove_prefix(1);
        open_.push_back(number);
        return;
      }
      if (rest_.starts_with("/>")) {
        rest_.remove_prefix(2);
        return;
      }
      const std::string_view key = word();
      skip_space();
      if (key.empty() || !rest_.starts_with("=")) fail_("malformed XML: an attribute without a value");
      rest_.remove_prefix(1);
      skip_space();
      if (!rest_.starts_with("\"") && !rest_.starts_with("'")) fail_("malformed XML: an attribute without quotes");
      const std::string_view quote = rest_.substr(0, 1);
      rest_.remove_prefix(1);
      element.attributes.emplace_back(key, until(quote, "an attribute"));
    }
  }

  static bool is_space(char c) { return TextScanner::is_blank(c) || c == '\n'; }
  void skip_space() {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
  }
  std::string_view word() {
    std::size_t n = 0;
    while (n < rest_.size() && !is_space(rest_[n]) && !std::strchr("=/><\"'", rest_[n])) ++n;
    const std::string_view found = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return found;
  }

  std::string_view rest_;
  const std::function<void(const std::string&)>& fail_;
  std::deque<XmlElement>& elements_;
  std::vector<std::uint32_t> open_;
};

}  // namespace

std::string_view XmlElement::operator[](std::string_view key) const {
  for (const auto& [own, value] : attributes)
    if (own == key) return value;
  return {};
}

XmlTree::XmlTree(std::string_view text, const std::function<void(const std::string&)>& fail) {
  TreeParser(text, fail, elements_).parse();
}

const XmlElement* XmlTree::child(const XmlElement& parent, std::string_view name) const {
  for (const std::uint32_t c : parent.children)
    if (elements_[c].name == name) return &elements_[c];
  return nullptr;
}

const XmlElement* XmlTree::find(const XmlElement& parent, std::initializer_list<std::string_view> path) const {
  const XmlElement* at = &parent;
  for (const std::string_view name : path)
    if (at) at = child(*at, name);
  return at;
}

}  // namespace sansmesh::inline v1::io
