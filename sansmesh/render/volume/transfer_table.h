// Pre-integrated transfer functions.
#pragma once

#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// Integrals over the value, after [engel2001]. For a ray segment with linear values from a to b, the mean extinction
/// is (I(b) − I(a)) / (b − a) with I = ∫ τ dv, and the mean emitted colour (K(b) − K(a)) / (I(b) − I(a)) with K = ∫ τ c
/// dv. So segments of any length include thin layers of the function, and opacity does not depend on the step length.
/// Opacity o for a length L is the extinction −ln(1 − o) / L.
class TransferTable {
 public:
  static constexpr int kBins = 2048;

  /// Extinctions per reference length (scaled by the caller).
  explicit TransferTable(const TransferFunction& function);
  /// Colours alone, as if all values were equally dense: for colours and opacities from different arrays.
  static TransferTable colors_only(const TransferFunction& function);

  /// Integrals up to a value.
  struct Entry {
    double depth = 0, red = 0, green = 0, blue = 0;
  };
  /// Table coordinate of a value, extrapolated beyond the table.
  double coordinate(double value) const { return (value - lower_) * scale_; }
  /// Table coordinates per unit of value.
  double scale() const { return scale_; }
  Entry at(double coordinate) const {
    const double inside = coordinate < 0 ? 0 : coordinate > kBins ? kBins : coordinate;
    const int bin = index_in<int>(inside, 0, kBins - 1);
    const double t = inside - bin;
    const Entry &a = entries_[static_cast<std::size_t>(bin)], &b = entries_[static_cast<std::size_t>(bin) + 1];
    Entry e{a.depth + t * (b.depth - a.depth), a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
            a.blue + t * (b.blue - a.blue)};
    if (inside != coordinate) {
      const Entry& rest = coordinate < 0 ? below_ : above_;
      const double beyond = coordinate - inside;
      e.depth += beyond * rest.depth, e.red += beyond * rest.red;
      e.green += beyond * rest.green, e.blue += beyond * rest.blue;
    }
    return e;
  }
  /// Slopes of the integrals: extinction, and extinction times colour (linear light).
  Entry density(double coordinate) const;
  /// Whether all values from a to b (not table coordinates) are clear.
  bool clear(double a, double b) const;

 private:
  TransferTable(const TransferFunction& function, bool colors_only);
  double lower_ = 0, scale_ = 1;
  std::vector<Entry> entries_;
  Entry below_, above_;
};

}  // namespace sansmesh::inline v1
