// A ball in a small raw file, as volume for the commands.
#pragma once

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace sansmesh::test {

constexpr std::size_t kBallSize = 17;  ///< samples along each axis, 1 apart
constexpr const char* kBallFile = "ball_17x17x17_float32.raw";

/// 7 minus the distance from the centre (8, 8, 8): {f > 2} is the ball of radius 5.
inline std::string ball_bytes() {
  std::vector<float> values;
  for (std::size_t k = 0; k < kBallSize; ++k)
    for (std::size_t j = 0; j < kBallSize; ++j)
      for (std::size_t i = 0; i < kBallSize; ++i) {
        const auto d = [](std::size_t n) { return static_cast<double>(n) - 8; };
        values.push_back(static_cast<float>(7 - std::sqrt(d(i) * d(i) + d(j) * d(j) + d(k) * d(k))));
      }
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace sansmesh::test
