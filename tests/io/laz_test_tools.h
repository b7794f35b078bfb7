// Synthetic surveys and compressed files for the tests of LAZ.
#pragma once

#include <random>

#include "compress_las.h"
#include "io_test_tools.h"
#include "support/las_file.h"

namespace sansmesh::test {

/// Bytes of a record of each point format.
inline constexpr std::array<std::size_t, 11> kRecordOfFormat = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Records of a flight: pulses of several returns in scan lines, which use all parts of the format, with jumps in time,
/// changes of the scanner channel and runs of equal values. `with_jumps`: of thousands of kilometres.
inline std::string survey_records(unsigned format, std::size_t extra, std::size_t n, bool with_jumps = true) {
  std::mt19937 random(format);
  const auto below = [&](unsigned limit) { return static_cast<unsigned>(random() % limit); };
  const bool wide = format >= 6;
  LasFile las{.minor = 4, .format = format};
  const std::size_t length = kRecordOfFormat[format] + extra;
  std::string all;
  LasPoint p;
  unsigned channel = 0;
  std::uint64_t wave = 1000;
  p.gps_time = 1.2e8;
  while (all.size() < n * length) {
    const unsigned returns = 1 + below(below(3) == 0 ? (wide ? 15 : 7) : 2);
    p.gps_time += below(50) == 0 ? -3e5 + below(1000000) : below(5) == 0 ? 1e-5 * below(1000) : 1e-5;
    p.x += 40 + static_cast<std::int32_t>(below(21)), p.y += static_cast<std::int32_t>(below(9)) - 4;
    if (with_jumps && below(500) == 0)
      p.x = static_cast<std::int32_t>(random()), p.y = static_cast<std::int32_t>(random());
    if (wide && below(7) == 0) channel = below(4);
    if (below(300) == 0) ++p.source;
    if (below(20) == 0)
      p.user_data = static_cast<std::uint8_t>(random()), p.scan_angle = static_cast<int>(below(90)) - 45;
    for (unsigned r = 1; r <= returns && all.size() < n * length; ++r) {
      p.return_number = r, p.returns = returns;
      p.z = 20000 - static_cast<std::int32_t>(300 * r + below(50));
      p.intensity = static_cast<std::uint16_t>(below(3) == 0 ? random() : 800 + below(40));
      p.classification = below(4) ? 2 : below(wide ? 256 : 32);
      p.synthetic = below(30) == 0, p.overlap = wide && below(30) == 0;
      for (std::uint16_t& c : p.rgb) c = static_cast<std::uint16_t>(257 * ((c + below(9)) % 256));
      if (below(4) == 0) p.rgb = {p.rgb[0], p.rgb[0], p.rgb[0]};
      if (below(40) == 0) p.rgb[2] = static_cast<std::uint16_t>(random());
      p.near_infrared = static_cast<std::uint16_t>(below(8) ? p.near_infrared : random());
      std::string record = las.record(p);
      if (wide) record[15] = static_cast<char>((record[15] & ~0x30) | channel << 4);
      if (las.has_waves()) {
        const std::size_t at = format == 4 ? 28 : format == 5 ? 34 : format == 9 ? 30 : 38;
        wave += below(3) == 0 ? 256 : below(5) == 0 ? 0 : below(50) == 0 ? 1ull << 40 : below(100000);
        record[at] = static_cast<char>(below(4));
        record.replace(at + 1, 8, raw(wave));
        record.replace(at + 9, 4, raw(std::uint32_t{256}));
        for (std::size_t k = 0; k < 4; ++k)
          record.replace(at + 13 + 4 * k, 4, raw(0.001f * static_cast<float>(below(900))));
      }
      for (std::size_t k = 0; k < extra; ++k) record += static_cast<char>(below(3 + 50 * static_cast<unsigned>(k)));
      all += record;
    }
  }
  return all;
}

/// A LAS file with these records; compressed if `packed`, in chunks of `chunk_points`.
inline std::string las_with_records(unsigned minor, unsigned format, const std::string& records, std::size_t length,
                                    bool packed = false, std::uint32_t chunk_points = 700) {
  LasFile las{.minor = minor, .format = format};
  std::string file = las.bytes();
  const auto put = [&file](std::size_t at, auto value) { std::memcpy(file.data() + at, &value, sizeof value); };
  const std::size_t n = records.size() / length;
  put(105, static_cast<std::uint16_t>(length));
  if (format < 6) put(107, static_cast<std::uint32_t>(n));
  if (minor >= 4) put(247, std::uint64_t{n});
  file += records;
  return packed ? compress_las(file, chunk_points) : file;
}

}  // namespace sansmesh::test
