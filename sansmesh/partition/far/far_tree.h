// Tree of surface patches in groups of eight, with the moments that approximate a distant group.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/search/box_levels.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A small oriented piece of surface: area vector = unit outward normal × area.
struct OrientedPatch {
  Vec3f position;
  Vec3f area;
  /// Least weight in the estimate of the distance (length²): a patch that is much smaller than its neighbours would
  /// make that estimate drop steeply close to it.
  float least = 0;
};

struct FarTree {
  /// Eight siblings side by side. radius < 0 marks an unused slot. The radius of a group contains its members, and its
  /// square is at least twice the weight of its heaviest patch.
  struct Octet {
    float x[kTreeWidth], y[kTreeWidth], z[kTreeWidth], ax[kTreeWidth], ay[kTreeWidth], az[kTreeWidth];
    float area[kTreeWidth], radius[kTreeWidth];
  };
  /// Moments of eight groups side by side: sums over the patches p with area vectors a and weights w, where d is p
  /// minus the group's position and a patch has the variance s = w / 4 along each axis. Symmetric parts only.
  struct Moments {
    float first[6][kTreeWidth];    ///< d ⊗ a: xx, xy, xz, yy, yz, zz
    float second[10][kTreeWidth];  ///< d ⊗ d ⊗ a: xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz
    float turned[3][kTreeWidth];   ///< ⟨d, d⟩ a + 2 ⟨d, a⟩ d + s a
    float spread[6][kTreeWidth];   ///< w d ⊗ d: xx, xy, xz, yy, yz, zz
    float size[kTreeWidth];        ///< w ⟨d, d⟩ + w s
  };

  std::vector<std::vector<Octet>> levels;     ///< eight_wide_levels over the patches
  std::vector<std::vector<Moments>> moments;  ///< moments of the octets of level 1 and above
};

/// Tree of the patches with an area and a finite position, in units of `unit`.
FarTree far_tree(std::span<const OrientedPatch> patches, float unit);

}  // namespace sansmesh::inline v1
