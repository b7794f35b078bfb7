#include "sansmesh/io/grids/time_steps.h"

#include <fmt/core.h>

#include "sansmesh/error.h"

namespace sansmesh::inline v1::io {

void check_time_step(const std::string& file, std::size_t wanted, std::size_t steps) {
  if (wanted < steps || (wanted == 0 && steps == 0)) return;
  throw ArgumentError(fmt::format("`time_step` is {}, but {} has {}", wanted, printable(file, 200),
                                  steps < 2 ? "only one step" : fmt::format("the steps 0 to {}", steps - 1)));
}

}  // namespace sansmesh::inline v1::io
