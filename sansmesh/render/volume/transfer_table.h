// Transfer functions integrated beforehand: what a piece of ray sees between two values.
#pragma once

#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// Integrals over the value, after [engel2001]: along a piece of ray on which the value goes linearly from a to b, the
/// mean extinction is (I(b) − I(a)) / (b − a) for I = ∫ τ dv, and the mean colour of what glows there
/// (K(b) − K(a)) / (I(b) − I(a)) for K = ∫ τ c dv. So thin layers of the function are never missed, however long the
/// piece, and any length of step gives the same opacity. Opacity o for a length L is the extinction −ln(1 − o) / L.
class TransferTable {
 public:
  static constexpr int kBins = 2048;

  /// Extinctions are those of lengths in `reference` lengths (the caller's to scale).
  explicit TransferTable(const TransferFunction& function);
  /// Colours alone, as if all values were equally dense: for colours by one array and opacities by another.
  static TransferTable colors_only(const TransferFunction& function);

  /// Integrals up to a value.
  struct Entry {
    double depth = 0, red = 0, green = 0, blue = 0;
  };
  /// A value as a place in the table; in front of it and behind it the places go on.
  double place(double value) const { return (value - lower_) * scale_; }
  /// Places per unit of value.
  double scale() const { return scale_; }
  Entry at(double place) const {
    const double inside = place < 0 ? 0 : place > kBins ? kBins : place;
    const int bin = index_in<int>(inside, 0, kBins - 1);
    const double t = inside - bin;
    const Entry &a = entries_[static_cast<std::size_t>(bin)], &b = entries_[static_cast<std::size_t>(bin) + 1];
    Entry e{a.depth + t * (b.depth - a.depth), a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
            a.blue + t * (b.blue - a.blue)};
    if (inside != place) {
      const Entry& rest = place < 0 ? below_ : above_;
      const double beyond = place - inside;
      e.depth += beyond * rest.depth, e.red += beyond * rest.red;
      e.green += beyond * rest.green, e.blue += beyond * rest.blue;
    }
    return e;
  }
  /// Slopes of the integrals: extinction, and that times the colour (linear light).
  Entry density(double place) const;
  /// Nothing is to be seen of values from a to b (values, not places).
  bool clear(double a, double b) const;

 private:
  TransferTable(const TransferFunction& function, bool colors_only);
  double lower_ = 0, scale_ = 1;
  std::vector<Entry> entries_;
  Entry below_, above_;
};

}  // namespace sansmesh::inline v1
