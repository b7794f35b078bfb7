#include "sansmesh/io/grids/fill_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kChunk = 1 << 16;
/// No usual fill value is closer to 0: most numbers are rejected by one comparison.
constexpr double kLeastFill = 999;
/// Larger fill values are recognised by their first digits, because text files round them.
constexpr double kHuge = 1e19, kDigits = 1e-5;
constexpr std::array kHugeFills{9.969209968386869e36, 9.97e36, 3.4028234663852886e38, 3.4e38, 1.7976931348623157e308,
                                1.70141e38,           9.999e20};
/// Powers of ten are also measured quantities: densities of plasmas, viscosities of mantles. One is a fill value only
/// if it is the only one, and this factor larger than all other numbers, which must not all be 0.
constexpr int kFirstPower = 20, kLastPower = 38;
constexpr double kPowerIsLarger = 1e10;
constexpr std::array kPlainFills{-999.0, -999.25, -9999.0, -99999.0, -999999.0, -9.99e8};
/// Largest number of values used to estimate the range of the rest, and their least number.
constexpr std::size_t kLooked = 200'000, kLeastRest = 4;
constexpr double kLeftOut = 0.005;  // at each end
/// Least distance of a fill value from the rest, in ranges of the rest, if it occurs once, a few times, or often.
constexpr double kOnceApart = 2, kTwiceApart = 1, kOftenApart = 0.4;
constexpr std::size_t kOften = 10;

/// The power of ten that equals a number up to sign and rounding; 0 if it is none of the usual ones.
double usual_power(double size) {
  const double exponent = std::round(std::log10(size)), power = std::pow(10.0, exponent);
  return exponent >= kFirstPower && exponent <= kLastPower && std::abs(size / power - 1) <= kDigits ? power : 0;
}

/// The usual fill value that equals a number; 0 if there is none.
double usual_fill(double v) {
  const double size = std::abs(v);
  if (!(size >= kLeastFill)) return 0;
  if (size < kHuge) {
    for (const double f : kPlainFills)
      if (v == f) return f;
    return 0;
  }
  if (!std::isfinite(v)) return 0;
  const auto near = [&](double f) { return std::abs(size / f - 1) <= kDigits; };
  for (const double f : kHugeFills)
    if (near(f)) return std::copysign(f, v);
  if (v < 0 && near(9.99e33)) return -9.99e33;
  if (const double power = usual_power(size); power > 0) return std::copysign(power, v);
  return 0;
}

/// `fill`: a usual fill value.
bool is_power_of_ten(double fill) {
  const double size = std::abs(fill);
  return size >= kHuge && usual_power(size) == size;
}

/// NetCDF's default fill values of integers, and the least integers, which other programs use.
template <class T>
double least_integer(T v) {
  if constexpr (std::is_integral_v<T> && std::is_signed_v<T> && sizeof(T) >= 2)
    if (v <= std::numeric_limits<T>::min() + (sizeof(T) == 8 ? 2 : 1)) return static_cast<double>(v);
  return 0;
}

/// The arrays of one name and kind in all blocks.
struct ArrayParts {
  std::string name;
  bool of_cells = false;
  std::size_t components = 1;
  std::vector<std::size_t> blocks;
};

const AttributeTable& table_of(const GridBlock& b, bool of_cells) { return of_cells ? b.cell_arrays : b.point_arrays; }

std::vector<ArrayParts> array_parts(const GridData& data) {
  std::vector<ArrayParts> all;
  for (std::size_t b = 0; b < data.blocks.size(); ++b)
    for (const bool of_cells : {false, true})
      for (const Attribute& a : table_of(data.blocks[b], of_cells)) {
        const auto same = [&](const ArrayParts& p) {
          return p.name == a.name && p.of_cells == of_cells && p.components == a.components;
        };
        auto found = std::find_if(all.begin(), all.end(), same);
        if (found == all.end()) found = all.insert(all.end(), {a.name, of_cells, a.components, {}});
        found->blocks.push_back(b);
      }
  return all;
}

