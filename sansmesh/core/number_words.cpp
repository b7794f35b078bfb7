#include "sansmesh/core/number_words.h"

#include <fmt/core.h>

namespace sansmesh::inline v1 {

std::string grouped(std::uint64_t n) {
  const std::string digits = std::to_string(n);
  std::string s;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) s += ',';
    s += digits[i];
  }
  return s;
}

std::string counted(std::uint64_t n, std::string_view noun) {
  return (grouped(n) + ' ').append(noun).append(n == 1 ? "" : "s");
}

std::string length_words(double length) { return fmt::format("{:.4g}", length); }

}  // namespace sansmesh::inline v1
