// Vectors whose components are separate arrays.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// Adds an array of vectors to each block that has its components as arrays of one number, of points or of cells:
/// "vx,vy,vz", which is its name, too. Does nothing if an array has that name, or if a component does not exist.
void join_arrays(GridData& data, const std::string& names);

/// Names of the components of vectors, for join_arrays: names that differ in the letter x, y or z, or u, v and w.
/// Velocities go first, three components before two. Empty if there are none.
std::string vector_components(std::span<const DatasetArray> arrays);

/// The summary of the array that join_arrays adds; nothing if a component does not exist.
std::optional<DatasetArray> joined_array(std::span<const DatasetArray> arrays, const std::string& names);

}  // namespace sansmesh::inline v1
