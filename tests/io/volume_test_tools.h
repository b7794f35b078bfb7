// Common tools of volume tests: positions of a block's points of any kind, and bytes of files.
#pragma once

#include <string>
#include <vector>

#include "io_test_tools.h"
#include "sansmesh/io/grids/read_volume.h"

namespace sansmesh::test {

inline std::size_t point_count(const GridBlock& b) {
  return b.kind == GridKind::lattice ? b.axes[0].size() * b.axes[1].size() * b.axes[2].size() : b.points.size();
}

inline Vec3 place(const GridBlock& b, std::size_t i) {
  if (b.kind != GridKind::lattice) return b.points[i];
  const std::size_t nx = b.axes[0].size(), ny = b.axes[1].size();
  return b.origin + b.directions[0] * b.axes[0][i % nx] + b.directions[1] * b.axes[1][i / nx % ny] +
         b.directions[2] * b.axes[2][i / (nx * ny)];
}

inline double number(const AttributeTable& table, const std::string& name, std::size_t i) {
  const Attribute* const a = table.find(name);
  if (!a || i >= a->size()) {
    ADD_FAILURE() << "no number " << i << " of an array " << name;
    return 0;
  }
  return a->number(i);
}

/// The numbers as bytes of type T.
template <class T>
std::string packed(const std::vector<double>& numbers, bool big_endian = false) {
  std::string bytes;
  for (const double v : numbers) bytes += raw(static_cast<T>(v), big_endian);
  return bytes;
}

inline std::string expect_no_volume(const std::string& file, const std::string& part,
                                    const VolumeReadOptions& options = {}) {
  return expect_file_error(file, part, [&] { read_volume(file, options); });
}

/// Reads a possibly damaged file; only FileError and ArgumentError are accepted. True if it could be read.
inline bool volume_readable(const std::string& file) {
  try {
    const GridData data = read_volume(file);
    for (const GridBlock& b : data.blocks) {
      EXPECT_NO_THROW(b.point_arrays.check_rows(point_count(b), "points"));
      EXPECT_TRUE(b.hidden_points.empty() || b.hidden_points.size() == point_count(b));
      for (const std::uint32_t c : b.cells.corners) EXPECT_LT(c, b.points.size());
    }
    return true;
  } catch (const FileError& e) {
    EXPECT_TRUE(is_clean(e.what())) << e.what();
  } catch (const ArgumentError& e) {
    EXPECT_STRNE(e.what(), "");
  } catch (const std::exception& e) {
    ADD_FAILURE() << file << ": another exception: " << e.what();
  }
  return false;
}

}  // namespace sansmesh::test
