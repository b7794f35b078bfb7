// Options of the volume readers.
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

/// Layout of a file of numbers without a header. The first axis varies fastest; the components of a point are adjacent.
struct SANSMESH_API RawLayout {
  /// Numbers of points along the axes, at least 1 each. All 0: no layout is given, and the other fields are ignored.
  std::array<std::size_t, 3> dims{};
  NumberType type = NumberType::u8;  ///< type of every number
  std::size_t components = 1;        ///< per point, at least 1
  Vec3 spacing{1, 1, 1};             ///< distance between points along each axis, > 0
  bool big_endian = false;           ///< byte order of the numbers
  std::size_t header_bytes = 0;      ///< bytes before the first number

  /// Whether a layout is given: `dims` are not all 0.
  bool given() const { return dims != std::array<std::size_t, 3>{}; }
  static const OptionSchema& schema();  ///< one row per field
};

/// Numbers that count as missing, besides NaN and infinite ones.
struct SANSMESH_API FillValueOptions {
  std::vector<double> values;  ///< missing wherever they occur; finite
  /// Also recognises the usual fill values if they are clearly separate from all other numbers of the array: NetCDF's
  /// defaults (9.96921e36, and the least signed integers of 16, 32 and 64 bits), the largest float and double, a power
  /// of ten from 1e20 on, 1.70141e38 (Surfer), 9.999e20 (GRIB), −9.99e8 and −9.99e33 (GrADS), −999, −999.25 (well
  /// logs), −9999, −99999, −999999.
  bool usual = true;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Options of reading one volume.
struct SANSMESH_API VolumeReadOptions {
  RawLayout raw = {};          ///< if given, the file is read as raw numbers, whatever its name
  std::size_t time_step = 0;   ///< index of the step, from 0; files without steps have only step 0
  std::string solution = {};   ///< PLOT3D: file of the values; empty: searched for beside the grid
  FillValueOptions fill = {};  ///< fill values become NaN; the notes list them

  static const OptionSchema& schema();  ///< one row per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
