#include "sansmesh/render/volume/transfer_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/index_in.h"
#include "sansmesh/render/scene/lighting.h"

namespace sansmesh::inline v1 {
namespace {

/// Mean of −ln(1 − o) for opacities o from a to b, in closed form.
double mean_depth(double a, double b) {
  a = std::min(a, kMostOpacity), b = std::min(b, kMostOpacity);
  if (std::abs(b - a) < 1e-6) return -std::log1p(-0.5 * (a + b));
  const auto integral = [](double o) { return (1 - o) * std::log1p(-o) + o; };
  return (integral(b) - integral(a)) / (b - a);
}

}  // namespace

TransferTable::TransferTable(const TransferFunction& function) : TransferTable(function, false) {}
TransferTable TransferTable::colors_only(const TransferFunction& function) { return {function, true}; }

TransferTable::TransferTable(const TransferFunction& function, bool colors_only) {
  function.validate();
  auto [lower, upper] = function.range();
  if (!(upper > lower)) {
    // Widens a range of a single value, also if it is so large that 1 is below its resolution.
    const double half = std::abs(lower) < 0x1p50 ? 0.5 : 0x1p-20 * std::abs(lower);
    lower -= half, upper = lower + 2 * half;
  }
  lower_ = lower, scale_ = kBins / (upper - lower);
  std::vector<double> breaks;
  breaks.reserve(function.colors.size() + function.opacities.size() + kBins + 1);
  for (const ColorPoint& p : function.colors) breaks.push_back(coordinate(p.value));
  if (!colors_only)
    for (const OpacityPoint& p : function.opacities) breaks.push_back(coordinate(p.value));
  for (int b = 0; b <= kBins; ++b) breaks.push_back(b);
  std::sort(breaks.begin(), breaks.end());

  const auto light = [&](double at) { return Vec3(linear_color(function.color(lower + at / scale_))); };
  entries_.assign(kBins + 1, {});
  Entry sum;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double a = breaks[i], b = breaks[i + 1], span = b - a;
    if (span > 0) {
      // Inside the segment: the function may jump at its ends.
      const auto opacity = [&](double t) { return function.opacity(lower + (a + t * span) / scale_); };
      const double depth = span * (colors_only ? 1 : mean_depth(opacity(1e-6), opacity(1 - 1e-6)));
      const Vec3 color = light(0.5 * (a + b));
      sum.depth += depth, sum.red += depth * color.x, sum.green += depth * color.y, sum.blue += depth * color.z;
    }
    if (b == std::floor(b)) entries_[index_in<std::size_t>(b, 0, kBins)] = sum;
  }
  const auto outer = [&](double value) {
    const double depth = colors_only ? 1 : mean_depth(function.opacity(value), function.opacity(value));
    const Vec3 color(linear_color(function.color(value)));
    return Entry{depth, depth * color.x, depth * color.y, depth * color.z};
  };
  below_ = outer(std::nextafter(lower, -std::numeric_limits<double>::infinity())), above_ = outer(upper);
}

TransferTable::Entry TransferTable::density(double coordinate) const {
  if (coordinate < 0) return below_;
  if (coordinate >= kBins) return above_;
  const auto bin = static_cast<std::size_t>(index_in<int>(coordinate, 0, kBins - 1));
  const Entry &a = entries_[bin], &b = entries_[bin + 1];
  return {b.depth - a.depth, b.red - a.red, b.green - a.green, b.blue - a.blue};
}

bool TransferTable::clear(double a, double b) const {
  const double first = coordinate(a), last = coordinate(b);
  if (first < 0 && below_.depth > 0) return false;
  if (last > kBins && above_.depth > 0) return false;
  const auto bin = [](double p) { return index_in<std::size_t>(p, 0, kBins - 1); };
  return entries_[bin(last) + 1].depth == entries_[bin(first)].depth;
}

}  // namespace sansmesh::inline v1
