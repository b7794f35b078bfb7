#include "sansmesh/render/volume/brick_cracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sansmesh::inline v1::detail {
namespace {

/// The brick that covers a position given in bricks of a level, or −1 if there are finer ones or none.
std::int32_t coarser_at(const BakedBricks& s, const std::array<int, 3>& at, int level) {
  std::size_t index = 0;
  for (std::size_t k = 3; k-- > 0;) {
    if (at[k] < 0 || at[k] >= s.counts[k] << level) return -1;
    index = index * static_cast<std::size_t>(s.counts[k]) + static_cast<std::size_t>(at[k] >> level);
  }
  std::int32_t branch = s.branches[index];
  for (int below = level - 1; branch >= 0; --below) {
    if (below < 0) return -1;
    branch = s.branches[static_cast<std::size_t>(branch) + static_cast<std::size_t>((at[0] >> below & 1) |
                                                                                    (at[1] >> below & 1) << 1 |
                                                                                    (at[2] >> below & 1) << 2)];
  }
  return s.bricks[static_cast<std::size_t>(~branch)].level < level ? ~branch : -1;
}

/// Value and gradient of a brick at a node of a finer one.
std::array<float, 4> between(const BakedBricks& s, const BakedBrick& coarse, std::size_t slot, const BakedBrick& fine,
                             const std::array<int, 3>& node) {
  double f[3];
  int cell[3];
  for (std::size_t k = 0; k < 3; ++k) {
    // In cells of the coarse one; exact, because all factors are powers of two.
    const double scale = std::ldexp(1.0, coarse.level - fine.level);
    const double at = (static_cast<double>(fine.at[k]) * kBrickCells + node[k]) * scale -
                      static_cast<double>(coarse.at[k]) * kBrickCells;
    cell[k] = std::clamp(static_cast<int>(at), 0, kBrickCells - 1);
    f[k] = std::clamp(at - cell[k], 0.0, 1.0);
  }
  std::array<double, 4> sum{};
  for (int c = 0; c < 8; ++c) {
    const double w = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
    if (w == 0) continue;
    const float* from = s.nodes.data() + slot * kBrickSize +
                        4 * node_at(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2 & 1));
    for (std::size_t k = 0; k < 4; ++k) sum[k] += w * static_cast<double>(from[k]);
  }
  return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2]),
          static_cast<float>(sum[3])};
}

}  // namespace

void close_cracks(BakedBricks& s) {
  std::vector<std::size_t> order(s.bricks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return s.bricks[a].level < s.bricks[b].level; });
  for (const std::size_t b : order) {
    const BakedBrick& brick = s.bricks[b];
    std::array<std::int32_t, 27> coarser;
    coarser.fill(-1);
    bool any = false;
    for (int d = 0; d < 27; ++d) {
      if (d == 13) continue;
      coarser[static_cast<std::size_t>(d)] =
          coarser_at(s, {brick.at[0] + d % 3 - 1, brick.at[1] + d / 3 % 3 - 1, brick.at[2] + d / 9 - 1}, brick.level);
      any = any || coarser[static_cast<std::size_t>(d)] >= 0;
    }
    if (!any) continue;
    const auto side = [](int i) { return i == 0 ? -1 : i == kBrickCells ? 1 : 0; };
    for (int k = 0; k < kBrickNodes; ++k)
      for (int j = 0; j < kBrickNodes; ++j)
        for (int i = 0; i < kBrickNodes; ++i) {
          const int sides[3] = {side(i), side(j), side(k)};
          if (sides[0] == 0 && sides[1] == 0 && sides[2] == 0) continue;
          std::int32_t found = -1;
          for (int c = 1; c < 8; ++c) {
            const int dx = c & 1 ? sides[0] : 0, dy = c & 2 ? sides[1] : 0, dz = c & 4 ? sides[2] : 0;
            const std::int32_t other = coarser[static_cast<std::size_t>(13 + dx + 3 * dy + 9 * dz)];
            if (other < 0) continue;
            const int level = s.bricks[static_cast<std::size_t>(other)].level;
            if (found < 0 || level < s.bricks[static_cast<std::size_t>(found)].level) found = other;
          }
          if (found < 0) continue;
          const auto slot = static_cast<std::size_t>(found);
          const std::array<float, 4> value = between(s, s.bricks[slot], slot, brick, {i, j, k});
          const std::size_t at = b * kBrickSize + 4 * node_at(i, j, k);
          std::array<float, 4> before;
          std::copy_n(s.nodes.begin() + static_cast<std::ptrdiff_t>(at), 4, before.begin());
          s.hanging.emplace_back(at, before);
          std::copy(value.begin(), value.end(), s.nodes.begin() + static_cast<std::ptrdiff_t>(at));
        }
  }
}

}  // namespace sansmesh::inline v1::detail
