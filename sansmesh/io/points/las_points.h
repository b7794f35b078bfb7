// Decodes the point records of LAS, LAZ and COPC files.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/io/points/las_header.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1::io {

/// The points of whole records of `header.record` bytes, with the attributes documented in io.h. Withheld points are
/// left out with a warning. If no points remain of a selection, the result is empty; of a whole file, it is a
/// FileError. `all`: the records of the whole file if only some are decoded and all are at hand; they show the depth of
/// colours.
PointSet decode_las_points(const Input& in, const LasHeader& header, std::span<const char> records,
                           std::span<const char> all = {});

/// Appends the records whose positions are in the box to `kept`.
void keep_records_in(const LasHeader& header, const Box3& box, std::span<const char> records, std::vector<char>& kept);
bool any_record_in(const LasHeader& header, const Box3& box, std::span<const char> records);

}  // namespace sansmesh::inline v1::io
