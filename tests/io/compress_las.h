// Compresses LAS files with the library's coder.
#pragma once

#include <cstring>
#include <string>

#include "sansmesh/io/laz/write_laz.h"

namespace sansmesh::test {

/// LAZ with the records of LAS bytes, in chunks of `chunk_points`; `version` 1 or 2 of its parts,
/// in layered chunks 3 or 4.
inline std::string compress_las(const std::string& las, std::uint32_t chunk_points = 700, unsigned version = 3) {
  const auto number = [&]<class T>(std::size_t at, T value) {
    std::memcpy(&value, las.data() + at, sizeof value);
    return value;
  };
  const std::size_t begin = number(96, std::uint32_t{}), length = number(105, std::uint16_t{});
  io::laz::LazLayout layout = io::laz::laz_layout(static_cast<unsigned char>(las[104]), length);
  layout.chunk_points = chunk_points, layout.fixed_channels = layout.layered && version == 4;
  layout.first_version = !layout.layered && version == 1;
  std::string file = las.substr(0, begin) + io::laz::laz_vlr(layout);
  const auto put = [&file](std::size_t at, auto value) { std::memcpy(file.data() + at, &value, sizeof value); };
  if (number(100, std::uint32_t{}) == 0) put(94, static_cast<std::uint16_t>(begin));
  put(96, static_cast<std::uint32_t>(file.size())), put(100, number(100, std::uint32_t{}) + 1);
  file[104] = static_cast<char>(las[104] | 0x80);
  const auto copy = [&](std::size_t first, std::size_t last, char* p) {
    std::memcpy(p, las.data() + begin + first * length, (last - first) * length);
  };
  for (const std::string& part : io::laz::laz_points(layout, (las.size() - begin) / length, file.size(), copy))
    file += part;
  return file;
}

}  // namespace sansmesh::test
