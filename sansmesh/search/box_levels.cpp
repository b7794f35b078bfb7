#include "sansmesh/search/box_levels.h"

#include <limits>

namespace sansmesh::inline v1 {

BoxLevels box_levels(std::vector<Box3f> boxes) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return eight_wide_levels<BoxNode>(std::move(boxes),
                                    [](std::span<const Box3f> siblings, std::size_t /*level*/, BoxNode& node) {
                                      Box3f whole;
                                      for (std::size_t c = 0; c < kTreeWidth; ++c) {
                                        const bool used = c < siblings.size();
                                        for (std::size_t k = 0; k < 3; ++k) {
                                          node.lower[k][c] = used ? siblings[c].lower[k] : kInfinity;
                                          node.upper[k][c] = used ? siblings[c].upper[k] : -kInfinity;
                                        }
                                        if (used) whole.extend(siblings[c]);
                                      }
                                      return whole;
                                    });
}

}  // namespace sansmesh::inline v1
