// GeoTIFF (OGC 19-008) of heights: one band of float32, in tiles with deflate, as all programs for terrain read it.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTile = 256;  ///< pixels on a side; a multiple of 16
constexpr float kNoHeight = -9999;
constexpr std::uint16_t kShort = 3, kLong = 4, kDouble = 12, kAscii = 2;

/// Entries of the directory, with their values.
class TiffDirectory {
 public:
  template <class T>
  void add(std::uint16_t tag, std::uint16_t type, const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    entries_.push_back({tag, type, static_cast<std::uint32_t>(values.size()), std::move(bytes)});
  }
  void add_text(std::uint16_t tag, const std::string& text) {
    entries_.push_back({tag, kAscii, static_cast<std::uint32_t>(text.size() + 1), text + '\0'});
  }

  /// Bytes of the directory at an even offset of the file.
  std::string bytes(std::uint32_t offset) {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.tag < b.tag; });
    std::string head, values;
    put(head, static_cast<std::uint16_t>(entries_.size()));
    const auto first = static_cast<std::uint32_t>(offset + 2 + 12 * entries_.size() + 4);
    for (const Entry& e : entries_) {
      put(head, e.tag), put(head, e.type), put(head, e.count);
      if (outside(e) == 0) {
        head += e.value;
        head.append(4 - e.value.size(), '\0');
        continue;
      }
      put(head, static_cast<std::uint32_t>(first + values.size()));
      values += e.value;
      values.append(outside(e) - e.value.size(), '\0');
    }
    put(head, std::uint32_t{0});
    return head + values;
  }

 private:
  struct Entry {
    std::uint16_t tag, type;
    std::uint32_t count;
    std::string value;
  };
  /// Bytes after the directory, an even number; short values are inside.
  static std::size_t outside(const Entry& e) { return e.value.size() <= 4 ? 0 : (e.value.size() + 1) / 2 * 2; }
  template <class T>
  static void put(std::string& to, T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    to.append(bytes, sizeof(T));
  }

  std::vector<Entry> entries_;
};

/// Pixels of a tile, compressed.
std::string tile_bytes(const HeightGrid& grid, std::size_t column, std::size_t row, const std::string& file) {
  std::vector<float> pixels(kTile * kTile, kNoHeight);
  const auto width = static_cast<std::size_t>(grid.heights.width),
             height = static_cast<std::size_t>(grid.heights.height);
  for (std::size_t r = row * kTile; r < std::min(height, (row + 1) * kTile); ++r)
    for (std::size_t c = column * kTile; c < std::min(width, (column + 1) * kTile); ++c) {
      const float h = grid.heights.at(static_cast<int>(c), static_cast<int>(r));
      if (std::isfinite(h)) pixels[(r % kTile) * kTile + c % kTile] = h;
    }
  uLongf size = compressBound(pixels.size() * sizeof(float));
  std::string bytes(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(pixels.data()),
                pixels.size() * sizeof(float), 6) != Z_OK)
    throw FileError(file, "its heights cannot be compressed");
  bytes.resize(size);
  return bytes;
}

/// Keys that state the reference system.
void add_geo_keys(TiffDirectory& directory, const ReferenceSystem* system) {
  constexpr std::uint16_t kRasterType = 1025, kPixelIsArea = 1;
  std::vector<std::array<std::uint16_t, 4>> keys;
  if (system && system->geo_keys.size() >= 4) {
    for (std::size_t k = 4; k + 4 <= system->geo_keys.size(); k += 4)
      // Files pad their keys with zeros.
      if (system->geo_keys[k] != 0 && system->geo_keys[k] != kRasterType)
        keys.push_back(
            {system->geo_keys[k], system->geo_keys[k + 1], system->geo_keys[k + 2], system->geo_keys[k + 3]});
  } else if (system && system->code > 0 && system->code < 65536) {
    const bool angles = system->unit == "degree";
    keys.push_back({1024, 0, 1, static_cast<std::uint16_t>(angles ? 2 : 1)});
    keys.push_back({static_cast<std::uint16_t>(angles ? 2048 : 3072), 0, 1, static_cast<std::uint16_t>(system->code)});
    if (system->vertical_code > 0 && system->vertical_code < 65536)
      keys.push_back({4096, 0, 1, static_cast<std::uint16_t>(system->vertical_code)});
  }
  keys.push_back({kRasterType, 0, 1, kPixelIsArea});
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint16_t> numbers{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& key : keys) numbers.insert(numbers.end(), key.begin(), key.end());
  directory.add(34735, kShort, numbers);
  if (!system) return;
  if (!system->geo_doubles.empty()) directory.add(34736, kDouble, system->geo_doubles);
  const std::string texts = system->geo_ascii.substr(0, system->geo_ascii.find_last_not_of('\0') + 1);
  if (!texts.empty()) directory.add_text(34737, texts);
}

}  // namespace

void write_height_grid(const std::string& file, const HeightGrid& grid) {
  const std::string ending = io::ending(file);
  if (ending != "tif" && ending != "tiff") throw FileError(file, "height grids are written as .tif");
  if (grid.heights.width <= 0 || grid.heights.height <= 0 || !(grid.cell > 0))
    throw ArgumentError("write_height_grid: the grid has no cells");
  const auto width = static_cast<std::size_t>(grid.heights.width),
             height = static_cast<std::size_t>(grid.heights.height);
  const std::size_t columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
  std::vector<std::string> tiles(columns * rows);
  parallel_for(0, tiles.size(), 1, [&](std::size_t k) { tiles[k] = tile_bytes(grid, k % columns, k / columns, file); });

  TiffDirectory directory;
  const auto put_short = [&](std::uint16_t tag, std::size_t value) {
    directory.add(tag, kShort, std::vector{static_cast<std::uint16_t>(value)});
  };
  directory.add(256, kLong, std::vector{static_cast<std::uint32_t>(width)});
  directory.add(257, kLong, std::vector{static_cast<std::uint32_t>(height)});
  put_short(258, 32), put_short(259, 8), put_short(262, 1), put_short(277, 1), put_short(284, 1);
  put_short(322, kTile), put_short(323, kTile), put_short(339, 3);
  directory.add(33550, kDouble, std::vector<double>{grid.cell, grid.cell, 0});
  directory.add(33922, kDouble, std::vector<double>{0, 0, 0, grid.left, grid.top, 0});
  add_geo_keys(directory, grid.reference.get());
  directory.add_text(42113, "-9999");
  std::vector<std::uint32_t> offsets, sizes;
  std::uint64_t at = 8;
  for (const std::string& t : tiles) {
    offsets.push_back(static_cast<std::uint32_t>(at)), sizes.push_back(static_cast<std::uint32_t>(t.size()));
    at += (t.size() + 1) / 2 * 2;
  }
  if (at + (std::uint64_t{1} << 24) > UINT32_MAX) throw FileError(file, "would exceed 4 GB: use larger cells");
  directory.add(324, kLong, offsets);
  directory.add(325, kLong, sizes);
  std::string head("II*\0", 4);
  const auto start = static_cast<std::uint32_t>(at);
  head.append(reinterpret_cast<const char*>(&start), 4);
  const std::string tail = directory.bytes(start);
  std::vector<std::string_view> parts{head};
  static constexpr char kPad[1] = {0};
  for (const std::string& t : tiles) {
    parts.push_back(t);
    if (t.size() % 2) parts.push_back({kPad, 1});
  }
  parts.push_back(tail);
  io::write_bytes(file, parts);
}

}  // namespace sansmesh::inline v1
