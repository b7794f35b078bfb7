#include "sansmesh/attribute_table.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/inspect.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/points.h"
#include "sansmesh/points/given_normals.h"
#include "sansmesh/points/noise.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/mesh/sewn_mesh.h"
#include "sansmesh/placement.h"
#include "sansmesh/points/cloud_shape.h"
#include "sansmesh/points/duplicates.h"
#include "sansmesh/points/orientation.h"
#include "sansmesh/points/point_classes.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

const char* shape_words(CloudShape shape) {
  switch (shape) {
    case CloudShape::empty:
      return "empty";
    case CloudShape::point:
      return "a point";
    case CloudShape::line:
      return "a line";
    case CloudShape::plane:
      return "a plane";
    case CloudShape::volume:
      return "a volume";
  }
  return "";
}

/// The shape of a cloud in words, or how far its parts are apart where that hides their shape.
std::string span_words(const PointSet& points) {
  if (const auto parts = find_far_parts(points)) return fmt::format("parts {:.3g} apart", parts->apart);
  return shape_words(classify_shape(points));
}

std::optional<std::pair<double, double>> range_of(const Attribute& a, std::size_t component) {
  std::optional<std::pair<double, double>> range;
  for (std::size_t i = component; i < a.size(); i += a.components) {
    const double v = a.number(i);
    if (!std::isfinite(v)) continue;
    if (!range) range = {v, v};
    range->first = std::min(range->first, v), range->second = std::max(range->second, v);
  }
  return range;
}

void describe(const AttributeTable& table, bool of_triangles, std::vector<AttributeInfo>& described) {
  for (const Attribute& a : table) {
    AttributeInfo info{a.name, of_triangles, a.type(), {}};
    for (std::size_t c = 0; c < a.components; ++c) info.ranges.push_back(range_of(a, c));
    described.push_back(std::move(info));
  }
}

}  // namespace

CloudInfo info(const PointSet& points, Progress& progress) {
  progress.begin("measure");
  CloudInfo info;
  const Box3f box = bounds(points);
  info.points = points.size();
  info.duplicates = points.size() - count_unique(points);
  info.box = Placement{points.origin}.to_input(box);
  info.size = Vec3(box.size());
  info.spans = span_words(points);
  info.spacing = estimate_spacing(points);
  info.noise = measure_noise(points);
  info.normals = judge_normals(points, info.noise.deviation);
  info.orient_by = first_known_orientation(points, info.noise.deviation);
  info.colors = points.has_colors();
  info.scanners = points.scanners.size();
  describe(points.attributes, false, info.attributes);
  describe(points.triangle_attributes, true, info.attributes);
  if (const Attribute* const classes = find_point_classes(points)) info.classes = count_point_classes(*classes);
  info.triangles = points.triangles.size();
  if (info.triangles > 0) info.mesh = sewn_topology(to_mesh(points));
  return info;
}

FunctionInfo info(const SurfaceFunction& told) {
  const FittedFunction& function = told.fitted();
  const PartitionReport& r = function.field.report();
  const Placement& place = function.place;
  FunctionInfo info;
  info.fits = r.functions;
  info.fits_of_degree = r.functions_of_degree;
  info.creased = r.creased;
  info.depth = r.depth;
  info.open_share = r.area > 0 ? std::min(1.0, r.open_area / r.area) : 0;
  info.behind = r.behind;
  info.samples = function.samples->size();
  info.colors = function.samples->has_colors();
  info.cube = place.to_input(function.field.bounds());
  info.spacing = place.to_input(r.spacing);
  info.deviation = place.to_input(r.noise);
  info.accuracy = place.to_input(r.accuracy);
  info.history = function.history;
  info.paper = function.paper;
  return info;
}

}  // namespace sansmesh::inline v1
