// Options of reading files of volumes.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/option.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// How the numbers of a file without a header lie in it: the first axis runs fastest, the components of a point stand
/// side by side.
struct SANSMESH_API RawLayout {
  /// Numbers of points along the axes, at least 1 each; all 0: nobody said so, and nothing else means anything.
  std::array<std::size_t, 3> dims{};
  NumberType type = NumberType::u8;
  std::size_t components = 1;    ///< of each point, at least 1
  Vec3 spacing{1, 1, 1};         ///< of the points (length), > 0
  bool big_endian = false;       ///< byte order of the numbers
  std::size_t header_bytes = 0;  ///< that come before them

  bool given() const { return dims != std::array<std::size_t, 3>{}; }
  static const OptionSchema& schema();  ///< a row a field
};

/// Which numbers count as missing besides NaN and infinite ones.
struct SANSMESH_API FillValueOptions {
  std::vector<double> values;  ///< wherever they occur; finite
  /// Also the usual ones where they stand clearly apart from all other numbers of the array: NetCDF's defaults
  /// (9.96921e36, and of signed integers of 16, 32 and 64 bits the least ones), the largest float and double, a power
  /// of ten from 1e20 on, 1.70141e38 (Surfer), 9.999e20 (GRIB), −9.99e8 and −9.99e33 (GrADS), −999, −999.25 (well
  /// logs), −9999, −99999, −999999.
  bool usual = true;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SANSMESH_API VolumeReadOptions {
  RawLayout raw = {};          ///< read the file as that, whatever its name, if it is given
  std::size_t time_step = 0;   ///< of files that hold several, from 0; others have only that one
  std::string solution = {};   ///< PLOT3D: file of the values; empty: looked for beside the grid's
  FillValueOptions fill = {};  ///< numbers that stand for missing ones become NaN; the notes say which

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
