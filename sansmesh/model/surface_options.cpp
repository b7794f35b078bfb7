#include "sansmesh/surface_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Orders of the approximation as words.
struct OrderWords {
  static constexpr auto kind = OptionKind::choice;
  static OptionValue get(int order) { return static_cast<std::int64_t>(order % 2 == 0 ? order / 2 - 1 : -1); }
  static int from(const OptionValue& value) { return 2 * (static_cast<int>(std::get<std::int64_t>(value)) + 1); }
};

/// Polynomials, whose enumerators begin at 1, as words.
struct PolynomialWords {
  using Polynomial = SurfaceOptions::Polynomial;
  static constexpr auto kind = OptionKind::choice;
  static OptionValue get(Polynomial p) { return static_cast<std::int64_t>(p) - 1; }
  static Polynomial from(const OptionValue& value) {
    return static_cast<Polynomial>(std::get<std::int64_t>(value) + 1);
  }
};

constexpr std::string_view kSharp[] = {"bilateral", "laguerre"};
constexpr std::string_view kWeights[] = {"compact", "gaussian"};
constexpr std::string_view kOrders[] = {"2", "4", "6"};
constexpr std::string_view kNormals[] = {"standard", "covariance", "iterated"};
constexpr std::string_view kPlanes[] = {"iterated", "nonlinear"};
constexpr std::string_view kPolynomials[] = {"1", "2", "3", "4", "incomplete"};
constexpr std::string_view kFlows[] = {"fit", "normal", "free"};
constexpr std::string_view kDiffusions[] = {"none", "soft", "hard"};

constexpr OptionRow kRows[] = {
    option<&SurfaceOptions::method>({.text = "Surface method"}),
    option<&SurfaceOptions::sharp>({.text = "Sharp edges and corners: normals by bilateral or laguerre weights",
                                    .choices = kSharp,
                                    .implied = "bilateral"}),
    option<&SurfaceOptions::smoothing>({.text = "Width of the weights over the spacing of the samples",
                                        .unit = "ratio",
                                        .from_data = "from data",
                                        .range = {0.5, 20}}),
    option<&SurfaceOptions::bandwidth>(
        {.text = "Width of the weights as a length, instead of `smoothing`", .unit = "length", .range = positive()}),
    option<&SurfaceOptions::weights>(
        {.text = "compact: width from the local spacing; gaussian: exp(-d^2/h^2) with one h for the cloud",
         .choices = kWeights}),
    option<&SurfaceOptions::order, OrderWords>(
        {.text = "Order of the approximation", .unit = "order", .from_data = "from data", .choices = kOrders}),
    option<&SurfaceOptions::iterations>(
        {.text = "Iterations: 0 smooths most, many interpolate", .from_data = "from data", .range = {0, 100}}),
    option<&SurfaceOptions::epsilon>(
        {.text = "Shape parameter, in addition to the width", .from_data = "1", .range = {0.05, 20}}),
    option<&SurfaceOptions::normal>({.text = "covariance (adamson): direction of least weighted covariance; iterated "
                                             "(amls): normals approximated like the values",
                                     .choices = kNormals}),
    option<&SurfaceOptions::reference_plane>(
        {.text = "Reference plane by weights about its own foot, six iterations, or by nonlinear minimisation",
         .choices = kPlanes,
         .old_name = "plane"}),
    option<&SurfaceOptions::polynomial, PolynomialWords>(
        {.text = "Degree of the polynomial over the plane, or incomplete: x^2, y^2, xy, 1",
         .unit = "degree",
         .choices = kPolynomials}),
    option<&SurfaceOptions::flow>(
        {.text =
             "Projection by the fit, or by diffusion to its fixed point: along the normal, or free (slow, no pictures)",
         .choices = kFlows}),
    option<&SurfaceOptions::diffusion>({.text = "Reduced weight of samples off the surface", .choices = kDiffusions}),
    option<&SurfaceOptions::diffusion_threshold>(
        {.text = "Curvature above which `diffusion` acts, over that of the width",
         .from_data = "1",
         .range = positive(),
         .needs = "diffusion",
         .old_name = "threshold"}),
    option<&SurfaceOptions::tau>(
        {.text = "Exponent of the M-like weights", .unit = "exponent", .from_data = "2", .range = {1, 3}}),
    option<&SurfaceOptions::separate_sheets>(
        {.text = "Use also samples on the other side of a thin part", .negative = "no_sheets"}),
    option<&SurfaceOptions::error>({.text = "Accepted distance of samples from their cell's function",
                                    .unit = "length",
                                    .from_data = "from data",
                                    .range = positive()}),
    option<&SurfaceOptions::depth>({.text = "Deepest level of the octree",
                                    .unit = "level",
                                    .from_data = "14",
                                    .range = {kLeastDepth, kMostDepth}}),
    option<&SurfaceOptions::smooth>({.text = "Do not detect edges and corners"})};

/// Options of all surfaces, followed by those of single methods.
std::vector<OptionRow> all_rows() {
  std::vector<OptionRow> rows(std::begin(kRows), std::end(kRows));
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all()) {
    std::string beginning = std::string(method->name) + "_";
    std::replace(beginning.begin(), beginning.end(), '-', '_');
    for (const OptionRow& own : method->own) {
      if (!own.name.starts_with(beginning))
        throw ArgumentError(
            fmt::format("`{}` of the surface {} must be called `{}…`", own.name, method->name, beginning));
      if (std::any_of(rows.begin(), rows.end(), [&](const OptionRow& row) { return row.name == own.name; }))
        throw ArgumentError(fmt::format("there is an option `{}` already", own.name));
      rows.push_back(own);
    }
  }
  return rows;
}

/// Throws ArgumentError for names in `own` that are no options of single methods.
void check_names(const SurfaceOptions& options) {
  const auto rows = SurfaceOptions::schema().rows.subspan(std::size(kRows));
  for (const auto& [name, value] : options.own)
    if (std::none_of(rows.begin(), rows.end(), [&](const OptionRow& row) { return row.name == name; }))
      throw ArgumentError(fmt::format("no surface method has an option `{}` of its own", name));
}

}  // namespace

const OptionSchema& SurfaceOptions::schema() {
  static const std::vector<OptionRow> rows = all_rows();
  static const OptionSchema schema{rows};
  return schema;
}

void SurfaceOptions::validate() const {
  const SurfaceMethod& used = surface_method(method);
  check_names(*this);
  for (const std::string_view option : options_set(*this)) {
    if (option == "method" || used.uses_option(option)) continue;
    throw ArgumentError(
        used.instead.empty()
            ? fmt::format("`{}` belongs to {}, not to the surface {}", option, surfaces_that_use(option), used.name)
            : fmt::format("`{}` means nothing to the surface {}: {}", option, used.name, used.instead));
  }
  validate_options(*this);
  if (used.check) used.check(*this);
}

}  // namespace sansmesh::inline v1
