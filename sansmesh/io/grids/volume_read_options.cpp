#include "sansmesh/volume_read_options.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Numbers, or "none" to disable the usual ones.
struct FillOption {
  static constexpr auto kind = OptionKind::texts;
  static OptionValue get(const FillValueOptions& fill) {
    std::vector<std::string> words;
    if (!fill.usual) words.emplace_back("none");
    for (const double v : fill.values) words.push_back(fmt::format("{}", v));
    return words;
  }
  static FillValueOptions from(const OptionValue& value) {
    FillValueOptions fill;
    for (const std::string& word : std::get<std::vector<std::string>>(value)) {
      if (word == "none") {
        fill.usual = false;
        continue;
      }
      const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
      double number = 0;
      const auto [end, error] = std::from_chars(begin, word.data() + word.size(), number);
      if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number))
        throw ArgumentError(ArgumentFault{
            .field = {}, .value = "'" + printable(word, 60) + "'", .allowed = "a number, or none", .remedy = {}});
      fill.values.push_back(number);
    }
    return fill;
  }
};

}  // namespace

const OptionSchema& VolumeReadOptions::schema() {
  using O = VolumeReadOptions;
  static const OptionRow rows[] = {
      option_group<&O::raw>(RawLayout::schema().rows),
      option<&O::time_step>({.text = "Index of the time step, from 0", .unit = "number", .old_name = "step"}),
      option<&O::solution>({.text = "File of the values of a PLOT3D grid",
                            .unit = "file",
                            .from_data = "the file of that name beside it"}),
      option<&O::fill, FillOption>({.text =
                                        "Number that marks missing values, beside usual ones (9.96921e36, -9999, …) "
                                        "that are clearly separate; none: only numbers given here; may be repeated",
                                    .unit = "value",
                                    .name = "fill_value"}),
  };
  static const OptionSchema schema{rows};
  return schema;
}

void VolumeReadOptions::validate() const {
  validate_options(*this);
  fill.validate();
}

}  // namespace sansmesh::inline v1