/// A possible fill value of an array.
struct Candidate {
  double value = 0;
  std::size_t component = 0;
  std::size_t count = 0;
  bool asked = false;  ///< requested by the user: accepted at any distance from the rest
};

class Searcher {
 public:
  Searcher(const GridData& data, const FillValueOptions& options) : data_(data), options_(options) {}

  /// The fill values of an array. `doubtful`: candidates that are not far enough from the rest.
  std::vector<Candidate> search(const ArrayParts& parts, std::vector<Candidate>& doubtful) const {
    std::vector<Candidate> all = candidates(parts);
    std::vector<Candidate> found;
    for (const Candidate& c : all) {
      const bool one_of_many = is_power_of_ten(c.value) && std::any_of(all.begin(), all.end(), [&](const Candidate& o) {
                                 return o.component == c.component && o.value != c.value && is_power_of_ten(o.value);
                               });
      const Standing standing = c.asked ? Standing::apart : one_of_many ? Standing::among : standing_of(parts, c);
      if (standing == Standing::apart) found.push_back(c);
      if (standing == Standing::near) doubtful.push_back(c);
    }
    return found;
  }

  /// The fill value that equals a number; 0 for others. −0 represents the number 0.
  template <class T>
  double fill_of(T v, bool& asked) const {
    asked = false;
    const auto number = static_cast<double>(v);
    for (const double f : options_.values)
      if (number == f || (std::is_same_v<T, float> && number == static_cast<double>(static_cast<float>(f))) ||
          (std::abs(f) >= kHuge && std::abs(number / f - 1) <= kDigits)) {
        asked = true;
        return f;
      }
    if (!options_.usual || sizeof(T) == 1) return 0;
    const double fill = usual_fill(number);
    return fill != 0 ? fill : least_integer(v);
  }

 private:
  /// Position of a number relative to all others: separate, isolated but too close, or among them.
  enum class Standing : std::uint8_t { apart, near, among };

  template <class Use>
  void for_each_part(const ArrayParts& parts, const Use& use) const {
    for (const std::size_t b : parts.blocks) {
      const GridBlock& block = data_.blocks[b];
      const Attribute& a = *table_of(block, parts.of_cells).find(parts.name);
      const std::vector<std::uint8_t>& hidden = parts.of_cells ? block.hidden_cells : block.hidden_points;
      const auto seen = [&hidden, n = a.components](std::size_t i) {
        return i / n >= hidden.size() || hidden[i / n] == 0;
      };
      std::visit([&](const auto& numbers) { use(numbers, seen); }, a.values);
    }
  }

  std::vector<Candidate> candidates(const ArrayParts& parts) const {
    std::vector<Candidate> all;
    const auto add = [](std::vector<Candidate>& list, const Candidate& c) {
      for (Candidate& known : list)
        if (known.value == c.value && known.component == c.component && known.asked == c.asked) {
          known.count += c.count;
          return;
        }
      list.push_back(c);
    };
    for_each_part(parts, [&](const auto& numbers, const auto& seen) {
      using T = typename std::decay_t<decltype(numbers)>::value_type;
      if (sizeof(T) == 1 && options_.values.empty()) return;
      const auto found = parallel_reduce(
          numbers.size(), kChunk, std::vector<Candidate>(),
          [&](std::size_t first, std::size_t last) {
            std::vector<Candidate> own;
            for (std::size_t i = first; i < last; ++i) {
              bool asked = false;
              const double fill = fill_of(numbers[i], asked);
              if ((fill != 0 || asked) && seen(i)) add(own, {fill, i % parts.components, 1, asked});
            }
            return own;
          },
          [&](std::vector<Candidate> a, const std::vector<Candidate>& b) {
            for (const Candidate& c : b) add(a, c);
            return a;
          });
      for (const Candidate& c : found) add(all, c);
    });
    return all;
  }

