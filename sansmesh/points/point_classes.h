// Classes of the points of surveys (ground, building, …): names, and the choice of points by them.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sansmesh/attribute_table.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// The attribute that holds the class of each point, by its name in some capitals or other: classification (LAS, PDAL),
/// scalar_Classification (CloudCompare) or class, of one component. Null if there is none.
const Attribute* find_point_classes(const PointSet& points);

/// How many points there are of each class; numbers that are no class count nowhere.
std::array<std::size_t, 256> count_point_classes(const Attribute& classification);

/// Keeps the points of these classes, with all that belongs to them. Throws DataError where the points have no class,
/// and where none is left, with the classes that there are.
void keep_classes(PointSet& points, const PointClasses& classes);

}  // namespace sansmesh::inline v1
