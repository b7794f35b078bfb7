#include "sansmesh/io/e57/e57_scans.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "sansmesh/io/e57/xml_tree.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kMostFields = 4096;

class ScanParser {
 public:
  ScanParser(const Input& in, const XmlTree& tree) : in_(in), tree_(tree) {}

  E57Content parse() {
    E57Content content;
    if (tree_.root().name != "e57Root") in_.fail("malformed E57: the XML has no element e57Root");
    if (const XmlElement* const pictures = tree_.child(tree_.root(), "images2D"))
      content.pictures = pictures->children.size();
    if (const XmlElement* const system = tree_.child(tree_.root(), "coordinateMetadata"))
      content.reference_system = system->text;
    const XmlElement* const scans = tree_.child(tree_.root(), "data3D");
    if (!scans) return content;
    for (const std::uint32_t child : scans->children) {
      E57Scan scan = parse_scan(tree_[child], content.scans.size() + content.empty_scans + 1);
      if (scan.records == 0)
        ++content.empty_scans;
      else
        content.scans.push_back(std::move(scan));
    }
    return content;
  }

 private:
  /// A number of an element or attribute; `otherwise` if there is none, as the format prescribes defaults.
  template <class T>
  T number(std::string_view text, T otherwise, std::string_view what) const {
    TextScanner scanner(text);
    scanner.skip_space();
    if (scanner.at_end()) return otherwise;
    T value = {};
    if (!scanner.number(value)) bad(text, what);
    scanner.skip_space();
    if (!scanner.at_end()) bad(text, what);
    return value;
  }
  [[noreturn]] void bad(std::string_view text, std::string_view what) const {
    in_.fail(fmt::format("malformed E57: '{}' of {} is not a number", printable(std::string(text), 40),
                         printable(std::string(what), 40)));
  }
  double number_at(const XmlElement& parent, std::initializer_list<std::string_view> path, double otherwise) const {
    const XmlElement* const element = tree_.find(parent, path);
    return element ? number(element->text, 0.0, element->name) : otherwise;
  }

  E57Scan parse_scan(const XmlElement& element, std::size_t number_of_scan) {
    E57Scan scan;
    if (const XmlElement* const name = tree_.child(element, "name")) scan.name = printable(name->text, 200);
    if (scan.name.empty()) scan.name = std::to_string(number_of_scan);
    const XmlElement* const points = tree_.child(element, "points");
    if (!points) return scan;
    scan.offset = number<std::uint64_t>((*points)["fileOffset"], 0, "fileOffset");
    scan.records = number<std::uint64_t>((*points)["recordCount"], 0, "recordCount");
    if (const XmlElement* const prototype = tree_.child(*points, "prototype")) add_fields(*prototype, scan);
    check_codecs(*points, scan);
    parse_pose(element, scan);
    if (const XmlElement* const limits = tree_.child(element, "colorLimits")) {
      static constexpr std::string_view colors[] = {"colorRed", "colorGreen", "colorBlue"};
      for (std::size_t k = 0; k < 3; ++k) {
        const double least = number_at(*limits, {std::string(colors[k]) + "Minimum"}, 0),
                     largest = number_at(*limits, {std::string(colors[k]) + "Maximum"}, 0);
        if (largest > least) scan.color_limits[k] = {least, largest};
      }
    }
    return scan;
  }

  /// Fields are the leaves of the prototype, in order.
  void add_fields(const XmlElement& parent, E57Scan& scan) {
    for (const std::uint32_t c : parent.children) {
      const XmlElement& leaf = tree_[c];
      const std::string_view type = leaf["type"];
      if (type == "Structure" || type == "Vector") {
        add_fields(leaf, scan);
        continue;
      }
      if (scan.fields.size() == kMostFields) in_.fail("malformed E57: a scan with more than 4,096 fields");
      scan.fields.push_back(parse_field(leaf, type));
    }
  }

