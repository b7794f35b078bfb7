// Words for the quantities that curvature is shown by.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/surface/curvature_colors.h"

namespace sansmesh::inline v1 {

using CurvatureQuantity = CurvatureColorOptions::Quantity;

/// In the order of the enumerators.
inline constexpr std::string_view kCurvatureWords[] = {"mean", "gaussian", "k1", "k2"};

/// "mean", "gaussian", …
const char* quantity_word(CurvatureQuantity quantity);
/// Tells whether a word names one of them.
bool is_curvature(std::string_view word);
/// Throws ArgumentError for a word that is none of them.
CurvatureQuantity curvature_quantity(std::string_view word);
/// A range of curvatures of the input (per length or length²) in coordinates of so many lengths of the input.
double curvature_range(double range, CurvatureQuantity quantity, double unit);

}  // namespace sansmesh::inline v1
