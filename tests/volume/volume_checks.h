// Common checks of volumes from all kinds of grids.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "volume/higher_order_grids.h"
#include "volume/volume_grids.h"
#include "volume/volume_points.h"

namespace sansmesh::test {

/// A grid of each kind, with point values and cell values.
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
  all.push_back({"quadratic tetrahedra", higher_order_grid({HigherOrderFamily::tetrahedron, 3, 2, bend}, f)});
  all.push_back({"bent quadratic hexahedra", higher_order_grid({HigherOrderFamily::hexahedron, 3, 2, bend, false}, f)});
  for (auto& [name, data] : grids)
    for (const Association a : {Association::points, Association::cells})
      all.push_back({name + (a == Association::cells ? ", cells" : ""), data, a});
  all.push_back({"cut hexahedra, cells", cut_grid({6, 5, 7}, f), Association::cells});
  return all;
}

inline std::shared_ptr<const SampledVolume> volume_of(const GridData& data, Association a = Association::points) {
  Progress progress;
  return std::make_shared<const SampledVolume>(assemble_volume(data, a, progress));
}

inline std::unique_ptr<VolumeField> field_of(std::shared_ptr<const SampledVolume> volume, const std::string& method) {
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = method;
  if (volume->in_cells) options.cell_values = CellValues::centres;  // where set_function() evaluates
  return reconstruct_volume(std::move(volume), "f", options, progress);
}

/// Mean and largest error of a field at points.
struct Errors {
  double mean = 0, most = 0;
};
inline Errors errors_of(const VolumeField& field, const std::vector<Vec3>& x, const VolumeFunction& f) {
  std::vector<double> values(x.size());
  field.evaluate(x, {values});
  Errors errors;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double e = std::abs(values[i] - f(x[i]));
    errors.mean += e / static_cast<double>(x.size());
    errors.most = std::max(errors.most, e);
  }
  return errors;
}

inline double mean_error(const VolumeField& field, const std::vector<Vec3>& x, const VolumeFunction& f) {
  return errors_of(field, x, f).mean;
}

/// The same volume with function values at its samples as "f". (Cell values are otherwise at the means of the corners,
/// where some cells do not have their samples.)
inline std::shared_ptr<const SampledVolume> with_values_at_samples(SampledVolume volume, const VolumeFunction& f) {
  std::vector<double> values;
  for (std::size_t i = 0; i < volume.size(); ++i) values.push_back(f(volume.position(i)));
  volume.attributes.set("f", std::move(values));
  return std::make_shared<const SampledVolume>(std::move(volume));
}

/// Number of gradients at x that differ by 0.02 or more from central differences of the values, 1e-3 to each side.
inline std::size_t wrong_gradients(const VolumeField& field, const std::vector<Vec3>& x) {
  std::vector<double> unused(x.size());
  std::vector<Vec3> gradients(x.size());
  field.evaluate(x, {unused, gradients});
  const double h = 1e-3;
  std::vector<Vec3> around;
  for (const Vec3& p : x)
    for (std::size_t k = 0; k < 6; ++k) {
      around.push_back(p);
      around.back()[k / 2] += k % 2 == 0 ? h : -h;
    }
  std::vector<double> values(around.size());
  field.evaluate(around, {values});
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double* v = values.data() + 6 * i;
    const Vec3 d = Vec3{v[0] - v[1], v[2] - v[3], v[4] - v[5]} / (2 * h);
    wrong += !(norm(d - gradients[i]) < 0.02);
  }
  return wrong;
}

}  // namespace sansmesh::test
