#include "sansmesh/fit_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kFits[] = {"partition", "paper"};

struct NamedCoverage {
  std::string_view word;
  PaperCoverage coverage;
};
constexpr NamedCoverage kCoverages[] = {{"thesis", kThesisCoverage}, {"paper", kPaperCoverage}, {"none", kNoCoverage}};
constexpr std::string_view kCoverageWords[] = {"thesis", "paper", "none"};

/// Least coverage by samples: a word, or three comma-separated numbers.
struct CoverageWords {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const PaperCoverage& coverage) {
    for (const NamedCoverage& named : kCoverages)
      if (named.coverage == coverage) return std::string(named.word);
    return fmt::format("{}", fmt::join(coverage, ","));
  }
  static PaperCoverage from(const OptionValue& value) {
    const auto& text = std::get<std::string>(value);
    for (const NamedCoverage& named : kCoverages)
      if (named.word == text) return named.coverage;
    const auto numbers = numbers_in(text, std::tuple_size_v<PaperCoverage>);
    if (!numbers)
      throw ArgumentError(ArgumentFault{.field = {},
                                        .value = "'" + printable(text, 60) + "'",
                                        .allowed = "thesis, paper, none or three numbers with commas between them",
                                        .remedy = {}});
    PaperCoverage coverage{};
    std::copy(numbers->begin(), numbers->end(), coverage.begin());
    return coverage;
  }
};

constexpr OptionRow kRows[] = {
    option<&FitOptions::fit>(
        {.text = "This library's partition of unity, or the published one (paper and thesis)", .choices = kFits}),
    option<&FitOptions::threshold>(
        {.text = "With `fit = paper`: accepted rms error of a local fit over the diagonal of the samples",
         .unit = "ratio",
         .from_data = "0.002",
         .range = positive()}),
    option<&FitOptions::coverage, CoverageWords>(
        {.text = "With `fit = paper`: share of a support that samples have to cover for degrees 2, 3 and 4: thesis "
                 "(.4,.8,.85), paper (.85,.9,.95), none or three numbers",
         .from_data = "thesis",
         .suggestions = kCoverageWords}),
    option<&FitOptions::depth>({.text = "Deepest level of the tree of blocks",
                                .unit = "level",
                                .from_data = "from data; 9 with `fit = paper`",
                                .range = {kLeastDepth, kMostDepth}}),
    option<&FitOptions::error>({.text = "Accepted rms error of a local fit (mpu: largest distance of a sample)",
                                .unit = "length",
                                .from_data = "from the noise",
                                .range = positive()}),
    option<&FitOptions::support>({.text = "Radius of a support over the radius of its block",
                                  .unit = "ratio",
                                  .from_data = "1.5, up to 2.5 with noise",
                                  .range = {1.1, 2}}),
    option<&FitOptions::degree>({.text = "Largest degree of the local polynomials", .unit = "degree", .range = {1, 4}}),
    option<&FitOptions::open>(
        {.text = "The surface bounds no solid: it ends where the samples end",
         .from_data = "from data",
         .negative = "closed",
         .negative_text =
             "The surface is closed, also where there are no samples (other surfaces: but for wide holes)"}),
    option<&FitOptions::sharp>({.text = "Do not look for creases and corners", .negative = "smooth"})};
constexpr OptionSchema kSchema{kRows};

}  // namespace

const OptionSchema& FitOptions::schema() { return kSchema; }

void FitOptions::validate() const {
  const auto unset = [&](bool ok, const char* field) {
    if (!ok) throw ArgumentError(fmt::format("`{}` belongs to `fit = {}`", field, is_paper() ? "partition" : "paper"));
  };
  validate_options(*this);
  if (is_paper()) {
    unset(!error, "error");
    unset(sharp, "sharp = false");
    unset(!open, open.value_or(false) ? "open = true" : "open = false");
  } else {
    unset(!threshold, "threshold");
    unset(!coverage, "coverage");
  }
  if (coverage)
    for (const double k : *coverage)
      if (!(k >= 0 && k <= 2)) throw ArgumentError("`coverage` must lie in 0..2 for each degree");
}

}  // namespace sansmesh::inline v1
