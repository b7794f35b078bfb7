#include "cli/line/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/line/suggestions.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
std::string in_quotes(const std::string& word) { return "'" + printable(word, 60) + "'"; }

ValueError must_be(const std::string& form, const std::string& text) {
  return ValueError(fmt::format("must be {}, not {}", form, in_quotes(text)));
}

double parse_real(const std::string& word) {
  double value = 0;
  if (!reads_as_number(word, value))
    throw ValueError(word == "nan" ? "must be finite, not nan" : in_quotes(word) + " is not a number");
  return value;
}

long long parse_whole(const std::string& word, long long least, long long most) {
  double value = 0;
  if (!reads_as_number(word, value)) throw ValueError(in_quotes(word) + " is not a number");
  if (std::isinf(value) || std::floor(value) != value) throw ValueError(in_quotes(word) + " is not a whole number");
  // 2^63 is not exact in long long; no count reaches it.
  if (value < static_cast<double>(least) || value > static_cast<double>(most) || std::abs(value) >= 9e18) {
    const bool below = value < static_cast<double>(least);
    throw ValueError(below && least == 0 ? "must be 0 or more, not " + word
                     : below             ? fmt::format("must be at least {}, not {}", least, word)
                                         : fmt::format("{} is too large", word));
  }
  return *whole_in(word, least, most);
}

bool are_numbers(const std::string& word) {
  const std::vector<std::string> parts = between_commas(word);
  double value = 0;
  return std::all_of(parts.begin(), parts.end(), [&](const std::string& part) { return reads_as_number(part, value); });
}

std::string number_hint(const OptionEntry& o, const std::string& word) {
  double value = 0;
  std::string digits = word;
  digits.erase(std::remove(digits.begin(), digits.end(), ','), digits.end());
  // Groups of three digits; with several numbers a comma separates these.
  bool grouped = o.numbers == 0 && reads_as_number(digits, value);
  for (std::size_t at = word.find(','); grouped && at != std::string::npos; at = word.find(',', at + 1)) {
    std::size_t end = at + 1;
    while (end < word.size() && word[end] >= '0' && word[end] <= '9') ++end;
    grouped = at > 0 && end == at + 4;
  }
  if (grouped) return ": write " + digits;
  // A number followed by a unit, in any of the parts.
  for (const std::string& part : between_commas(word)) {
    const std::size_t number = std::min(part.find_first_not_of("+-.0123456789"), part.size());
    if (number > 0 && number < part.size() && reads_as_number(part.substr(0, number), value)) {
      const char* const plural = o.numbers > 0 ? ": write plain numbers" : ": write a plain number";
      const std::string& of = o.value_name;
      const bool length = of == "LENGTH" || of == "POINT" || of == "BOX" || of == "X,Y,Z";
      return plural + std::string(length            ? ", in the unit of the input"
                                  : of == "DEGREES" ? ", in degrees"
                                  : of == "PIXELS"  ? ", in pixels"
                                                    : "");
    }
  }
  return "";
}

void check_value(const OptionEntry& o, const std::string& word) {
  if (!o.words.empty()) {
    if (std::find(o.words.begin(), o.words.end(), word) != o.words.end()) return;
    throw ValueError(fmt::format("must be one of {}, not {}{}", fmt::join(o.words, ", "), in_quotes(word),
                                 did_you_mean(word, o.words)));
  }
  if (o.kind != OptionEntry::Kind::whole && o.kind != OptionEntry::Kind::real) return;
  const double value = parse_real(word);
  if (o.kind == OptionEntry::Kind::whole && (std::isinf(value) || std::floor(value) != value))
    throw ValueError(in_quotes(word) + " is not a whole number");
  const std::optional<OptionRange>& taken = o.range;
  if (!taken || taken->holds(value)) return;
  const bool closed = !taken->above && !taken->below && std::isfinite(taken->most);
  throw ValueError(fmt::format("must {} {}, not {}", closed ? "lie in" : "be", taken->words(), word));
}

}  // namespace sansmesh::cli
