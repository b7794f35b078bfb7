#include "sansmesh/surface/curvature_words.h"

#include <algorithm>
#include <iterator>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

const char* quantity_word(CurvatureQuantity quantity) {
  return kCurvatureWords[static_cast<std::size_t>(quantity)].data();
}

bool is_curvature(std::string_view word) {
  return std::find(std::begin(kCurvatureWords), std::end(kCurvatureWords), word) != std::end(kCurvatureWords);
}

CurvatureQuantity curvature_quantity(std::string_view word) {
  if (!is_curvature(word)) throw ArgumentError("unknown curvature: " + std::string(word));
  return static_cast<CurvatureQuantity>(std::find(std::begin(kCurvatureWords), std::end(kCurvatureWords), word) -
                                        std::begin(kCurvatureWords));
}

double curvature_range(double range, CurvatureQuantity quantity, double unit) {
  return range * (quantity == CurvatureQuantity::gaussian ? unit * unit : unit);
}

}  // namespace sansmesh::inline v1
