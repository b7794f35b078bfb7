// Value, gradient and curvature of a function at places.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/field/level_set_curvature.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct ProbeFunctionReport {
  std::size_t points = 0;
  std::size_t inside = 0;
  // Of the distances from the surface, about (length).
  double mean = 0, median = 0, largest = 0;
  double largest_gradient = 0;

  static const ReportSchema& schema();
};

struct ProbedPlace : LevelSetPoint {
  Vec3 at;

  static const ReportSchema& schema();
};

struct ProbeFunctionResult {
  /// A place each: about the distance to the surface, negative inside, and the level set through the place; in the unit
  /// of the input.
  std::vector<ProbedPlace> values;
  ProbeFunctionReport report;

  /// As the attributes value, gradient_x, gradient_y, gradient_z, k1 and k2.
  void add_to(AttributeTable& attributes) const;
};

/// At places in the input's coordinates. Throws Cancelled.
ProbeFunctionResult probe_function(const SurfaceFunction& function, std::span<const Vec3> places, Progress& progress);

/// Positions of points in coordinates of the input.
std::vector<Vec3> places_of(const PointSet& points);

}  // namespace sansmesh::inline v1
