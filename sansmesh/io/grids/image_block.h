// Grid blocks of images from their headers.
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
  std::array<Vec3, 3> steps{Vec3{1, 0, 0}, Vec3{0, 1, 0},
                            Vec3{0, 0, 1}};  ///< between neighbouring points along each axis
  Vec3 origin;                               ///< position of point (0, 0, 0)
};

/// Product of numbers of the header; throws FileError if it exceeds 2^48.
std::uint64_t checked_product(const Input& in, std::initializer_list<std::uint64_t> factors);

/// A lattice if the steps are perpendicular within the precision of text headers, else a curvilinear block. The step of
/// an axis with one point may be zero. Throws FileError if other steps have no length or are coplanar.
GridBlock image_block(const Input& in, const ImageLayout& layout);

/// Decodes `count` numbers at `bytes`, which must be long enough.
AttributeValues decode_values(const char* bytes, std::size_t count, NumberType type, bool big_endian);

/// Decompresses the numbers of an image: `needed` bytes, `most` at most. Throws FileError if the data end early, and,
/// before memory is allocated, if so few compressed bytes cannot hold that many.
std::vector<char> unpack_values(const Input& data, std::uint64_t needed, std::uint64_t most);

/// The same as decode_values from text, separated by blanks, line ends or commas. Throws FileError if there are fewer
/// numbers, or one is not of that type.
AttributeValues parse_values(const Input& in, std::string_view text, std::size_t count, NumberType type);

}  // namespace sansmesh::inline v1::io
