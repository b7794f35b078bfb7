// Names and limits of square tiles.
#pragma once

#include <cstddef>
#include <string>

namespace sansmesh::inline v1 {

/// Largest number of tiles of a height grid.
inline constexpr std::size_t kMostTiles = 10'000;

/// Throws DataError beyond `most` tiles.
void check_tile_count(double tiles, double most);

/// "512000_5403000": corner of a tile.
std::string place_words(double left, double bottom);

}  // namespace sansmesh::inline v1
