// Numbers as words of a sentence.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace sansmesh::inline v1 {

/// 1234567 → "1,234,567".
std::string grouped(std::uint64_t n);

/// "1 component", "3 components", "1,234 components".
std::string counted(std::uint64_t n, std::string_view noun);

/// With four significant digits: "0.01234".
std::string length_words(double length);

}  // namespace sansmesh::inline v1
