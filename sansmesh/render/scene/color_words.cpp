#include "sansmesh/render/scene/color_words.h"

#include <fmt/core.h>

#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/image.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::pair<std::string_view, std::string_view> kColorWords[] = {
    {"red", "#d62828"},  {"orange", "#f08c1e"}, {"yellow", "#f2d21f"},  {"green", "#2f9e44"}, {"cyan", "#22b8cf"},
    {"blue", "#2f6fde"}, {"purple", "#8e4ec6"}, {"magenta", "#d6409f"}, {"brown", "#8d5a34"}, {"white", "#f5f5f5"},
    {"gray", "#8c9199"}, {"silver", "#c6cad0"}, {"black", "#22252a"}};

}  // namespace

std::optional<Vec3f> color_of_hex(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  Vec3f color;
  for (std::size_t k = 0; k < 3; ++k) {
    int level = 0;
    for (const char digit : text.substr(1 + 2 * k, 2)) {
      const std::size_t value = std::string_view("0123456789abcdefABCDEF").find(digit);
      if (value == std::string_view::npos) return std::nullopt;
      level = 16 * level + static_cast<int>(value < 16 ? value : value - 6);
    }
    color[k] = static_cast<float>(level) / 255;
  }
  return color;
}

std::optional<Vec3f> color_of_word(std::string_view word) {
  for (const auto& [name, hex] : kColorWords)
    if (name == word) return color_of_hex(hex);
  return color_of_hex(word);
}

std::string color_words() {
  std::string known;
  for (const auto& color : kColorWords) known += (known.empty() ? "" : ", ") + std::string(color.first);
  return known;
}

std::string hex_of_color(const Vec3f& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", to_byte(color.x), to_byte(color.y), to_byte(color.z));
}

Vec3f ColorOption::from(const OptionValue& value) {
  const std::string& word = std::get<std::string>(value);
  const auto color = color_of_word(word);
  if (!color)
    throw ArgumentError(ArgumentFault{.field = {},
                                      .value = "'" + printable(word, 60) + "'",
                                      .allowed = "'#rrggbb' or a name such as blue",
                                      .remedy = {}});
  return *color;
}

}  // namespace sansmesh::inline v1
