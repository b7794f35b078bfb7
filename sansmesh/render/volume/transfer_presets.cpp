#include "sansmesh/render/volume/transfer_presets.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "sansmesh/core/diverging_color.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_space.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::array<std::string_view, 6> kPresets{"ct-bone", "ct-soft-tissue", "mr", "flow", "diverging", "gray"};
constexpr int kKnots = 17;
constexpr double kReference = 0.02;  // default reference length, in diagonals of the volume
// Optical depth of a ray across the volume, and its length in a cube, in reference lengths.
constexpr double kDepth = 1.4, kAcross = 1 / (1.7320508 * kReference);
constexpr double kVeil = 0.25;  // optical depth of the surface of a translucent body

/// From dark violet over teal to light yellow; lightness, which the eye reads as quantity, rises uniformly.
std::vector<ColorPoint> flow_colors(double lower, double upper) {
  std::vector<ColorPoint> colors;
  for (int i = 0; i < kKnots; ++i) {
    const double t = i / (kKnots - 1.0);
    const double chroma = 0.1 + 0.04 * t * t;  // within sRGB at all of these hues
    colors.push_back({lower + t * (upper - lower), srgb_of_oklch(0.28 + 0.64 * t, chroma, 300 - 195 * t)});
  }
  return colors;
}

std::vector<ColorPoint> diverging_colors(double lower, double upper) {
  std::vector<ColorPoint> colors;
  for (int i = 0; i < kKnots; ++i) {
    const double t = i / (kKnots - 1.0);
    colors.push_back({lower + t * (upper - lower), diverging_color(static_cast<float>(2 * t - 1))});
  }
  return colors;
}

/// Two materials of a histogram: the surroundings, and the most frequent other one.
struct Materials {
  double air = 0, body = 0;
};

std::vector<double> smoothed_shares(const ValueHistogram& h) {
  std::vector<double> s = h.share;
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next(s.size());
    for (std::size_t b = 0; b < s.size(); ++b) {
      const std::size_t first = b < 2 ? 0 : b - 2, last = std::min(b + 2, s.size() - 1);
      for (std::size_t k = first; k <= last; ++k) next[b] += s[k] / static_cast<double>(last - first + 1);
    }
    s.swap(next);
  }
  return s;
}

std::optional<Materials> materials_of(const ValueHistogram& h) {
  constexpr std::size_t kLowEnd = ValueHistogram::kBins / 8;
  constexpr double kAirShare = 0.25, kBodyShare = 0.04, kValley = 0.35;
  const std::vector<double> s = smoothed_shares(h);
  const auto air = static_cast<std::size_t>(std::max_element(s.begin(), s.begin() + kLowEnd) - s.begin());
  if (s[air] < *std::max_element(s.begin(), s.end())) return std::nullopt;
  double low_share = 0;
  for (std::size_t b = 0; b < kLowEnd; ++b) low_share += h.share[b];
  if (low_share < kAirShare) return std::nullopt;
  // Visits peaks from the lowest on; each is compared with the deepest valley before it.
  double valley = s[air], best = 0;
  std::size_t body = 0;
  for (std::size_t b = air + 1; b + 1 < s.size(); ++b) {
    valley = std::min(valley, s[b]);
    if (!(s[b] >= s[b - 1] && s[b] > s[b + 1]) || valley > kValley * s[b]) continue;
    double mass = 0;
    for (std::size_t k = b; k < s.size() && s[k] > 0.2 * s[b]; ++k) mass += s[k];
    for (std::size_t k = b; k > air && s[k - 1] > 0.2 * s[b] && s[k - 1] <= s[b]; --k) mass += s[k - 1];
    if (mass >= kBodyShare && s[b] > best) best = s[b], body = b;
  }
  if (body == 0) return std::nullopt;
  return Materials{h.value(air), h.value(body)};
}

/// Conversion from Hounsfield units to values of the data.
struct Hounsfield {
  double slope = 1, offset = 0;
  double value(double units) const { return offset + slope * units; }
};

Hounsfield hounsfield_of(const ValueHistogram& h) {
  if (h.least <= -500 && h.most > 100) return {};
  Materials m{h.lower, h.lower + 0.4 * (h.upper - h.lower)};
  if (const auto found = materials_of(h)) m = *found;
  const double slope = (m.body - m.air) / 1040;
  return {slope, m.air + 1000 * slope};
}

