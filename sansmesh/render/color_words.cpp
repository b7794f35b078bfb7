#include "sansmesh/render/color_words.h"

#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/data/image.h"
#include "sansmesh/render/color_space.h"

namespace sansmesh {
namespace {

constexpr std::pair<std::string_view, std::string_view> kColorWords[] = {
    {"red", "#d62828"},  {"orange", "#f08c1e"}, {"yellow", "#f2d21f"},  {"green", "#2f9e44"}, {"cyan", "#22b8cf"},
    {"blue", "#2f6fde"}, {"purple", "#8e4ec6"}, {"magenta", "#d6409f"}, {"brown", "#8d5a34"}, {"white", "#f5f5f5"},
    {"gray", "#8c9199"}, {"silver", "#c6cad0"}, {"black", "#22252a"}};

}  // namespace

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

}  // namespace sansmesh
