// Reading of LAZ files: makes a survey of many points from a LAS tile and times decompression and the whole reading.
//
//   benchmark_laz_reading TILE.las FOLDER [POINTS=10000000]
//
// Writes FOLDER/survey3.laz and survey7.laz (point formats 3 and 7) unless they exist.
#include <fmt/core.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sansmesh/io.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/laz/read_laz.h"
#include "sansmesh/io/laz/write_laz.h"
#include "sansmesh/threads.h"
#include "timing.h"

using namespace sansmesh;

namespace {

/// The record of point format 3 in format 7.
void put_format7(const char* p, char* q) {
  std::memset(q, 0, 36);
  std::memcpy(q, p, 14);
  const unsigned returns = io::load<std::uint8_t>(p + 14), category = io::load<std::uint8_t>(p + 15);
  q[14] = static_cast<char>((returns & 7) | (returns >> 3 & 7) << 4);
  q[15] = static_cast<char>(category >> 5 | returns >> 6 << 6);
  q[16] = static_cast<char>(category & 31);
  q[17] = p[17];
  const auto angle = static_cast<std::int16_t>(io::load<std::int8_t>(p + 16) / 0.006);
  std::memcpy(q + 18, &angle, 2);
  std::memcpy(q + 20, p + 18, 2 + 8 + 6);
}

/// Copies of the tile beside each other.
void write_survey(const std::string& tile, unsigned format, std::size_t count, const std::string& name) {
  const io::FileContent content(tile);
  ReadReport report;
  const io::Input in{tile, content.bytes(), report};
  const io::LasHeader header = io::read_las_header(in);
  const io::laz::LazLayout layout = io::laz::laz_layout(format, format == 7 ? 36 : 34);
  std::string head(content.bytes().substr(0, 227));
  if (format == 7) head.resize(375);
  head += io::laz::laz_vlr(layout);
  const auto put = [&head](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  head[25] = format == 7 ? 4 : 2, head[104] = static_cast<char>(format | 0x80);
  put(94, static_cast<std::uint16_t>(format == 7 ? 375 : 227));
  put(96, static_cast<std::uint32_t>(head.size())), put(100, std::uint32_t{1});
  put(105, static_cast<std::uint16_t>(layout.record)), put(107, format == 7 ? 0u : static_cast<std::uint32_t>(count));
  if (format == 7) put(247, std::uint64_t{count});
  const auto records = [&](std::size_t first, std::size_t last, char* q) {
    for (std::size_t i = first; i < last; ++i, q += layout.record) {
      char p[34];
      std::memcpy(p, content.bytes().data() + header.begin + i % header.count * header.record, sizeof p);
      const std::int32_t x = io::load<std::int32_t>(p) + static_cast<std::int32_t>(i / header.count * 600000);
      std::memcpy(p, &x, 4);
      format == 7 ? put_format7(p, q) : static_cast<void>(std::memcpy(q, p, sizeof p));
    }
  };
  std::ofstream out(name, std::ios::binary);
  out << head;
  for (const std::string& part : io::laz::laz_points(layout, count, head.size(), records)) out << part;
}

void measure(const std::string& name, std::size_t count) {
  for (const unsigned threads : {1u, 2u}) {
    const ThreadScope scope(threads);
    const Time decompress = fastest_of(3, [&] {
      const io::FileContent content(name);
      ReadReport report;
      const io::Input in{name, content.bytes(), report};
      const io::LasHeader header = io::read_las_header(in);
      if (io::laz::read_laz_records(in, header).size != count * header.record) std::abort();
    });
    const Time whole = fastest_of(3, [&] {
      if (read_points(name).size() != count) std::abort();
    });
    const double rate = 1e-6 * static_cast<double>(count) / decompress.wall;
    fmt::print("{}, {} threads: records {:.2f} s ({:.2f} million/s, {:.2f} CPU s), cloud {:.2f} s\n", name, threads,
               decompress.wall, rate, decompress.cpu, whole.wall);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fmt::print("benchmark_laz_reading TILE.las FOLDER [POINTS]\n"), 2;
  const std::size_t count = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 10000000;
  for (const unsigned format : {3u, 7u}) {
    const std::string name = fmt::format("{}/survey{}.laz", argv[2], format);
    if (!std::filesystem::exists(name)) write_survey(argv[1], format, count, name);
    measure(name, count);
  }
}
