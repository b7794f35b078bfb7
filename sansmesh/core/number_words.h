// Numbers formatted for messages.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// 1234567 → "1,234,567".
std::string grouped(std::uint64_t n);

/// "1 vertex", "3 vertices", "1,234 components".
std::string counted(std::uint64_t n, std::string_view noun);

/// Formats a length with four significant digits: "0.01234".
std::string length_words(double length);

/// Formats a point: "(1, 2, 3)".
std::string point_words(const Vec3& point, int digits = 6);
/// Formats edge lengths: "1.5 × 2 × 0.25".
std::string size_words(const Vec3& size);
/// "area 1.5, volume 2".
std::string area_words(double area, const std::optional<double>& volume);
/// Line of a summary: "area            0.5".
std::string titled(std::string_view title, std::string_view text, int width = 16);

}  // namespace sansmesh::inline v1
