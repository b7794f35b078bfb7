// Preset transfer functions, and suggestions from the data.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// A preset for data with these values. CT presets are in Hounsfield units; for data in other units, the peaks of air
/// and of the next material are mapped to −1000 and 40. Other presets span the range of the data. Throws ArgumentError
/// naming the available presets.
TransferFunction transfer_function_preset(std::string_view name, const ValueHistogram& values);

struct SuggestedTransferFunction {
  TransferFunction function;
  std::string why;  ///< one line
};

/// Suggests a transfer function from the frequency of values and the gradient length at each value:
/// - materials, in an `image` (CT of bodies and parts: a large peak at the low end, another peak apart from it). Values
///   below the valley between the peaks are clear. The material of the second peak is a veil of about the same strength
///   however steep its surface is. Denser material is opaque.
/// - otherwise the whole range: rare values and steep gradients are more opaque. A value at the low end that fills a
///   large share of the volume is background and clear. A ray across the box of the volume loses about three quarters
///   of its light, whatever share of the box the volume fills.
///
/// Colours diverge from 0 if values have both signs.
SuggestedTransferFunction suggest_transfer_function(const ValueHistogram& values, bool image = true);

}  // namespace sansmesh::inline v1
