// Layouts of numbers in files that do not say how they are laid out.
#pragma once

#include <array>
#include <cstddef>

#include "sansmesh/core/vec.h"
#include "sansmesh/data/number_type.h"
#include "sansmesh/schema/option.h"

namespace sansmesh {

/// How the numbers of a file without a header lie in it: the first axis runs fastest, the components of a point stand
/// side by side.
struct RawLayout {
  /// Numbers of points along the axes, at least 1 each; all 0: nobody said so, and nothing else means anything.
  std::array<std::size_t, 3> dims{};
  NumberType type = NumberType::u8;
  std::size_t components = 1;    ///< of each point, at least 1
  Vec3 spacing{1, 1, 1};         ///< of the points (length), > 0
  bool big_endian = false;       ///< byte order of the numbers
  std::size_t header_bytes = 0;  ///< that come before them

  bool given() const { return dims != std::array<std::size_t, 3>{}; }
  static const OptionSchema& schema();
};

}  // namespace sansmesh
