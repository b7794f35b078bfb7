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

/// Parses handles from JSON or, if the text does not begin with a brace, from a table: rows px,py,pz,qx,qy,qz and an
/// optional weight. `name` is the file name in errors. A handle without `q` is fixed. Throws FileError that names the
/// handle or line, the key and the cause.
std::vector<Handle> parse_handles(const std::string& whole, const std::string& name);
/// As above from a file. Throws FileError.
std::vector<Handle> read_handles(const std::string& file);

/// Handles as JSON, with all digits.
std::string handles_json(std::span<const Handle> handles);

/// Handles from corresponding vertices of two registered meshes or clouds, which have the same index in both. Throws
/// ArgumentError if the numbers of vertices differ, or an index is out of range.
std::vector<Handle> handles_of_pair(const PointSet& before, const PointSet& after,
                                    std::span<const std::uint32_t> vertices);

/// Selects `count` vertices, or all if there are fewer, by farthest-point sampling: the first is the farthest from the
/// mean. Positions that are not finite are left out; of coincident vertices one is taken.
std::vector<std::uint32_t> spread_vertices_of(const PointSet& points, std::size_t count);

}  // namespace sansmesh::inline v1
