// Reads PNG files written by the tool, without the library that wrote them.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace sansmesh::test {

/// RGBA, row by row from the top. Empty, after a test failure, if the file is not such an image.
struct PngPicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes;

  std::array<int, 4> at(std::size_t x, std::size_t y) const {
    std::array<int, 4> pixel{};
    for (std::size_t c = 0; c < 4; ++c) pixel[c] = bytes.at(4 * (y * width + x) + c);
    return pixel;
  }
};

inline PngPicture read_png(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string s{std::istreambuf_iterator<char>(stream), {}};
  const auto byte = [&](std::size_t k) { return static_cast<std::size_t>(static_cast<unsigned char>(s[k])); };
  const auto number = [&](std::size_t k) { return byte(k) << 24 | byte(k + 1) << 16 | byte(k + 2) << 8 | byte(k + 3); };
  // Signature, then IHDR: width, height, 8 bits, RGBA; then the data, which inflate to rows of a filter byte and the
  // pixels.
  if (s.size() < 40 || s.substr(0, 8) != "\x89PNG\r\n\x1a\n" || s[24] != 8 || s[25] != 6) {
    ADD_FAILURE() << file << " is no PNG of 8 bits a channel, RGBA";
    return {};
  }
  PngPicture picture{number(16), number(20), {}};
  std::string packed;
  for (std::size_t at = 8; at + 12 <= s.size(); at += 12 + number(at))
    if (s.substr(at + 4, 4) == "IDAT") packed += s.substr(at + 8, number(at));
  const std::size_t stride = 4 * picture.width;
  std::vector<std::uint8_t> rows(picture.height * (stride + 1)), &pixels = picture.bytes;
  uLongf size = rows.size();
  EXPECT_EQ(uncompress(rows.data(), &size, reinterpret_cast<const Bytef*>(packed.data()), packed.size()), Z_OK);
  EXPECT_EQ(size, rows.size());
  for (std::size_t y = 0; y < picture.height; ++y) {
    const unsigned filter = rows[y * (stride + 1)];
    EXPECT_LE(filter, 4u);
    for (std::size_t i = 0; i < stride; ++i) {  // reverses the filter
      const std::size_t at = pixels.size();
      const int a = i >= 4 ? pixels[at - 4] : 0, b = y > 0 ? pixels[at - stride] : 0,
                c = i >= 4 && y > 0 ? pixels[at - stride - 4] : 0;
      const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      const int paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      const int add[] = {0, a, b, (a + b) / 2, paeth};
      pixels.push_back(static_cast<std::uint8_t>(rows[y * (stride + 1) + 1 + i] + add[std::min(filter, 4u)]));
    }
  }
  return picture;
}

}  // namespace sansmesh::test
