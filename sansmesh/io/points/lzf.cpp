#include "sansmesh/io/points/lzf.h"

#include <cstring>

namespace sansmesh::inline v1::io {

// A control byte below 32 announces that many + 1 literal bytes. Otherwise, its upper three bits are the length of a
// copy minus 2 (7: another byte is added to it), its lower five and the next byte the distance back minus 1.
bool lzf_decompress(std::string_view packed, std::span<char> out) {
  const auto* p = reinterpret_cast<const unsigned char*>(packed.data());
  const auto* const end = p + packed.size();
  std::size_t done = 0;
  while (p != end) {
    const unsigned control = *p++;
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > static_cast<std::size_t>(end - p) || length > out.size() - done) return false;
      std::memcpy(out.data() + done, p, length);
      p += length, done += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (p == end) return false;
      length += *p++;
    }
    length += 2;
    if (p == end) return false;
    const std::size_t distance = ((control & 31u) << 8 | *p++) + 1;
    if (distance > done || length > out.size() - done) return false;
    // Source and target may overlap: a run repeats itself.
    const char* from = out.data() + done - distance;
    char* to = out.data() + done;
    for (std::size_t k = 0; k < length; ++k) to[k] = from[k];
    done += length;
  }
  return done == out.size();
}

}  // namespace sansmesh::inline v1::io
