// What values look like: colour and opacity over a range of values (docs/methods/volume-rendering.md).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/core/vec.h"
#include "sansmesh/render/value_histogram.h"

namespace sansmesh {

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

/// Names of transfer_function_preset: "ct-bone", "ct-soft-tissue", "mr", "flow", "diverging", "gray".
std::span<const std::string_view> transfer_function_presets();

/// A preset for data with these values. Those of CT are given in Hounsfield units; where the values are others, the
/// peaks of air and of the material next to it are taken for −1000 and 40. The others lie over the range of the data.
/// Throws ArgumentError naming the presets there are.
TransferFunction transfer_function_preset(std::string_view name, const ValueHistogram& values);

struct SuggestedTransferFunction {
  TransferFunction function;
  std::string why;  ///< a line
};

/// Something sensible for data of any kind, from how often values are and how steep the field is where they are:
/// - materials (CT of bodies and parts: a large peak at the low end, another peak apart from it): what lies below the
///   valley between them is clear, the material of the second peak a veil, what is denser opaque;
/// - otherwise the whole range: the rarer a value and the steeper the field at it, the more opaque. A value at the low
///   end that a large share of the volume has is background and clear. A veil of fixed thickness: a ray across the
///   volume loses about three quarters of its light.
/// Colours diverge from 0 where values have both signs.
SuggestedTransferFunction suggest_transfer_function(const ValueHistogram& values);

/// JSON of ours (docs/formats/transfer-function.md) or ParaView's colour maps (a list of objects with RGBPoints, of
/// which the first is taken). `file` is named in errors. Throws FileError.
TransferFunction parse_transfer_function(std::string_view json, const std::string& file);
TransferFunction read_transfer_function(const std::string& file);
/// JSON of ours: what parse_transfer_function reads back the same.
std::string transfer_function_json(const TransferFunction& function);

}  // namespace sansmesh
