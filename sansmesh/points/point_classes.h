// Classes of the points of surveys (ground, building, …): names, and the choice of points by them.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Classes 0 to 255, numbered as in the LAS specification of the ASPRS: below 64 as there, above as the user defines
/// them.
using PointClasses = std::bitset<256>;

/// Reads a list with commas: numbers, ranges of them ("3-5") and names, in lower or upper case, of one class ("ground")
/// or of several ("vegetation": 3 to 5, "noise": 7 and 18, "wire": 13, 14 and 16). Throws ArgumentError, which lists
/// the names, for what is none of them.
PointClasses parse_point_classes(std::string_view list);

/// "2,3-5": what parse_point_classes reads as these classes.
std::string point_classes_text(const PointClasses& classes);

/// "ground"; empty for classes without a name.
std::string_view point_class_name(unsigned number);

/// The attribute that holds the class of each point, by its name in some capitals or other: classification (LAS, PDAL),
/// scalar_Classification (CloudCompare) or class, of one component. Null if there is none.
const Attribute* find_point_classes(const PointSet& points);

/// How many points there are of each class; numbers that are no class count nowhere.
std::array<std::size_t, 256> count_point_classes(const Attribute& classification);

/// Keeps the points of these classes, with all that belongs to them. Throws DataError where the points have no class,
/// and where none is left, with the classes that there are.
void keep_classes(PointSet& points, const PointClasses& classes);

}  // namespace sansmesh::inline v1
