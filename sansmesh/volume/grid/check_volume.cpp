#include "sansmesh/volume/grid/check_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/error.h"
#include "sansmesh/volume/grid/holds_for_all.h"

namespace sansmesh::inline v1 {
namespace {

using detail::holds_for_all;

/// Larger coordinates overflow when squared.
constexpr double kFarthest = 1e100;

bool is_position(const Vec3& x) {
  return std::abs(x.x) <= kFarthest && std::abs(x.y) <= kFarthest && std::abs(x.z) <= kFarthest;
}

void demand(bool right, const char* what) {
  if (!right) throw DataError(what);
}

void check_lattice(const Lattice& lattice) {
  std::size_t size = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double>& axis = lattice.axes[k];
    demand(axis.size() >= 2 && axis.size() <= std::numeric_limits<std::uint32_t>::max() / size,
           "the axes of its lattice have an impossible number of coordinates");
    size *= axis.size();
    bool ascends = std::abs(axis.front()) <= kFarthest && std::abs(axis.back()) <= kFarthest;
    for (std::size_t i = 1; i < axis.size(); ++i) ascends = ascends && axis[i] > axis[i - 1];
    demand(ascends, "an axis of its lattice does not ascend");
    demand(lattice.lower[k] >= -kFarthest && lattice.lower[k] <= axis.front() && lattice.upper[k] <= kFarthest &&
               lattice.upper[k] >= axis.back(),
           "its lattice ends before its samples");
    for (std::size_t m = 0; m < 3; ++m)
      demand(std::abs(dot(lattice.directions[k], lattice.directions[m]) - (k == m ? 1 : 0)) <= 1e-4,
             "the directions of its lattice are not orthonormal");
  }
  demand(is_position(lattice.origin), "the origin of its lattice is invalid");
}

void check_cells(const SampledVolume& volume) {
  const CellList& cells = volume.cells;
  const std::size_t corners = volume.corners.empty() ? volume.positions.size() : volume.corners.size();
  demand(cells.first.size() == cells.size() + 1 && cells.first[0] == 0 && cells.first.back() == cells.corners.size(),
         "its cells do not fit their corners");
  demand(cells.size() <= std::numeric_limits<std::uint32_t>::max() && !cells.empty(),
         "it has an impossible number of cells");
  demand(holds_for_all(cells.size(),
                       [&](std::size_t c) {
                         return cells.shapes[c] <= CellShape::hexahedron &&
                                cells.first[c + 1] - cells.first[c] == corner_count(cells.shapes[c]);
                       }),
         "its cells do not fit their corners");
  demand(holds_for_all(cells.corners.size(), [&](std::size_t k) { return cells.corners[k] < corners; }),
         "a cell has a corner that does not exist");
  demand(volume.corners.empty() == volume.cell_sample.empty() &&
             (volume.cell_sample.empty() || volume.cell_sample.size() == cells.size()),
         "its cells do not fit its samples");
  demand(holds_for_all(volume.cell_sample.size(),
                       [&](std::size_t c) { return volume.cell_sample[c] < volume.positions.size(); }),
         "a cell has a sample that does not exist");
}

void check_higher(const SampledVolume& volume) {
  const HigherOrderCells& higher = volume.higher;
  const std::size_t n = higher.size();
  demand(higher.of_piece.size() == (n == 0 ? 0 : volume.cells.size()) && (n == 0 || volume.corners.empty()) &&
             higher.first.size() == n + 1 && higher.first[0] == 0 && higher.first[n] == higher.nodes.size(),
         "its cells of higher order do not fit their pieces");
  demand(
      holds_for_all(n,
                    [&](std::size_t h) {
                      const std::size_t count = node_count(higher.kinds[h]);
                      return count > 0 && higher.first[h + 1] - higher.first[h] == count;
                    }) &&
          holds_for_all(higher.nodes.size(), [&](std::size_t k) { return higher.nodes[k] < volume.positions.size(); }),
      "a cell of higher order has a wrong number of nodes, or one that does not exist");
  demand(holds_for_all(higher.of_piece.size(),
                       [&](std::size_t c) {
                         const std::uint32_t h = higher.of_piece[c];
                         if (h == HigherOrderCells::kNone) return true;
                         if (h >= n) return false;
                         const auto nodes = higher[h];
                         return std::all_of(volume.cells[c].begin(), volume.cells[c].end(), [&](std::uint32_t k) {
                           return std::find(nodes.begin(), nodes.end(), k) != nodes.end();
                         });
                       }),
         "a piece does not belong to its cell of higher order");
}

void check_stars(const Adjacency& stars, std::size_t n) {
  demand(stars.first.size() == n + 1 && stars.first[0] == 0 && stars.first[n] == stars.entries.size(),
         "the neighbour lists do not fit its samples");
  demand(holds_for_all(n,
                       [&](std::size_t i) {
                         return stars.first[i] <= stars.first[i + 1] && stars.first[i + 1] <= stars.entries.size();
                       }),
         "the neighbour lists do not fit its samples");
  demand(holds_for_all(n,
                       [&](std::size_t i) {
                         const auto star = stars[i];
                         for (std::size_t k = 0; k < star.size(); ++k)
                           if (star[k] >= n || star[k] == i || (k > 0 && star[k] <= star[k - 1])) return false;
                         return true;
                       }),
         "a sample has invalid neighbours");
}

}  // namespace

void check_volume(const SampledVolume& volume) {
  const auto right = [](const auto& list, std::size_t n) { return list.empty() || list.size() == n; };
  if (volume.lattice) {
    check_lattice(*volume.lattice);
    demand(volume.positions.empty() && volume.cells.empty() && volume.corners.empty() && volume.cell_sample.empty() &&
               volume.higher.of_piece.empty() && volume.higher.empty() && volume.stars.size() == 0,
           "it has both a lattice and cells");
  } else {
    const std::size_t n = volume.positions.size();
    demand(n > 0 && n <= std::numeric_limits<std::uint32_t>::max(), "it has an impossible number of samples");
    demand(holds_for_all(n, [&](std::size_t i) { return is_position(volume.positions[i]); }) &&
               holds_for_all(volume.corners.size(), [&](std::size_t i) { return is_position(volume.corners[i]); }),
           "a position is invalid");
    check_cells(volume);
    check_higher(volume);
    check_stars(volume.stars, n);
  }
  const std::size_t n = volume.size();
  demand(right(volume.part, n) && right(volume.block, n) && right(volume.level, n),
         "the parts, blocks or levels of its samples do not fit these");
  for (const Attribute& a : volume.attributes)
    demand(a.rows() == n && a.size() == n * a.components, "an array does not fit its samples");
}

}  // namespace sansmesh::inline v1
