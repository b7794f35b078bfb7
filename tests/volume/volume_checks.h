// What all volumes must hold to, whatever grid they come from.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/volume/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "volume/volume_grids.h"
#include "volume/volume_places.h"

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
  grids.emplace_back("abutting, unlike", abutting_blocks(5, 7, f));
  grids.emplace_back("two levels", two_level_amr(8, f));
  grids.emplace_back("overlapping", three_overlapping_blocks(6, f));
  std::vector<NamedGrid> all;
  all.push_back({"scattered", scattered_grid(400, f)});
  // Many points on common spheres.
  GridBlock points = lattice_block({6, 6, 6});
  GridBlock cospherical;
  cospherical.kind = GridKind::scattered;
  for (std::size_t i = 0; i < block_point_count(points); ++i) cospherical.points.push_back(block_point(points, i));
  all.push_back({"scattered lattice", one_block(cospherical, f)});
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

}  // namespace sansmesh::test
