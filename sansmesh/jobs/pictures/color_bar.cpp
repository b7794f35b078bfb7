#include "sansmesh/jobs/pictures/color_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/core/diverging_color.h"
#include "sansmesh/error.h"
#include "sansmesh/points/statistics/sample_confidence.h"
#include "sansmesh/render/volume/transfer_presets.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kBarSteps = 16;       // colour samples per half of the bar
constexpr double kRare = 0.01;      // share of the values clipped at each end of the bar
constexpr double kWithSign = 0.05;  // share of the larger side that makes the smaller side significant
constexpr int kLeastBeside = 100;   // least width of the picture beside a bar or legend, pixels
constexpr Vec3f kUnknown{0.55f, 0.55f, 0.55f};

TransferFunction colors_over(double lower, double upper, Vec3f (*color)(float)) {
  TransferFunction f;
  for (int k = 0; k <= 2 * kBarSteps; ++k) {
    const double t = k / (2.0 * kBarSteps);
    f.colors.push_back({lower + t * (upper - lower), color(static_cast<float>(t))});
  }
  f.opacities = {{lower, 1}, {upper, 1}};
  return f;
}

}  // namespace

ColorBar curvature_bar(CurvatureQuantity quantity, double range, const std::string& unit, bool beyond) {
  ColorBar bar;
  if (!(range > 0)) range = 1;  // all is flat
  bar.colors = colors_over(-range, range, [](float t) { return diverging_color(2 * t - 1); });
  const bool gaussian = quantity == CurvatureQuantity::gaussian;
  const std::string word = quantity_word(quantity);
  bar.title = with_unit(gaussian || quantity == CurvatureQuantity::mean ? word + " curvature" : "curvature " + word,
                        unit.empty() ? "" : "1/" + unit + (gaussian ? "²" : ""));
  bar.ends = {beyond, beyond};
  return bar;
}

ColorBar confidence_bar() {
  return {colors_over(0, 1, [](float t) { return confidence_color(t); }), "confidence", {}};
}

std::vector<double> sizes_of(const Attribute& a) {
  std::vector<double> values(a.rows());
  for (std::size_t i = 0; i < values.size(); ++i) {
    double square = 0;
    for (std::size_t c = 0; c < a.components; ++c)
      square += a.number(i * a.components + c) * a.number(i * a.components + c);
    values[i] = a.components == 1 ? a.number(i) : std::sqrt(square);
  }
  return values;
}

ColorBar color_by_attribute(TriangleMesh& mesh, const std::string& name,
                            const std::optional<std::pair<double, double>>& range, const std::string& unit) {
  const Attribute* const found = mesh.attributes.find(name);
  if (!found) {
    std::vector<std::string> names;
    for (const Attribute& a : mesh.attributes) names.push_back(a.name);
    throw DataError(fmt::format("has no attribute {}: there is {}", printable(name, 40),
                                names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  const std::size_t n = mesh.vertices.size(), components = found->components;
  const std::vector<double> values = sizes_of(*found);
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double v) { return std::isfinite(v); });
  if (known.empty()) throw DataError(fmt::format("{} has no finite value", name));
  std::sort(known.begin(), known.end());
  ValueHistogram over;
  bool signs = false;
  if (range) {
    over.lower = range->first, over.upper = range->second;
    signs = over.lower == -over.upper;
  } else {
    const auto rare = static_cast<std::size_t>(kRare * static_cast<double>(known.size() - 1));
    over.lower = known[rare], over.upper = known[known.size() - 1 - rare];
    const double most = std::max(-over.lower, over.upper);
    signs = over.lower < 0 && over.upper > 0 && std::min(-over.lower, over.upper) > kWithSign * most;
    if (signs) over.lower = -most, over.upper = most;
  }
  if (!(over.upper > over.lower)) {  // one value
    const double around = over.lower != 0 ? 1e-3 * std::abs(over.lower) : 1;
    over.lower -= around, over.upper += around;
  }
  ColorBar bar;
  bar.colors = transfer_function_preset(signs ? "diverging" : "flow", over);
  bar.title = with_unit(name + (components > 1 ? " (magnitude)" : ""), unit);
  bar.ends = {known.front() < over.lower, known.back() > over.upper};
  mesh.colors.resize(n);
  for (std::size_t v = 0; v < n; ++v)
    mesh.colors[v] = to_bytes(std::isfinite(values[v]) ? bar.colors.color(values[v]) : kUnknown);
  return bar;
}

void check_room_beside(const RenderOptions& picture, const ColorBar& bar, std::string_view what) {
  const int width = bar.width(picture.view.height);
  if (width > 0 && picture.view.width < width + kLeastBeside)
    throw ArgumentError(fmt::format("`width = {}` is too narrow: a picture {} high needs {} or more with its {}",
                                    picture.view.width, picture.view.height, width + kLeastBeside, what));
}

void reserve_width(RenderOptions& options, int width, std::string_view what, std::string_view option) {
  if (width > 0 && options.view.width < width + kLeastBeside)
    throw ArgumentError(fmt::format("`width = {}` is too narrow: {} of it are for {} (omitted by `{} = false`)",
                                    options.view.width, width, what, option));
  options.view.width -= width;
}

void reserve_width(RenderOptions& options, const std::optional<ColorBar>& bar) {
  if (bar) reserve_width(options, bar->width(options.view.height), "the colour bar", "bar");
}

Image beside_bar(const Image& image, const std::optional<ColorBar>& bar, const RenderOptions& picture) {
  if (!bar) return image;
  const Image paper = annotation_background(picture);
  return with_color_bar(image, bar->colors, bar->title, bar->marks, &paper, bar->ends);
}

}  // namespace sansmesh::inline v1
