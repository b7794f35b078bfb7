// Images in space as blocks of a grid, from what their headers say.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

struct ImageLayout {
  std::array<std::size_t, 3> dims{1, 1, 1};
  std::array<Vec3, 3> steps{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< from a point to the next on each axis
  Vec3 origin;                                                             ///< of point (0, 0, 0)
};

/// Product of numbers of the header; throws FileError where it exceeds 2^48.
std::uint64_t checked_product(const Input& in, std::initializer_list<std::uint64_t> factors);

/// A lattice where the steps are perpendicular to each other, to the precision of headers in text, else a curvilinear
/// block. The step of an axis with one point may be zero. Throws FileError where other steps have no length or lie in a
/// plane.
GridBlock image_block(const Input& in, const ImageLayout& layout);

/// `count` numbers at `bytes`, which must be long enough.
AttributeValues decode_values(const char* bytes, std::size_t count, NumberType type, bool big_endian);

/// The numbers of an image that `data` holds packed: `needed` bytes, `most` at most. Throws FileError, before memory is
/// taken, where so few packed ones cannot hold that many, and where they end early.
std::vector<char> unpack_values(const Input& data, std::uint64_t needed, std::uint64_t most);

/// The same as decode_values from text, separated by blanks, line ends or commas. Throws FileError where there are
/// fewer, or what stands there is not a number of that type.
AttributeValues parse_values(const Input& in, std::string_view text, std::size_t count, NumberType type);

}  // namespace sansmesh::inline v1::io
