// What all volumes must hold to, whatever grid they come from.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/volume/assemble_volume.h"
#include "sansmesh/volume/cell_geometry.h"
#include "sansmesh/volume/reconstruction.h"
#include "volume/volume_grids.h"

namespace sansmesh::test {

/// A grid of each kind, of values of points and of cells.
struct NamedGrid {
  std::string name;
  GridData data;
  Association association = Association::points;
};

inline std::vector<NamedGrid> all_grids(const VolumeFunction& f) {
  std::vector<std::pair<std::string, GridData>> grids;
  grids.emplace_back("lattice", lattice_grid({6, 5, 7}, f));
  grids.emplace_back("stretched", stretched_grid({7, 6, 5}, f));
  grids.emplace_back("bent", bent_grid({6, 7, 5}, f, 1.4));
  grids.emplace_back("o-grid", o_grid({17, 5, 6}, f));
  grids.emplace_back("tetrahedra", tetrahedra_grid({5, 4, 6}, f));
  grids.emplace_back("tetrahedra of an o-grid", one_block(tetrahedra_of(o_grid_block({13, 4, 5})), f));
  grids.emplace_back("mixed", mixed_grid({7, 4, 4}, f));
  grids.emplace_back("abutting", abutting_blocks(5, 5, f));
  std::vector<NamedGrid> all;
  for (auto& [name, data] : grids)
    for (const Association a : {Association::points, Association::cells})
      all.push_back({name + (a == Association::cells ? ", cells" : ""), data, a});
  return all;
}

inline std::shared_ptr<const SampledVolume> volume_of(const GridData& data, Association a = Association::points) {
  Progress progress;
  return std::make_shared<const SampledVolume>(assemble_volume(data, a, progress));
}

inline std::unique_ptr<VolumeField> field_of(std::shared_ptr<const SampledVolume> volume, ReconstructionMethod method) {
  Progress progress;
  ReconstructionOptions options;
  options.method = method;
  return reconstruct_volume(std::move(volume), "f", options, progress);
}

/// Random places within random cells, not nearer to faces than a hundredth. At lattices places between the ends.
inline std::vector<Vec3> places_within(const SampledVolume& volume, std::size_t count, unsigned seed = 5) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Vec3> places;
  while (places.size() < count) {
    if (volume.lattice) {
      Vec3 a;
      for (std::size_t k = 0; k < 3; ++k)
        a[k] = volume.lattice->lower[k] + (volume.lattice->upper[k] - volume.lattice->lower[k]) * uniform();
      places.push_back(volume.lattice->from_axes(a));
      continue;
    }
    const std::size_t cell = random() % volume.cells.size();
    const CellShape shape = volume.cells.shapes[cell];
    Vec3 u{0.01 + 0.98 * uniform(), 0.01 + 0.98 * uniform(), 0.01 + 0.98 * uniform()};
    if (shape == CellShape::tetrahedron) u = u / (1.02 + u.x + u.y + u.z);
    if (shape == CellShape::wedge) u = {u.x * (1 - u.y), u.y, u.z};
    std::array<double, 8> weights;
    shape_functions(shape, u, weights);
    Vec3 sum;
    for (std::size_t c = 0; c < volume.cells[cell].size(); ++c)
      sum += volume.corner(volume.cells[cell][c]) * weights[c];
    places.push_back(sum);
  }
  return places;
}

}  // namespace sansmesh::test
