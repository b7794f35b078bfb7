// Named colours.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/option.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// sRGB 0..1 of "#rrggbb" with two hexadecimal digits per channel; empty for any other text.
std::optional<Vec3f> color_of_hex(std::string_view text);

/// The same of "#rrggbb" or a name (red, orange, …); empty for any other text.
std::optional<Vec3f> color_of_word(std::string_view word);
/// The names, separated by commas.
std::string color_words();
/// The nearest "#rrggbb".
std::string hex_of_color(const Vec3f& color);

/// Conversions of a colour option (sansmesh/option.h).
struct ColorOption {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const Vec3f& color) { return hex_of_color(color); }
  /// Throws ArgumentError.
  static Vec3f from(const OptionValue& value);
};

}  // namespace sansmesh::inline v1
