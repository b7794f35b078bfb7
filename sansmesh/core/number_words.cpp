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
  if (n != 1 && noun == "vertex") return grouped(n) + " vertices";
  return (grouped(n) + ' ').append(noun).append(n == 1 ? "" : "s");
}

std::string length_words(double length) { return fmt::format("{:.4g}", length); }

std::string point_words(const Vec3& p, int digits) {
  // Adding 0 turns -0 into 0.
  return fmt::format("({:.{}g}, {:.{}g}, {:.{}g})", p.x + 0.0, digits, p.y + 0.0, digits, p.z + 0.0, digits);
}

std::string size_words(const Vec3& size) {
  return fmt::format("{} × {} × {}", length_words(size.x), length_words(size.y), length_words(size.z));
}

std::string area_words(double area, const std::optional<double>& volume) {
  return volume ? fmt::format("area {:.6g}, volume {:.6g}", area, *volume) : fmt::format("area {:.6g}", area);
}

std::string titled(std::string_view title, std::string_view text, int width) {
  return fmt::format("{:<{}}{}", title, width, text);
}

}  // namespace sansmesh::inline v1
