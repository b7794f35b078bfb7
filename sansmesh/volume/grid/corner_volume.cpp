#include "sansmesh/volume/grid/corner_volume.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kSpansSpace = 0.05;  ///< smallest pivot of the basis over the largest
constexpr int kMostRings = 3;
constexpr double kFirmWeight = 0.05;  ///< distance, relative to the farthest sample, below which weights are constant

/// The value at `x` of the least-squares linear functions of the samples. Returns false where the samples do not span
/// space, unless `last`: then it uses the minimum-norm solution.
bool fit_straight(const SampledVolume& volume, const VolumeValues& values, const Vec3& x,
                  std::span<const std::uint32_t> near, bool last, double* out) {
  std::vector<Vec3> offsets;
  for (const std::uint32_t s : near) offsets.push_back(volume.positions[s] - x);
  const StarMetric metric = star_metric(offsets, 1);
  const auto rows = static_cast<Eigen::Index>(near.size()), components = static_cast<Eigen::Index>(values.components);
  Eigen::MatrixXd basis(rows, 4), right(rows, components);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const auto at = static_cast<std::size_t>(r);
    const Vec3 u = metric(offsets[at]);
    const double root = 1 / std::max(norm(u), kFirmWeight);
    basis.row(r) << root, root * u.x, root * u.y, root * u.z;
    for (Eigen::Index c = 0; c < components; ++c) right(r, c) = root * values.of(near[at])[static_cast<std::size_t>(c)];
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(kSpansSpace);
  solver.compute(basis);
  if (solver.rank() < 4 && !last) return false;
  const Eigen::MatrixXd solution = solver.solve(right);
  // Without a basis that spans space constants must still be reproduced: use the mean of the samples.
  for (Eigen::Index c = 0; c < components; ++c) out[c] = solution(0, c);
  if (solver.rank() < 4)
    for (Eigen::Index c = 0; c < components; ++c)
      out[c] = right.col(c).sum() / std::max(basis.col(0).sum(), std::numeric_limits<double>::min());
  return true;
}

/// Extends a lattice to its ends; values beyond the outermost samples continue linearly, axis by axis.
CornerSamples to_ends(const SampledVolume& volume, VolumeValues values) {
  auto made = std::make_shared<SampledVolume>();
  made->facts = volume.facts;
  made->lattice = volume.lattice;
  Lattice& lattice = *made->lattice;
  lattice.uniform = false;
  std::size_t before = values.components;  // numbers from one sample to the next along the axis
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double>& axis = lattice.axes[k];
    const std::size_t n = axis.size(), slabs = values.values.size() / (before * n);
    const double first = (axis[0] - lattice.lower[k]) / (axis[1] - axis[0]);
    const double last = (lattice.upper[k] - axis[n - 1]) / (axis[n - 1] - axis[n - 2]);
    if (!(first > 0 && last > 0)) {
      before *= n;
      continue;
    }
    std::vector<double> extended(slabs * (n + 2) * before);
    for (std::size_t s = 0; s < slabs; ++s) {
      const double* const from = values.values.data() + s * n * before;
      double* const to = extended.data() + s * (n + 2) * before;
      std::copy_n(from, n * before, to + before);
      for (std::size_t c = 0; c < before; ++c) {
        const double* const end = from + (n - 1) * before;
        to[c] = from[c] + first * (from[c] - from[before + c]);
        to[(n + 1) * before + c] = end[c] + last * (end[c] - *(end + c - before));
      }
    }
    values.values = std::move(extended);
    axis.insert(axis.begin(), lattice.lower[k]);
    axis.push_back(lattice.upper[k]);
    before *= n + 2;
  }
  return {std::move(made), std::move(values)};
}

}  // namespace

CornerSamples corner_samples(std::shared_ptr<const SampledVolume> volume, VolumeValues values) {
  if (volume->lattice && volume->in_cells) return to_ends(*volume, std::move(values));
  if (volume->lattice || volume->cell_sample.empty()) return {std::move(volume), std::move(values)};
  auto made = std::make_shared<SampledVolume>();
  made->positions = volume->corners;
  made->cells = volume->cells;
  made->stars = edge_neighbours(made->cells, made->positions.size());
  made->facts = volume->facts;
  VolumeValues at_corners;
  at_corners.name = values.name;
  at_corners.components = values.components;
  at_corners.values.assign(made->size() * values.components, 0);
  const Adjacency cells = cells_of_points(made->cells, made->size());
  parallel_ranges(0, made->size(), 128, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    const auto unique = [&] {
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
    };
    for (std::size_t i = first; i < last; ++i) {
      near.clear();
      for (const std::uint32_t c : cells[i]) near.push_back(volume->cell_sample[c]);
      if (near.empty()) continue;  // not a cell corner
      unique();
      double* const out = at_corners.values.data() + i * values.components;
      for (int ring = 0; !fit_straight(*volume, values, made->positions[i], near, ring == kMostRings, out); ++ring) {
        for (std::size_t k = near.size(); k-- > 0;) {
          const auto star = volume->stars[near[k]];
          near.insert(near.end(), star.begin(), star.end());
        }
        unique();
      }
    }
  });
  return {std::move(made), std::move(at_corners)};
}

CornerSamples with_surface_samples(std::shared_ptr<const SampledVolume> volume, VolumeValues values) {
  if (volume->lattice || volume->cell_sample.empty()) return corner_samples(std::move(volume), std::move(values));
  const CornerSamples corners = corner_samples(volume, values);
  auto made = std::make_shared<SampledVolume>();
  made->positions = volume->positions;
  made->cells = volume->cells;
  made->corners = volume->corners;
  made->cell_sample = volume->cell_sample;
  made->in_cells = true;
  made->facts = volume->facts;
  std::vector<std::uint8_t> taken(volume->corners.size(), 0);
  for (const std::uint32_t face : open_faces(volume->cells, volume->corners.size()))
    for (const std::uint32_t corner : ring_of_face(volume->cells, face)) {
      if (std::exchange(taken[corner], std::uint8_t{1})) continue;
      made->positions.push_back(volume->corners[corner]);
      const auto value = corners.values.of(corner);
      values.values.insert(values.values.end(), value.begin(), value.end());
    }
  return {std::move(made), std::move(values)};
}

}  // namespace sansmesh::inline v1::detail
