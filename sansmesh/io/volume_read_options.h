// Options of reading files of volumes.
#pragma once

#include <cstddef>
#include <string>

#include "sansmesh/io/fill_values.h"
#include "sansmesh/io/raw_layout.h"
#include "sansmesh/schema/option.h"

namespace sansmesh {

struct VolumeReadOptions {
  RawLayout raw = {};          ///< read the file as that, whatever its name, if it is given
  std::size_t time_step = 0;   ///< of files that hold several, from 0; others have only that one
  std::string solution = {};   ///< PLOT3D: file of the values; empty: looked for beside the grid's
  FillValueOptions fill = {};  ///< numbers that stand for missing ones become NaN; the notes say which

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh
