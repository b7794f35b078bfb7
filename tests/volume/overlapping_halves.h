// Two overlapping blocks of a structured one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sansmesh/grid_data.h"
#include "volume/volume_grids.h"

namespace sansmesh::test {

/// Six tenths of a structured block from its first end along i, and six tenths from the last, whose inner points are
/// moved by `shift` cells along each axis: in the overlap the blocks' points nearly coincide for small shifts.
inline std::vector<GridBlock> overlapping_halves(const GridBlock& whole, double shift) {
  const auto n = block_dims(whole);
  const auto cut = [&](std::size_t first, std::size_t last, double by) {
    GridBlock part;
    part.kind = GridKind::curvilinear;
    part.dims = {last - first, n[1], n[2]};
    for (std::size_t k = 0; k < n[2]; ++k)
      for (std::size_t j = 0; j < n[1]; ++j)
        for (std::size_t i = first; i < last; ++i) {
          const std::array<std::size_t, 3> at{i, j, k};
          std::array<std::size_t, 3> low{};
          std::array<double, 3> share{};
          for (std::size_t a = 0; a < 3; ++a) {
            // Not on the surface of the whole block, which stays as it is.
            const bool inner = at[a] > 0 && at[a] + 1 < n[a];
            low[a] = inner ? at[a] : std::min(at[a], n[a] - 2);
            share[a] = inner ? by : static_cast<double>(at[a] - low[a]);
          }
          Vec3 x;
          for (std::size_t c = 0; c < 8; ++c) {
            double weight = 1;
            std::size_t p = 0, stride = 1;
            for (std::size_t a = 0; a < 3; ++a) {
              const std::size_t up = c >> a & 1u;
              weight *= up != 0 ? share[a] : 1 - share[a];
              p += (low[a] + up) * stride, stride *= n[a];
            }
            x += block_point(whole, p) * weight;
          }
          part.points.push_back(x);
        }
    return part;
  };
  const auto share = [&](double of) { return static_cast<std::size_t>(std::lround(of * static_cast<double>(n[0]))); };
  return {cut(0, share(0.6), 0), cut(share(0.4), n[0], shift)};
}

}  // namespace sansmesh::test
