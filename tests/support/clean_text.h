// Test of whether a message is printable on one line of a terminal; independent of the library.
#pragma once

#include <cstddef>
#include <string_view>

namespace sansmesh::test {

/// Checks for UTF-8 without control characters and line breaks.
inline bool is_clean(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto at = [&](std::size_t k) { return static_cast<unsigned>(static_cast<unsigned char>(text[i + k])); };
    const auto follows = [&](std::size_t n) {
      if (i + n >= text.size()) return false;
      for (std::size_t k = 1; k <= n; ++k)
        if (at(k) < 0x80 || at(k) > 0xbf) return false;
      return true;
    };
    const unsigned b = at(0);
    if (b >= 0x20 && b < 0x7f) {
      i += 1;
    } else if (b >= 0xc2 && b <= 0xdf) {
      if (!follows(1) || (b == 0xc2 && at(1) < 0xa0)) return false;
      i += 2;
    } else if (b >= 0xe0 && b <= 0xef) {
      if (!follows(2) || (b == 0xe0 && at(1) < 0xa0) || (b == 0xed && at(1) > 0x9f)) return false;
      if (b == 0xe2 && at(1) == 0x80 && (at(2) == 0xa8 || at(2) == 0xa9)) return false;
      i += 3;
    } else if (b >= 0xf0 && b <= 0xf4) {
      if (!follows(3) || (b == 0xf0 && at(1) < 0x90) || (b == 0xf4 && at(1) > 0x8f)) return false;
      i += 4;
    } else {
      return false;
    }
  }
  return true;
}

}  // namespace sansmesh::test
