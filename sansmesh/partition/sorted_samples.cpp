#include "sansmesh/partition/sorted_samples.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

Box3f set_root_cube(const PointSet& points, PartitionData& data) {
  if (points.size() < 4) throw DataError("partition of unity: at least 4 points are needed");
  if (points.normals.size() != points.size()) throw DataError("partition of unity: points need oriented normals");
  const Box3f box = bounds(points);
  const float extent = std::max({box.size().x, box.size().y, box.size().z});
  if (!(extent > 0)) throw DataError("partition of unity: all points coincide");
  data.origin = points.origin;
  data.edge = 1.1f * extent;
  data.lower = box.center() - Vec3f{1, 1, 1} * (0.5f * data.edge);
  return box;
}

SampleTree sort_samples(PointSet& points, const PartitionData& data, PointSet* sorted) {
  SampleTree tree(std::move(points.positions), std::move(points.normals), data.lower, data.edge, data.basis.sort_depth);
  const std::vector<std::uint32_t> order = tree.take_order();
  if (!sorted) return tree;
  *sorted = PointSet{};
  sorted->origin = points.origin;
  if (points.has_colors()) {
    sorted->colors.resize(order.size());
    parallel_for(0, order.size(), 16384, [&](std::size_t i) { sorted->colors[i] = points.colors[order[i]]; });
    points.colors = {};
  }
  return tree;
}

void take_samples(SampleTree& tree, PointSet* sorted) {
  if (!sorted) return;
  sorted->positions = tree.take_positions();
  sorted->normals = tree.take_normals();
}

}  // namespace sansmesh::inline v1
