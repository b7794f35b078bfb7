// The part of point records that the point formats 0 to 5 share, as in the file.
#pragma once

#include <cstdint>

namespace sansmesh::inline v1::io::laz {

struct Point10 {
  std::int32_t x, y, z;
  std::uint16_t intensity;
  std::uint8_t returns, classification, angle, user_data;
  std::uint16_t source;
};
static_assert(sizeof(Point10) == 20);

/// x or y as the difference to the last one, predicted by recent differences.
template <class Coder, class Model, class Median>
std::int32_t code_step(Coder& coder, Model& model, Median& median, std::int32_t last, std::int32_t now,
                       unsigned context) {
  const auto from = static_cast<std::uint32_t>(last);
  const std::int32_t step =
      model.code(coder, median.value(), static_cast<std::int32_t>(static_cast<std::uint32_t>(now) - from), context);
  median.add(step);
  return static_cast<std::int32_t>(from + static_cast<std::uint32_t>(step));
}

}  // namespace sansmesh::inline v1::io::laz
