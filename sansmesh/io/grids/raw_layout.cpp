#include "sansmesh/volume_read_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// "256x256x128", or with commas.
struct SizeOption {
  using Sizes = std::array<std::size_t, 3>;
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const Sizes& n) {
    return n == Sizes{} ? std::string() : fmt::format("{}x{}x{}", n[0], n[1], n[2]);
  }
  static Sizes from(const OptionValue& value) {
    const auto& text = std::get<std::string>(value);
    std::string numbers = text;
    std::replace(numbers.begin(), numbers.end(), 'x', ',');
    const std::vector<std::string> words = between_commas(numbers);
    Sizes sizes{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = words.size() == 3 ? whole_in(words[k], 1, std::numeric_limits<long long>::max()) : std::nullopt;
      if (!n)
        throw ArgumentError(
            ArgumentFault{.field = {}, .value = text, .allowed = "three numbers such as 256x256x128", .remedy = {}});
      sizes[k] = static_cast<std::size_t>(*n);
    }
    return sizes;
  }
};

template <std::size_t... k>
constexpr std::array<std::string_view, sizeof...(k)> type_names(std::index_sequence<k...> /*all*/) {
  return {name_of(static_cast<NumberType>(k))...};
}

constexpr auto kTypeNames = type_names(std::make_index_sequence<static_cast<std::size_t>(NumberType::f64) + 1>());

}  // namespace

const OptionSchema& RawLayout::schema() {
  using O = RawLayout;
  static constexpr OptionRow rows[] = {
      option<&O::dims, SizeOption>(
          {.text = "Raw files: numbers of points along x, y and z, 256x256x128", .unit = "nx,ny,nz"}),
      option<&O::type>({.text = "Type of raw values: int8, uint8, int16, …, float, double",
                        .unit = "type",
                        .choices = kTypeNames,
                        .needs = "dims"}),
      option<&O::spacing>({.text = "Distances of raw values along x, y and z", .range = positive(), .needs = "dims"}),
      option<&O::big_endian>({.text = "Raw values are big endian", .needs = "dims"}),
      option<&O::components>({.text = "Adjacent numbers per point of raw files",
                              .range = at_least(1),
                              .name = "raw_components",
                              .needs = "dims"}),
      option<&O::header_bytes>(
          {.text = "Size of the header before raw values", .unit = "bytes", .range = at_least(0), .needs = "dims"}),
  };
  static constexpr OptionSchema schema{rows};
  return schema;
}

}  // namespace sansmesh::inline v1
