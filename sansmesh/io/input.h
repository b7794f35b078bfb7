// What the readers share: the bytes of a file, complaints about them, and the assembly of a PointSet from them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/io/io.h"

namespace sansmesh::io {

/// The content of a file: mapped into memory, or unpacked if it is gzipped. Throws FileError where it is missing, a
/// directory, empty, unreadable, damaged (gzip) or expands beyond reason. Another process must not shorten the file
/// while it is mapped.
class FileContent {
 public:
  explicit FileContent(const std::string& file);
  ~FileContent();
  FileContent(const FileContent&) = delete;
  FileContent& operator=(const FileContent&) = delete;

  std::string_view bytes() const { return bytes_; }
  bool gzipped() const { return gzipped_; }

 private:
  void* map_ = nullptr;
  std::size_t map_size_ = 0;
  std::vector<char> owned_;
  std::string_view bytes_;
  bool gzipped_ = false;
};

/// What a reader gets: name (for messages), bytes, and where to put its remarks.
struct Input {
  const std::string& file;
  std::string_view bytes;
  ReadReport& report;

  [[noreturn]] void fail(const std::string& cause) const { throw FileError(file, cause); }
  /// "truncated: 1,234 bytes are missing".
  [[noreturn]] void fail_truncated(std::uint64_t missing_bytes, bool at_least = false) const;
  void warn(const std::string& remark) const { report.warnings.push_back(printable(remark)); }
};

/// 1234567 → "1,234,567".
std::string grouped(std::uint64_t n);

/// Lower-case copy (ASCII).
std::string lower(std::string_view s);

/// The ending of a name in lower case without the dot, and without a final ".gz": "a/B.PLY.gz" → "ply".
std::string ending(const std::string& file);

/// Inflates zlib or gzip data to at most `limit` bytes; returns what came out and whether the stream was whole.
/// Throws FileError on damaged data.
struct Inflated {
  std::vector<char> bytes;
  bool complete = false;
};
Inflated inflate_bytes(const std::string& file, std::string_view packed, std::size_t expected, std::size_t limit);

/// Coordinates beyond this are treated like non-finite ones: their squares would overflow a float.
inline constexpr double largest_coordinate = 1e18;

/// Origin of a cloud in `box`: per axis zero where coordinates are at most 4 diagonals of the box away from zero,
/// else the centre rounded to a power-of-two grid near the size of the box, so that float coordinates stay exact.
Vec3 choose_origin(const Box3& box);

/// Fills in origin and positions from at(i) -> Vec3 (world, double). Positions that are not finite become NaN, to be
/// removed by `finish`.
template <class At>
void place_positions(PointSet& points, std::size_t n, At&& at) {
  const auto usable = [](const Vec3& p) {
    return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
           std::abs(p.z) <= largest_coordinate;
  };
  const std::size_t chunk = 1 << 15;
  const Box3 box = parallel_reduce(
      n, chunk, Box3{},
      [&](std::size_t first, std::size_t last) {
        Box3 b;
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 p = at(i);
          if (usable(p)) b.extend(p);
        }
        return b;
      },
      [](Box3 a, const Box3& b) { return a.extend(b), a; });
  points.origin = box.empty() ? Vec3{} : choose_origin(box);
  points.positions.resize(n);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  parallel_for(0, n, chunk, [&](std::size_t i) {
    const Vec3 p = at(i);
    points.positions[i] = usable(p) ? Vec3f(p - points.origin) : Vec3f{nan, nan, nan};
  });
}

/// Last step of every reader: checks the triangles' indices, drops non-finite points (with a warning) and the
/// triangles on them, makes normals unit (zero where they have no direction) and removes attributes that say nothing.
/// Throws FileError if no points remain or an index is out of range.
void finish(const Input& in, PointSet& points);

/// Marks the whole cloud as one scan whose scanner stands far away in direction `towards` (unit): parallel rays.
void set_scanner(PointSet& points, const Vec3& towards);

/// 0..255 from values of any scale: `largest` is the largest value met (≤ 1: fractions if `fractional`, > 255:
/// 16 bits).
inline std::uint8_t to_byte(double value, double scale) {
  const double v = value * scale + 0.5;
  return static_cast<std::uint8_t>(v >= 255 ? 255 : v > 0 ? v : 0);
}

/// Factor that brings colour values whose largest is `largest` to 0..255.
inline double color_scale(double largest, bool fractional) {
  return fractional && largest <= 1.0 ? 255.0 : largest > 255.5 ? 255.0 / 65535.0 : 1.0;
}

// One reader a format.
PointSet read_ply(const Input& in);
PointSet read_obj(const Input& in);
PointSet read_off(const Input& in);
PointSet read_stl(const Input& in);
PointSet read_table(const Input& in);
PointSet read_pcd(const Input& in);
PointSet read_las(const Input& in);
PointSet read_vtp(const Input& in);
PointSet read_conf(const Input& in);

}  // namespace sansmesh::io
