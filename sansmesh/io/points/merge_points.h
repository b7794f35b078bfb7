// Several clouds as one.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/io.h"

namespace sansmesh::inline v1::io {

/// The clouds of several files, one after the other; all of them have the same origin and are there for the taking.
/// See read_merged. Remarks name the files and go to the report. Throws FileError where they are too many points.
PointSet merge_points(const std::vector<std::string>& files, std::vector<PointSet> parts, ReadReport& report);

}  // namespace sansmesh::inline v1::io
