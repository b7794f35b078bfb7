#include "sansmesh/dynamics/length_unit.h"

#include <fmt/core.h>

#include <charconv>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::pair<std::string_view, double> kUnits[] = {{"mm", 1e-3}, {"cm", 1e-2},     {"dm", 0.1},     {"m", 1},
                                                          {"km", 1e3},  {"inch", 0.0254}, {"foot", 0.3048}};

}  // namespace

std::optional<double> metres_of(std::string_view unit) {
  for (const auto& [name, metres] : kUnits)
    if (name == unit) return metres;
  return std::nullopt;
}

std::string text_of_option(const LengthUnit& unit) {
  for (const auto& [name, metres] : kUnits)
    if (metres == unit.metres) return std::string(name);
  return fmt::format("{:.17g}", unit.metres);
}

void option_of_text(std::string_view word, LengthUnit& unit) {
  double metres = 0;
  if (const auto known = metres_of(word)) {
    metres = *known;
  } else {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), metres);
    if (error != std::errc() || end != word.data() + word.size() || !(metres >= kLeastUnit && metres <= kMostUnit))
      throw ArgumentError(ArgumentFault{.field = {},
                                        .value = "'" + printable(word, 60) + "'",
                                        .allowed = "mm, cm, dm, m, km, inch, foot, or its length in metres, 1e-9..1e9",
                                        .remedy = {}});
  }
  unit.metres = metres;
}

}  // namespace sansmesh::inline v1
