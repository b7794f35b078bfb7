// Compresses point records to LAZ.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sansmesh/io/laz/laz_layout.h"

namespace sansmesh::inline v1::io::laz {

/// The bytes of a LAZ file from its points on, in parts: position of the chunk table, chunks, table. `position` is that
/// of the first byte in the file. put(first, last, out) writes the records of points [first, last). `first`: the first
/// point of each chunk, and the number of points. The layout has variable chunks.
std::vector<std::string> laz_chunks(const LazLayout& layout, const std::vector<std::size_t>& first,
                                    std::size_t position,
                                    const std::function<void(std::size_t, std::size_t, char*)>& put);
/// The same with chunks of layout.chunk_points points.
std::vector<std::string> laz_points(const LazLayout& layout, std::size_t count, std::size_t position,
                                    const std::function<void(std::size_t, std::size_t, char*)>& put);

}  // namespace sansmesh::inline v1::io::laz
