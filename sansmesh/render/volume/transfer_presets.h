// Transfer functions by name, and one that follows from the data.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// A preset for data with these values. Those of CT are given in Hounsfield units; where the values are others, the
/// peaks of air and of the material next to it are taken for −1000 and 40. The others lie over the range of the data.
/// Throws ArgumentError naming the presets there are.
TransferFunction transfer_function_preset(std::string_view name, const ValueHistogram& values);

struct SuggestedTransferFunction {
  TransferFunction function;
  std::string why;  ///< a line
};

/// Something sensible for data of any kind, from how often values are and how steep the field is where they are:
/// - materials, in an `image` (CT of bodies and parts: a large peak at the low end, another peak apart from it): what
/// lies below the
///   valley between them is clear, the material of the second peak a veil of about the same
///   strength however steep its surface is, what is denser opaque;
/// - otherwise the whole range: the rarer a value and the steeper the field at it, the more opaque. A value at the low
///   end that a large share of the volume has is background and clear. A ray across the box
///   of the volume loses about three quarters of its light, however little of the box the volume fills.
/// Colours diverge from 0 where values have both signs.
SuggestedTransferFunction suggest_transfer_function(const ValueHistogram& values, bool image = true);

}  // namespace sansmesh::inline v1