  /// Calls use(v) with the finite numbers of a component that are no usual fill value, from one random row per
  /// `stride`: a fixed step would follow the rows of the grid.
  template <class Use>
  void for_each_other(const ArrayParts& parts, std::size_t component, std::size_t stride, const Use& use) const {
    for_each_part(parts, [&](const auto& numbers, const auto& seen) {
      const std::size_t rows = numbers.size() / parts.components;
      for (std::size_t first = 0; first < rows; first += stride) {
        const std::size_t row = first + (stride > 1 ? scrambled(first) % stride : 0);
        if (row >= rows) continue;
        const std::size_t i = row * parts.components + component;
        const auto v = static_cast<double>(numbers[i]);
        bool asked = false;
        if (std::isfinite(v) && seen(i) && fill_of(numbers[i], asked) == 0 && !asked) use(v);
      }
    });
  }

  Standing standing_of(const ArrayParts& parts, const Candidate& c) const {
    std::size_t rows = 0;
    for_each_part(parts, [&](const auto& numbers, const auto&) { rows += numbers.size() / parts.components; });
    std::vector<double> rest;
    for_each_other(parts, c.component, 1 + rows / kLooked, [&](double v) { rest.push_back(v); });
    if (rest.size() < kLeastRest) return Standing::among;
    std::sort(rest.begin(), rest.end());
    // No single number decides: among ten or more one at each end is ignored.
    const std::size_t cut = std::max(static_cast<std::size_t>(kLeftOut * static_cast<double>(rest.size())),
                                     static_cast<std::size_t>(rest.size() >= 10));
    const double low = rest[cut], high = rest[rest.size() - 1 - cut];
    const double away = std::max(low - c.value, c.value - high), spread = high - low;
    if (!(away > 0)) return Standing::among;
    const double largest = std::max(std::abs(low), std::abs(high));
    if (is_power_of_ten(c.value) && !(largest > 0 && std::abs(c.value) >= kPowerIsLarger * largest))
      return Standing::among;
    std::size_t around = 0;
    for_each_other(parts, c.component, 1, [&](double v) { around += std::abs(v - c.value) < 0.5 * away; });
    if (around > c.count / 100) return Standing::among;
    const bool often = c.count >= kOften;
    if (away >= (often ? kOftenApart : c.count > 1 ? kTwiceApart : kOnceApart) * spread) return Standing::apart;
    return often ? Standing::near : Standing::among;
  }

  const GridData& data_;
  const FillValueOptions& options_;
};

/// The array with NaN in all rows with a fill value; counts the visible ones of each in the order of `fills`.
Attribute without_fills(const Attribute& a, const std::vector<std::uint8_t>& hidden, const Searcher& searcher,
                        const std::vector<Candidate>& fills, std::vector<std::size_t>& rows) {
  const std::size_t n = a.components;
  return std::visit(
      [&](const auto& numbers) -> Attribute {
        using T = typename std::decay_t<decltype(numbers)>::value_type;
        using Real =
            std::conditional_t<std::is_same_v<T, float> || (std::is_integral_v<T> && sizeof(T) <= 2), float, double>;
        std::vector<Real> reals(numbers.begin(), numbers.end());
        for (std::size_t row = 0; row < a.rows(); ++row) {
          std::size_t which = fills.size();
          for (std::size_t c = 0; c < n && which == fills.size(); ++c) {
            bool asked = false;
            const double fill = searcher.fill_of(numbers[row * n + c], asked);
            if (fill == 0 && !asked) continue;
            for (std::size_t k = 0; k < fills.size() && which == fills.size(); ++k)
              if (fills[k].value == fill && fills[k].component == c && fills[k].asked == asked) which = k;
          }
          if (which == fills.size()) continue;
          std::fill_n(reals.begin() + static_cast<std::ptrdiff_t>(row * n), n, std::numeric_limits<Real>::quiet_NaN());
          rows[which] += row >= hidden.size() || hidden[row] == 0;
        }
        return {a.name, std::move(reals), n};
      },
      a.values);
}