TransferFunction in_hounsfield(std::string_view name, const ValueHistogram& h, std::vector<ColorPoint> colors,
                               std::vector<OpacityPoint> opacities) {
  const Hounsfield units = hounsfield_of(h);
  TransferFunction f{std::string(name), std::move(colors), std::move(opacities)};
  for (ColorPoint& p : f.colors) p.value = units.value(p.value);
  for (OpacityPoint& p : f.opacities) p.value = units.value(p.value);
  return f;
}

/// Peak opacity of a veil over these values with the optical depth kVeil at any steepness of the surface: steep
/// surfaces are thin.
double veil_opacity(const ValueHistogram& h, double lower, double upper) {
  double slope = 0, share = 0;
  for (std::size_t b = 0; b < ValueHistogram::kBins; ++b)
    if (h.value(b) >= lower && h.value(b) <= upper) slope += h.share[b] * h.steepness[b], share += h.share[b];
  if (!(slope > 0) || !(h.diagonal > 0)) return 0.32;
  const double thick = (upper - lower) * share / slope;  // the opacity rises and falls over it
  return std::clamp(-std::expm1(-2 * kVeil * kReference * h.diagonal / thick), 0.15, 0.97);
}

TransferFunction of_materials(const ValueHistogram& h, const Materials& m) {
  const double step = m.body - m.air;
  const double dense = m.body + 0.25 * step, top = std::max(h.most, dense + 0.5 * step);
  TransferFunction f;
  f.name = "materials";
  const auto at = [&](double t) { return m.air + t * step; };
  f.colors = {{at(0.3), {0.72f, 0.40f, 0.30f}}, {at(0.6), {0.86f, 0.56f, 0.43f}}, {at(1), {0.72f, 0.33f, 0.26f}},
              {dense, {0.88f, 0.70f, 0.52f}},   {at(1.5), {0.96f, 0.90f, 0.77f}}, {top, {1, 0.99f, 0.96f}}};
  const double veil = veil_opacity(h, at(0.35), at(0.72));
  // The surface of the body is a veil; its inside is nearly clear, so that dense material is visible.
  f.opacities = {{at(0.35), 0}, {at(0.5), veil}, {at(0.72), 0.035}, {at(1), 0.03},
                 {dense, 0.04}, {at(1.38), 0.5}, {at(1.6), 0.8},    {top, 0.9}};
  f.validate();
  return f;
}

/// Mean extinction per reference length of values with these shares.
double mean_extinction(const std::vector<double>& shares, const std::vector<double>& weights, double scale) {
  double sum = 0;
  for (std::size_t b = 0; b < shares.size(); ++b) sum -= shares[b] * std::log1p(-std::min(0.9, scale * weights[b]));
  return sum;
}

TransferFunction of_range(const ValueHistogram& h, bool& background, bool& signs) {
  constexpr std::size_t kPoints = 33, kBackgroundBins = 6;
  TransferFunction f;
  double low = 0;
  for (std::size_t b = 0; b < kBackgroundBins; ++b) low += h.share[b];
  background = low > 0.3;
  signs = h.lower < 0 && h.upper > 0 && std::min(-h.lower, h.upper) > 0.25 * std::max(-h.lower, h.upper);
  if (signs) {
    const double most = std::max(-h.lower, h.upper);
    f.colors = diverging_colors(-most, most);
    f.name = "range, diverging";
  } else {
    f.colors = flow_colors(h.lower, h.upper);
    f.name = "range";
  }
  const std::vector<double> s = smoothed_shares(h);
  const double most = *std::max_element(s.begin(), s.end());
  std::vector<double> steep;
  for (std::size_t b = 0; b < s.size(); ++b)
    if (h.share[b] > 0) steep.push_back(h.steepness[b]);
  std::sort(steep.begin(), steep.end());
  const double steepest = steep.empty() ? 0 : steep[steep.size() * 9 / 10];
  std::vector<double> weights(s.size());
  for (std::size_t b = 0; b < s.size(); ++b) {
    const double rare = 1 - std::log1p(1e3 * s[b] / most) / std::log1p(1e3);
    const double edge = steepest > 0 ? std::min(1.0, h.steepness[b] / steepest) : 1;
    weights[b] = (0.03 + 0.97 * std::pow(std::max(0.0, rare), 1.5)) * (0.25 + 0.75 * edge);
    if (background && b < 2 * kBackgroundBins)
      weights[b] *= b < kBackgroundBins ? 0 : static_cast<double>(b - kBackgroundBins) / kBackgroundBins;
  }
  // Rays have only a short path through shells and layers.
  const double across = h.across > 0 ? std::min(kAcross, h.across / (kReference * h.diagonal)) : kAcross;
  double low_scale = 0, high_scale = 1e4;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low_scale + high_scale);
    (mean_extinction(h.share, weights, middle) * across < kDepth ? low_scale : high_scale) = middle;
  }
  const double scale = std::min(low_scale, 4 * kAcross / across);  // a few rare values cannot fill a picture
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double t = static_cast<double>(i) / (kPoints - 1);
    const std::size_t bin = std::min(s.size() - 1, static_cast<std::size_t>(t * static_cast<double>(s.size())));
    f.opacities.push_back({h.lower + t * (h.upper - h.lower), std::min(0.9, scale * weights[bin])});
  }
  return f;
}

}  // namespace

