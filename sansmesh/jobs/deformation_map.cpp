// A deformation as a map of displacements.
#include <utility>

#include "sansmesh/deform.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/error.h"
#include "sansmesh/field/map_stretch.h"
#include "sansmesh/jobs/deform_parts.h"
#include "sansmesh/jobs/with_name.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMapMargin = 0.1;  // of the diagonal
constexpr int kUsualMapNodes = 64;

}  // namespace

const OptionSchema& DeformationMapOptions::schema() {
  using O = DeformationMapOptions;
  static constexpr OptionRow rows[] = {
      option<&O::nodes>({.text = "Writes the map instead (-o MAP.vti), with so many nodes along the longest side",
                         .range = {2, 1024},
                         .name = "displacement_map"}),
      option<&O::box>({.text = "What it covers", .from_data = "where what is deformed comes to lie"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before, const std::string& name,
                                     const DeformationMapOptions& options, Progress& progress) {
  validate_options(options);
  if (!is_finite(before.lower) || !is_finite(before.upper) || before.empty())
    throw ArgumentError("`displacement_map` needs an input that ends somewhere, for its box");
  const DeformationMaps maps = deformation.at(1);
  const Box3 box = options.box ? *options.box : with_name(name, [&] {
    return with_room(box_before(*maps.backward, before, deformation.box_of(maps, before)), kMapMargin);
  });
  const DisplacementMap map =
      displacement_map(*maps.backward, box,
                       lattice_sizes(box, static_cast<std::size_t>(options.nodes.value_or(kUsualMapNodes))), progress);
  FoldWatch folds;
  folds.look(*maps.backward, box, progress);
  DeformationMapResult result{displacement_block(map), folds.worst(), {}};
  folds.add_note(name, result.notes);
  return result;
}

Box3 bounds_of(const PointSet& points) {
  Box3 box;
  for (const Vec3f& p : points.positions)
    if (is_finite(p)) box.extend(points.origin + Vec3(p));
  return box;
}

}  // namespace sansmesh::inline v1
