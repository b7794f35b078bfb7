#include "sansmesh/points/cleaning/point_classes.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <variant>
#include <vector>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Names of the classes below 64 (LAS 1.4, "ASPRS standard point classes"); 8 and 12 as in earlier versions.
constexpr std::string_view kClassNames[] = {"never-classified",
                                            "unclassified",
                                            "ground",
                                            "low-vegetation",
                                            "medium-vegetation",
                                            "high-vegetation",
                                            "building",
                                            "low-noise",
                                            "key-point",
                                            "water",
                                            "rail",
                                            "road",
                                            "overlap",
                                            "wire-guard",
                                            "wire-conductor",
                                            "tower",
                                            "wire-connector",
                                            "bridge",
                                            "high-noise",
                                            "overhead",
                                            "ignored-ground",
                                            "snow",
                                            "temporal-exclusion"};

struct ClassGroup {
  std::string_view name;
  std::uint32_t classes;  ///< a bit per class
};
constexpr ClassGroup kClassGroups[] = {{"vegetation", 1u << 3 | 1u << 4 | 1u << 5},
                                       {"noise", 1u << 7 | 1u << 18},
                                       {"wire", 1u << 13 | 1u << 14 | 1u << 16}};

/// Class of a number of any type; −1 if invalid.
template <class T>
int class_of(T v) {
  const auto number = static_cast<double>(v);
  return number >= 0 && number < 256 ? static_cast<int>(number) : -1;
}

[[noreturn]] void refuse_class(const std::string& word) {
  std::string names;
  for (const std::string_view name : kClassNames) names += ", " + std::string(name);
  for (const ClassGroup& group : kClassGroups) names += ", " + std::string(group.name);
  throw ArgumentError("'" + printable(word, 40) + "' is no class of points: numbers 0..255, ranges such as 3-5, or" +
                      names.substr(1));
}

/// Parses a number, or two with a dash between them; returns false for other texts.
bool parse_class_range(const std::string& word, PointClasses& classes) {
  unsigned first = 0, last = 0;
  const char* const end = word.data() + word.size();
  auto [at, error] = std::from_chars(word.data(), end, first);
  if (error != std::errc()) return false;
  last = first;
  if (at != end) {
    if (*at != '-') return false;
    const auto second = std::from_chars(at + 1, end, last);
    if (second.ec != std::errc() || second.ptr != end) return false;
  }
  if (first > last || last > 255) return false;
  for (unsigned c = first; c <= last; ++c) classes.set(c);
  return true;
}

/// "2 (ground)"
std::string class_words(unsigned number) {
  const std::string_view name = point_class_name(number);
  return std::to_string(number) + (name.empty() ? "" : " (" + std::string(name) + ")");
}

}  // namespace

PointClasses parse_point_classes(std::string_view list) {
  PointClasses classes;
  for (const std::string& entry : between_commas(list)) {
    const std::string word = lower_case(without_blanks(entry));
    if (parse_class_range(word, classes)) continue;
    const auto* const name = std::find(std::begin(kClassNames), std::end(kClassNames), word);
    const auto* const group = std::find_if(std::begin(kClassGroups), std::end(kClassGroups),
                                           [&](const ClassGroup& g) { return g.name == word; });
    if (name != std::end(kClassNames))
      classes.set(static_cast<std::size_t>(name - std::begin(kClassNames)));
    else if (group != std::end(kClassGroups))
      classes |= PointClasses(group->classes);
    else
      refuse_class(word);
  }
  return classes;
}

std::string point_classes_text(const PointClasses& classes) {
  std::string text;
  for (std::size_t first = 0; first < classes.size(); ++first) {
    if (!classes[first]) continue;
    std::size_t last = first;
    while (last + 1 < classes.size() && classes[last + 1]) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(first);
    if (last > first) text += "-" + std::to_string(last);
    first = last;
  }
  return text;
}

std::string_view point_class_name(unsigned number) {
  return number < std::size(kClassNames) ? kClassNames[number] : std::string_view();
}

const Attribute* find_point_classes(const PointSet& points) {
  for (const std::string_view wanted : {"classification", "scalar_classification", "class"})
    for (const Attribute& a : points.attributes)
      if (a.components == 1 && lower_case(without_blanks(a.name)) == wanted) return &a;
  return nullptr;
}

std::array<std::size_t, 256> count_point_classes(const Attribute& classification) {
  std::array<std::size_t, 256> counts{};
  std::visit(
      [&](const auto& values) {
        for (const auto v : values)
          if (const int c = class_of(v); c >= 0) ++counts[static_cast<std::size_t>(c)];
      },
      classification.values);
  return counts;
}

void keep_classes(PointSet& points, const PointClasses& classes) {
  const Attribute* const of = find_point_classes(points);
  if (!of)
    throw DataError(
        "its points have no class (no attribute 'classification' with a number other than 0), by which "
        "`class` could choose");
  std::vector<std::uint8_t> gone(points.size(), 1);
  std::visit(
      [&](const auto& values) {
        for (std::size_t i = 0; i < gone.size(); ++i)
          if (const int c = class_of(values[i]); c >= 0 && classes[static_cast<std::size_t>(c)]) gone[i] = 0;
      },
      of->values);
  const auto lost = static_cast<std::size_t>(std::count(gone.begin(), gone.end(), std::uint8_t{1}));
  if (lost == points.size()) {
    const auto counts = count_point_classes(*of);
    std::string there;
    for (unsigned c = 0; c < counts.size(); ++c)
      if (counts[c] > 0) there += (there.empty() ? "" : ", ") + class_words(c);
    throw DataError("none of its " + counted(points.size(), "point") + " is of a class in `class`; there are " +
                    (there.empty() ? "none from 0 to 255" : there));
  }
  if (lost > 0) remove_samples(points, gone);
}

}  // namespace sansmesh::inline v1
