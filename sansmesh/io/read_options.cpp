
#include "sansmesh/io.h"

namespace sansmesh::inline v1 {

const OptionSchema& ReadOptions::schema() {
  using O = ReadOptions;
  static constexpr OptionRow rows[] = {
      option<&O::box>({.text = "Read only the points in this box, in the coordinates of the file: x0,y0,z0,x1,y1,z1",
                       .unit = "length",
                       .from_data = "all points",
                       .name = "read_box"}),
      option<&O::resolution>({.text = "Of COPC files, read only the levels that this distance of points needs",
                              .unit = "length",
                              .from_data = "all levels",
                              .range = positive(),
                              .name = "read_spacing"})};
  static constexpr OptionSchema all{rows};
  return all;
}

}  // namespace sansmesh::inline v1
