// Merges several clouds.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/io.h"

namespace sansmesh::inline v1::io {

/// Joins the clouds of several files in order. All have the same origin and are consumed. See read_merged. Remarks name
/// the files and are added to the report. Throws FileError if there are too many points.
PointSet merge_points(const std::vector<std::string>& files, std::vector<PointSet> parts, ReadReport& report);

}  // namespace sansmesh::inline v1::io
