#include "sansmesh/jobs/files/tile_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

void check_tile_count(double tiles, double most) {
  if (!(tiles <= most))
    throw DataError(fmt::format("there are more than {:.0f} tiles: `tile_size` is too small", most));
}

void check_corners(std::vector<std::string> corners) {
  std::sort(corners.begin(), corners.end());
  const auto equal = std::adjacent_find(corners.begin(), corners.end());
  if (equal != corners.end())
    throw DataError("there are two tiles with the same corner " + *equal +
                    " in 12 digits: `tile_size` is too small for these coordinates");
}

std::string corner_words(double left, double bottom) {
  return fmt::format("{:.12g}_{:.12g}", left + 0.0, bottom + 0.0);  // no -0
}

}  // namespace sansmesh::inline v1
