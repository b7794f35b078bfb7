#include "sansmesh/core/option_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace sansmesh::inline v1 {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return upper;
}

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\f\v";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

std::vector<std::string> parts_between(std::string_view text, char between) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(between, at), text.size());
    parts.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

bool reads_as_number(std::string_view text, double& value) {
  const char *at = text.data(), *const end = at + text.size();
  if (at != end && *at == '+') ++at;
  if (at == end || (at != text.data() && *at == '-')) return false;
  const auto [next, error] = std::from_chars(at, end, value);
  if (error == std::errc::result_out_of_range) {  // 1e999, 1e-999: infinity or zero
    value = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos ? 0.0 : HUGE_VAL;
    if (text[0] == '-') value = -value;
    return next == end;
  }
  return error == std::errc() && next == end && !std::isnan(value);
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  if (!reads_as_number(without_blanks(text), value) || std::isinf(value)) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : between_commas(text)) {
    const std::optional<double> one = number_in(part);
    if (!one) return std::nullopt;
    numbers.push_back(*one);
  }
  return numbers;
}

std::optional<std::vector<double>> numbers_in(std::string_view text, std::size_t count) {
  auto numbers = numbers_in(text);
  if (numbers && numbers->size() != count) numbers.reset();
  return numbers;
}

std::optional<long long> whole_in(std::string_view text, long long least, long long most) {
  text = without_blanks(text);
  double value = 0;
  // 2^63 is not representable as long long; counts stay far below it.
  if (!reads_as_number(text, value) || std::isinf(value) || std::floor(value) != value ||
      value < static_cast<double>(least) || value > static_cast<double>(most) || std::abs(value) >= 9e18)
    return std::nullopt;
  long long whole = 0;
  const char* const first = text.data() + (text[0] == '+' ? 1 : 0);
  const auto [next, error] = std::from_chars(first, text.data() + text.size(), whole);
  return error == std::errc() && next == text.data() + text.size() ? whole : static_cast<long long>(value);
}

}  // namespace sansmesh::inline v1
