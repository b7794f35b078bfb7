// Classes of survey points (ground, building, …): names, and selection by class.
#pragma once

#include <array>
#include <cstddef>

#include "sansmesh/attribute_table.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Attribute with the class of each point, of one component and identified by name, ignoring case: classification (LAS,
/// PDAL), scalar_Classification (CloudCompare) or class. Null if there is none.
const Attribute* find_point_classes(const PointSet& points);

/// Number of points per class; ignores numbers that are not classes.
std::array<std::size_t, 256> count_point_classes(const Attribute& classification);

/// Keeps the points of these classes with their properties. Throws DataError if the points have no classes, or if none
/// is left, with the list of existing classes.
void keep_classes(PointSet& points, const PointClasses& classes);

}  // namespace sansmesh::inline v1
