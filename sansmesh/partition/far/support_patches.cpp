#include "sansmesh/partition/far/support_patches.h"

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

/// Least weight of a support's patch in the far field's distance, in squares of its block's edge.
constexpr float kLeastPatch = 0.5f;

}  // namespace

std::vector<OrientedPatch> support_patches(const PartitionData& data) {
  std::vector<OrientedPatch> patches(data.supports.size());
  parallel_for(0, patches.size(), 8192, [&](std::size_t i) {
    const float h = data.edge / static_cast<float>(1u << data.supports[i].level);
    // Planes that the published method borrowed from elsewhere are no surface.
    const float least = data.paper && data.report.area > 0 && data.supports[i].area == 0 ? 0 : kLeastPatch * h * h;
    patches[i] = {data.supports[i].foot, data.functions[i].nu * data.supports[i].area, least};
  });
  return patches;
}

}  // namespace sansmesh::inline v1
