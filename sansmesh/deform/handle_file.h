// Handles from files and from registered pairs (docs/formats/handles.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/deform_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Handles as JSON, or as a table (where the text does not begin with a brace): rows px,py,pz,qx,qy,qz and, where there
/// are seven numbers, the weight. `name` is that of the file in errors. A handle without `q` stays where it is.
/// Throws FileError that says which handle or line, which key, and the cause.
std::vector<Handle> parse_handles(const std::string& whole, const std::string& name);
/// The same of a file. Throws FileError.
std::vector<Handle> read_handles(const std::string& file);

/// As JSON, to the last digit.
std::string handles_json(std::span<const Handle> handles);

/// "These vertices of one mesh went to those of the other": registered meshes or clouds, whose vertices correspond by
/// their number. Throws ArgumentError where the numbers of vertices differ, or there is no such vertex.
std::vector<Handle> handles_of_pair(const PointSet& before, const PointSet& after,
                                    std::span<const std::uint32_t> vertices);

/// So many vertices, or all if there are fewer, as far from each other as they can be: each is the farthest from those
/// before it, the first from the mean. Positions that are not finite are left out, and of vertices at the same place
/// one is taken.
std::vector<std::uint32_t> spread_vertices_of(const PointSet& points, std::size_t count);

}  // namespace sansmesh::inline v1
