// Writes LAS test files in every version and point format, from the tables of the specification and independent of the
// reader.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::test {

/// One record, in the units of the file.
struct LasPoint {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint16_t intensity = 0;
  unsigned return_number = 0, returns = 0;  ///< 0..7, from format 6 on 0..15
  unsigned classification = 0;              ///< 0..31, from format 6 on 0..255
  bool synthetic = false, key_point = false, withheld = false, overlap = false;
  int scan_angle = 0;  ///< degrees, from format 6 on 0.006 degrees
  std::uint8_t user_data = 0;
  std::uint16_t source = 0;
  double gps_time = 0;
  std::array<std::uint16_t, 3> rgb = {0, 0, 0};
  std::uint16_t near_infrared = 0;
};

struct LasFile {
  unsigned minor = 4, format = 6;
  Vec3 scale{0.001, 0.001, 0.001}, offset{};
  std::size_t extra = 0;                          ///< unused bytes after each record
  std::optional<std::uint32_t> short_count = {};  ///< in the header of LAS 1.4; default: as the format requires
  std::optional<std::uint64_t> long_count = {};
  std::string variable = {};  ///< records between header and points
  std::uint32_t variable_count = 0;
  std::string (*own)(const LasPoint&) = nullptr;  ///< meaningful bytes after each record, before the unused ones
  std::vector<LasPoint> points = {};

  bool wide() const { return format >= 6; }
  bool has_time() const { return wide() || format == 1 || format >= 3; }
  bool has_colors() const {
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
  }
  bool has_infrared() const { return format == 8 || format == 10; }
  bool has_waves() const { return format == 4 || format == 5 || format == 9 || format == 10; }

  std::string record(const LasPoint& p) const {
    std::string s;
    put(s, p.x), put(s, p.y), put(s, p.z), put(s, p.intensity);
    if (wide()) {
      put(s, static_cast<std::uint8_t>(p.return_number | p.returns << 4));
      // Scanner channel 2, scan direction right, not at the edge: the reader ignores these flags.
      put(s, static_cast<std::uint8_t>(p.synthetic | p.key_point << 1 | p.withheld << 2 | p.overlap << 3 | 2u << 4 |
                                       1u << 6));
      put(s, static_cast<std::uint8_t>(p.classification)), put(s, p.user_data);
      put(s, static_cast<std::int16_t>(p.scan_angle)), put(s, p.source), put(s, p.gps_time);
    } else {
      put(s, static_cast<std::uint8_t>(p.return_number | p.returns << 3 | 1u << 6));
      put(s, static_cast<std::uint8_t>(p.classification | p.synthetic << 5 | p.key_point << 6 | p.withheld << 7));
      put(s, static_cast<std::int8_t>(p.scan_angle)), put(s, p.user_data), put(s, p.source);
      if (has_time()) put(s, p.gps_time);
    }
    if (has_colors())
      for (const std::uint16_t c : p.rgb) put(s, c);
    if (has_infrared()) put(s, p.near_infrared);
    if (has_waves()) s += std::string(29, '\x55');
    if (own) s += own(p);
    return s + std::string(extra, '\x77');
  }

  std::string bytes() const {
    const std::size_t head = minor >= 4 ? 375 : minor == 3 ? 235 : 227;
    std::string s(head, '\0');
    const auto at = [&s](std::size_t place, const auto& value) {
      std::memcpy(s.data() + place, &value, sizeof(value));
    };
    s.replace(0, 4, "LASF");
    s[24] = 1, s[25] = static_cast<char>(minor), s[104] = static_cast<char>(format);
    at(94, static_cast<std::uint16_t>(head)), at(96, static_cast<std::uint32_t>(head + variable.size())),
        at(100, variable_count);
    at(105, static_cast<std::uint16_t>(record({}).size()));
    const auto count = static_cast<std::uint32_t>(points.size());
    at(107, short_count.value_or(wide() ? 0 : count));
    if (minor >= 4) at(247, long_count.value_or(count));
    for (std::size_t k = 0; k < 3; ++k) at(131 + 8 * k, scale[k]), at(155 + 8 * k, offset[k]);
    s += variable;
    for (const LasPoint& p : points) s += record(p);
    return s;
  }

 private:
  template <class T>
  static void put(std::string& s, T value) {
    s.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
};

/// Largest point format of a version.
inline unsigned last_point_format(unsigned minor) { return minor >= 4 ? 10 : minor == 3 ? 5 : minor == 2 ? 3 : 1; }

}  // namespace sansmesh::test