  E57Field parse_field(const XmlElement& leaf, std::string_view type) const {
    using Whole = std::numeric_limits<std::int64_t>;
    E57Field f;
    f.name = printable(std::string(leaf.name), 80);
    const std::string_view least = leaf["minimum"], largest = leaf["maximum"];
    if (type == "Float") {
      f.kind = leaf["precision"] == "single" ? E57Kind::real32 : E57Kind::real64;
      if (!least.empty() && !largest.empty())
        f.least = number<double>(least, 0, leaf.name), f.largest = number<double>(largest, 0, leaf.name);
    } else if (type == "Integer" || type == "ScaledInteger") {
      f.kind = type == "Integer" ? E57Kind::integer : E57Kind::scaled;
      f.lowest = number(least, Whole::min(), leaf.name), f.highest = number(largest, Whole::max(), leaf.name);
      if (f.highest < f.lowest) in_.fail(fmt::format("malformed E57: '{}' has a maximum below its minimum", f.name));
      if (f.kind == E57Kind::scaled)
        f.scale = number(leaf["scale"], 1.0, leaf.name), f.offset = number(leaf["offset"], 0.0, leaf.name);
      if (!least.empty() && !largest.empty()) {
        f.least = static_cast<double>(f.lowest) * f.scale + f.offset;
        f.largest = static_cast<double>(f.highest) * f.scale + f.offset;
      }
    } else if (type == "String") {
      f.kind = E57Kind::text;
    } else {
      in_.fail(fmt::format("malformed E57: the field '{}' is of type '{}'", f.name, printable(std::string(type), 40)));
    }
    return f;
  }

  /// Without codecs, and with those of the standard, numbers are packed bits.
  void check_codecs(const XmlElement& points, const E57Scan& scan) const {
    const XmlElement* const codecs = tree_.child(points, "codecs");
    if (!codecs) return;
    for (const std::uint32_t c : codecs->children)
      for (const std::uint32_t k : tree_[c].children) {
        const std::string_view name = tree_[k].name;
        if (name != "inputs" && name != "bitPackCodec")
          in_.fail(fmt::format("scan {} is packed by '{}', which is not supported", scan.name,
                               printable(std::string(name), 40)));
      }
  }

  void parse_pose(const XmlElement& element, E57Scan& scan) const {
    const XmlElement* const pose = tree_.child(element, "pose");
    if (!pose) return;
    E57Pose p;
    if (tree_.child(*pose, "rotation"))
      p.w = number_at(*pose, {"rotation", "w"}, 1),
      p.xyz = {number_at(*pose, {"rotation", "x"}, 0), number_at(*pose, {"rotation", "y"}, 0),
               number_at(*pose, {"rotation", "z"}, 0)};
    p.translation = {number_at(*pose, {"translation", "x"}, 0), number_at(*pose, {"translation", "y"}, 0),
                     number_at(*pose, {"translation", "z"}, 0)};
    const double length = std::sqrt(p.w * p.w + dot(p.xyz, p.xyz));
    if (!std::isfinite(length) || !is_finite(p.translation) || length < 1e-6)
      in_.fail(fmt::format("malformed E57: the pose of scan {} is no rotation and translation", scan.name));
    p.w /= length, p.xyz = p.xyz * (1 / length);
    scan.pose = p;
  }

  const Input& in_;
  const XmlTree& tree_;
};

}  // namespace

std::optional<std::size_t> E57Scan::find(std::string_view field) const {
  for (std::size_t f = 0; f < fields.size(); ++f)
    if (fields[f].name == field && fields[f].kind != E57Kind::text) return f;
  return std::nullopt;
}

std::optional<std::array<std::size_t, 3>> E57Scan::find(std::string_view a, std::string_view b,
                                                        std::string_view c) const {
  const auto x = find(a), y = find(b), z = find(c);
  if (!x || !y || !z) return std::nullopt;
  return std::array{*x, *y, *z};
}

E57Content describe_scans(const Input& in, std::string_view xml) {
  const XmlTree tree(xml, [&](const std::string& cause) { in.fail(cause); });
  return ScanParser(in, tree).parse();
}

}  // namespace sansmesh::inline v1::io
