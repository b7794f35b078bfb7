// What values look like: colour and opacity over a range of values (docs/methods/volume-rendering.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct ColorPoint {
  double value = 0;
  Vec3f color;  ///< sRGB 0..1
  friend bool operator==(const ColorPoint&, const ColorPoint&) = default;
};

struct OpacityPoint {
  double value = 0;
  double opacity = 0;  ///< 0..1: share of the light that a layer as thick as the reference length keeps back
  friend bool operator==(const OpacityPoint&, const OpacityPoint&) = default;
};

/// How colours are mixed between control points. `step`: not at all, each holds up to the next one.
enum class ColorMixing : std::uint8_t { rgb, lab, step };

/// Opacity 1 means this much: a light that nothing at all gets through would need an infinite extinction.
constexpr double kMostOpacity = 0.99999;

/// Piecewise linear in colour and in opacity; beyond the outermost points the values of these go on. Two points may
/// have the same value: the function jumps there.
struct TransferFunction {
  std::string name;
  std::vector<ColorPoint> colors;       ///< by value, ascending; at least one
  std::vector<OpacityPoint> opacities;  ///< by value, ascending; at least one
  ColorMixing mixing = ColorMixing::lab;
  /// Length that opacities are meant for, in the unit of the data; default: a fiftieth of the volume's diagonal.
  std::optional<double> reference_length = {};

  Vec3f color(double value) const;     ///< sRGB
  double opacity(double value) const;  ///< 0..1
  /// Lowest and highest value of all control points.
  std::pair<double, double> range() const;
  /// The same function with its range moved linearly to another one.
  TransferFunction over(double lower, double upper) const;
  /// Throws ArgumentError: no points, not ascending, not finite, colours or opacities beyond 0..1.
  void validate() const;
  friend bool operator==(const TransferFunction&, const TransferFunction&) = default;
};

}  // namespace sansmesh::inline v1
