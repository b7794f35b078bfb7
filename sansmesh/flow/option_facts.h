// Descriptions of options shared by flow lines and flow surfaces.
#pragma once

#include <string_view>

#include "sansmesh/option.h"

namespace sansmesh::inline v1 {

/// In the order of FlowDirection.
inline constexpr std::string_view kFlowDirections[] = {"forward", "backward", "both"};

inline constexpr OptionFacts kDirectionFacts{.text = "forward, backward or both", .choices = kFlowDirections};
inline constexpr OptionFacts kStartFacts{
    .text = "Moment of release", .unit = "time", .from_data = "the first of the flow"};
inline constexpr OptionFacts kDurationFacts{.text = "Duration of tracing",
                                            .unit = "duration",
                                            .from_data = "to the end of the flow",
                                            .range = positive(),
                                            .old_name = "time"};

}  // namespace sansmesh::inline v1