/// Arrays in which a fill value occurs, as text.
struct Occurrence {
  double value = 0;
  bool asked = false;
  std::vector<std::string> where;
};

std::string line_of(const Occurrence& o) {
  constexpr std::size_t kNamed = 4;
  std::string where;
  for (std::size_t k = 0; k < std::min(o.where.size(), kNamed); ++k) where += (k > 0 ? ", " : "") + o.where[k];
  if (o.where.size() > kNamed) where += fmt::format(" and {}", counted(o.where.size() - kNamed, "other array"));
  if (o.asked) return fmt::format("{:.6g} counts as missing: {}", o.value, where);
  return fmt::format("{:.6g} is a usual fill value and counts as missing: {} (`fill_value = none` keeps it)", o.value,
                     where);
}

}  // namespace

void FillValueOptions::validate() const {
  for (const double v : values)
    if (!std::isfinite(v))
      throw ArgumentError("`fill_value` must be finite: non-finite numbers always count as missing");
}

std::vector<std::string> mark_fill_values(GridData& data, const FillValueOptions& options) {
  options.validate();
  if (!options.usual && options.values.empty()) return {};
  std::vector<Occurrence> occurrences;
  std::vector<std::string> doubts;
  for (const ArrayParts& parts : array_parts(data)) {
    const Searcher searcher(data, options);
    std::vector<Candidate> doubtful;
    const std::vector<Candidate> fills = searcher.search(parts, doubtful);
    for (const Candidate& c : doubtful)
      doubts.push_back(fmt::format("{:.6g} occurs {} times in {} and may mark missing values: then set `fill_value`",
                                   c.value, grouped(c.count), printable(parts.name, 60)));
    if (fills.empty()) continue;
    std::vector<std::size_t> rows(fills.size(), 0);
    std::size_t all = 0;
    for (const std::size_t b : parts.blocks) {
      GridBlock& block = data.blocks[b];
      AttributeTable& table = parts.of_cells ? block.cell_arrays : block.point_arrays;
      Attribute marked = without_fills(
          *table.find(parts.name), parts.of_cells ? block.hidden_cells : block.hidden_points, searcher, fills, rows);
      all += marked.rows();
      table.set(std::move(marked));
    }
    for (std::size_t k = 0; k < fills.size(); ++k) {
      // Several components share one line.
      std::size_t count = 0;
      bool reported_before = false;
      for (std::size_t m = 0; m < fills.size(); ++m) {
        if (fills[m].value != fills[k].value || fills[m].asked != fills[k].asked) continue;
        reported_before = reported_before || m < k;
        count += rows[m];
      }
      if (reported_before) continue;
      auto of = std::find_if(occurrences.begin(), occurrences.end(), [&](const Occurrence& o) {
        return o.value == fills[k].value && o.asked == fills[k].asked;
      });
      if (of == occurrences.end()) of = occurrences.insert(of, {fills[k].value, fills[k].asked, {}});
      of->where.push_back(
          fmt::format("{} of {} of {}", grouped(count), counted(all, "value"), printable(parts.name, 60)));
    }
  }
  std::vector<std::string> lines;
  lines.reserve(occurrences.size());
  for (const Occurrence& o : occurrences) lines.push_back(line_of(o));
  lines.insert(lines.end(), doubts.begin(), doubts.end());
  for (const double v : options.values)
    if (std::none_of(occurrences.begin(), occurrences.end(),
                     [&](const Occurrence& o) { return o.asked && o.value == v; }))
      lines.push_back(fmt::format("`fill_value`: no array has the value {:.6g}", v));
  return lines;
}

}  // namespace sansmesh::inline v1
