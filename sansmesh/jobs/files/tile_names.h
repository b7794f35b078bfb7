// Names and limits of square tiles.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// Largest number of tiles of a height grid.
inline constexpr std::size_t kMostTiles = 10'000;

/// Throws DataError beyond `most` tiles.
void check_tile_count(double tiles, double most);

/// Throws DataError if two tiles have the same place: files would overwrite each other.
void check_corners(std::vector<std::string> corners);

/// "512000_5403000": corner of a tile.
std::string corner_words(double left, double bottom);

}  // namespace sansmesh::inline v1