std::span<const std::string_view> transfer_function_presets() { return kPresets; }

TransferFunction transfer_function_preset(std::string_view name, const ValueHistogram& h) {
  const double low = h.lower, high = h.upper > h.lower ? h.upper : h.lower + 1, span = high - low;
  if (name == "ct-bone")
    return in_hounsfield(name, h,
                         {{-1000, {0.3f, 0.1f, 0.08f}},
                          {150, {0.62f, 0.27f, 0.20f}},
                          {300, {0.87f, 0.68f, 0.50f}},
                          {700, {0.95f, 0.91f, 0.80f}},
                          {2000, {1, 1, 1}}},
                         {{150, 0}, {300, 0.25}, {700, 0.7}, {2000, 0.9}});
  if (name == "ct-soft-tissue")
    return in_hounsfield(name, h,
                         {{-400, {0.78f, 0.54f, 0.44f}},
                          {-100, {0.92f, 0.70f, 0.57f}},
                          {40, {0.80f, 0.42f, 0.34f}},
                          {150, {0.72f, 0.28f, 0.22f}},
                          {300, {0.95f, 0.86f, 0.72f}},
                          {1500, {1, 0.98f, 0.94f}}},
                         {{-500, 0}, {-250, 0.12}, {-60, 0.08}, {40, 0.1}, {150, 0.2}, {300, 0.5}, {1500, 0.85}});
  if (name == "mr")
    return {std::string(name),
            {{low, {0.05f, 0.04f, 0.05f}},
             {low + 0.3 * span, {0.55f, 0.36f, 0.32f}},
             {low + 0.6 * span, {0.86f, 0.75f, 0.66f}},
             {high, {1, 1, 0.98f}}},
            {{low + 0.12 * span, 0}, {low + 0.25 * span, 0.03}, {low + 0.6 * span, 0.15}, {high, 0.5}}};
  if (name == "flow") return {std::string(name), flow_colors(low, high), {{low, 0.01}, {high, 0.2}}};
  if (name == "diverging") {
    const double most = std::max(std::abs(low), std::abs(high));
    return {std::string(name),
            diverging_colors(-most, most),
            {{-most, 0.2}, {-0.1 * most, 0}, {0.1 * most, 0}, {most, 0.2}}};
  }
  if (name == "gray") return {std::string(name), {{low, {0, 0, 0}}, {high, {1, 1, 1}}}, {{low, 0}, {high, 0.2}}};
  std::string all;
  for (const std::string_view known : kPresets) all += (all.empty() ? "" : ", ") + std::string(known);
  throw ArgumentError("unknown preset '" + printable(name, 40) + "': " + all);
}

SuggestedTransferFunction suggest_transfer_function(const ValueHistogram& h, bool image) {
  if (!(h.upper > h.lower))
    return {{"constant", {{h.lower, srgb_of_oklch(0.6, 0.1, 200)}}, {{h.lower, 0.03}}},
            fmt::format("all values are {:g}", h.lower)};
  if (const auto m = image ? materials_of(h) : std::nullopt)
    return {of_materials(h, *m),
            fmt::format("two materials, at {:.4g} and {:.4g}: the first clear, the second a veil, denser values opaque",
                        m->air, m->body)};
  bool background = false, signs = false;
  SuggestedTransferFunction found{of_range(h, background, signs), {}};
  found.why = fmt::format("the values from {:.4g} to {:.4g}{}{}, rare and steep ones more opaque", h.lower, h.upper,
                          signs ? ", colours diverging from 0" : "", background ? ", those at the low end clear" : "");
  return found;
}

}  // namespace sansmesh::inline v1
