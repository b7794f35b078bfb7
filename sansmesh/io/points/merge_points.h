// Merges several clouds.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/io.h"

namespace sansmesh::inline v1::io {

/// Joins the clouds of several files in order. All have the same origin and are consumed. See read_merged. Remarks name
/// the files and are added to the report. Throws FileError if there are too many points.
PointSet merge_points(const std::vector<std::string>& files, std::vector<PointSet> parts, ReadReport& report);

/// Origin that a file with all these points would have. All parts have the same origin and are not empty.
Vec3 common_origin(std::span<const PointSet> parts);

/// The same from the boxes in the headers of LAS files, which may be wrong; empty for other files. `selected`: the box
/// of the points to read.
std::optional<Vec3> stated_origin(const std::vector<std::string>& files, const std::optional<Box3>& selected = {});

}  // namespace sansmesh::inline v1::io
