#include "solid_input.h"

namespace sansmesh::cli {

SolidModel open_solid(const std::string& expression, Console& console) {
  SolidModel solid = read_solid(expression, console.progress());
  console.note(expression, solid.notes());
  return solid;
}

}  // namespace sansmesh::cli
