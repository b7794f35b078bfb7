#include "sansmesh/surface/curvature.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/surface/curvature_choice.h"

namespace sansmesh::inline v1 {
namespace {

using detail::CurvatureChoice, detail::TestedNeighbourhoods;
using detail::CurvatureFitter, detail::kReachOverWidth, detail::same_sheet;

/// Factor of the neighbours where too few are on the sheet of a sample.
constexpr std::size_t kMoreNeighbours = 4;

CurvatureChoice choose_on_tree(const KdTree& tree, const PointSet& points, double noise, bool only_quadrics) {
  const std::size_t tested = std::min(detail::kTestedCurvatures, tree.size());
  const auto make_finder = [&]() -> detail::FindNeighbourhoods {
    return [&](std::size_t p, TestedNeighbourhoods& to) {
      return find_nearest(tree, points, tree.order()[p * tree.size() / tested], to);
    };
  };
  return detail::choose_curvature(tested, make_finder, noise, only_quadrics);
}

}  // namespace

CurvatureEstimator::CurvatureEstimator(const PointSet& points, const CurvatureOptions& options)
    : options_(options), cloud_size_(points.size()) {
  options.validate();
  if (points.normals.size() != points.size()) throw DataError("curvatures need normals; the cloud has none");
  tree_ = KdTree(points.positions);
  positions_ = tree_.positions();
  normals_.resize(tree_.size());
  slot_of_.assign(points.size(), 0);
  parallel_for(0, tree_.size(), 4096, [&](std::size_t slot) {
    const std::uint32_t index = tree_.order()[slot];
    const Vec3f n = points.normals[index];
    normals_[slot] = is_finite(n) ? normalized(n) : Vec3f{};
    slot_of_[index] = static_cast<std::uint32_t>(slot);
  });
  if (options.bandwidth) return;
  if (options.neighbours) {
    neighbours_ = *options.neighbours;
    return;
  }
  const CurvatureChoice choice = choose_on_tree(tree_, points, options.noise ? *options.noise : estimate_noise(points),
                                                detail::only_quadrics(options));
  neighbours_ = static_cast<int>(choice.neighbours);
  surface_ = choice.surface;
}

void CurvatureEstimator::evaluate(std::span<const Vec3> x, std::span<const Vec3> normals,
                                  std::span<FittedCurvatures> result) const {
  if (normals.size() != x.size() || result.size() != x.size())
    throw ArgumentError("CurvatureEstimator::evaluate: points, normals and results differ in number");
  parallel_ranges(0, x.size(), 256, [&](std::size_t first, std::size_t last) {
    CurvatureFitter fitter(options_);
    std::vector<Neighbour> found;
    for (std::size_t i = first; i < last; ++i) {
      result[i] = {};
      const Vec3 normal = normalized(normals[i]);
      if (!is_finite(x[i]) || !(squared_norm(normal) > 0)) continue;
      double radius = 0;
      if (options_.bandwidth) {
        radius = kReachOverWidth * *options_.bandwidth;
        tree_.within(Vec3f(x[i]), static_cast<float>(radius), found);
      } else {
        found.resize(static_cast<std::size_t>(neighbours_));
        found.resize(tree_.nearest(Vec3f(x[i]), found));
        if (!found.empty()) radius = std::sqrt(static_cast<double>(found.back().squared_distance));
      }
      if (found.empty() || static_cast<double>(found.front().squared_distance) > 0.25 * radius * radius) continue;
      fitter.start(normal);
      std::size_t count = 0;
      for (const Neighbour& neighbour : found) {
        const std::size_t slot = slot_of_[neighbour.index];
        if (same_sheet(normal, normals_[slot])) fitter.add(Vec3(positions_[slot]) - x[i]), ++count;
      }
      if (fitter.fit_or_quadric(count, radius, surface_)) result[i] = fitter.curvatures();
    }
  });
}

std::vector<FittedCurvatures> CurvatureEstimator::at_samples(Progress& progress) const {
  std::vector<FittedCurvatures> result(cloud_size_);
  progress.begin("curvatures", tree_.size());
  constexpr std::size_t kSlots = 2048;
  parallel_ranges(0, tree_.size(), kSlots, [&](std::size_t first, std::size_t last) {
    CurvatureFitter fitter(options_);
    const auto fit = [&](std::size_t slot, std::span<const Neighbour> found, bool slots, double radius) {
      const Vec3 normal(normals_[slot]);
      if (squared_norm(normal) == 0) return true;
      fitter.start(normal);
      std::size_t count = 0;
      for (const Neighbour& neighbour : found) {
        const std::size_t s = slots ? neighbour.index : slot_of_[neighbour.index];
        if (same_sheet(normal, normals_[s])) fitter.add(Vec3(positions_[s] - positions_[slot])), ++count;
      }
      const bool made = fitter.fit_or_quadric(count, radius, surface_);
      if (made) result[tree_.order()[slot]] = fitter.curvatures();
      return made;
    };
    std::vector<Neighbour> more;
    const auto radius_of = [](std::span<const Neighbour> found) {
      return std::sqrt(static_cast<double>(found.back().squared_distance));
    };
    if (options_.bandwidth) {
      std::vector<Neighbour> found;
      const double radius = kReachOverWidth * *options_.bandwidth;
      for (std::size_t slot = first; slot < last; ++slot) {
        tree_.within(positions_[slot], static_cast<float>(radius), found);
        fit(slot, found, false, radius);
      }
    } else {
      tree_.for_each_nearest(static_cast<std::size_t>(neighbours_), first, last,
                             [&](std::uint32_t slot, std::span<const Neighbour> found) {
                               if (found.empty() || fit(slot, found, true, radius_of(found))) return;
                               // Most of the nearest samples may be on the other side of a thin wall.
                               more.resize(kMoreNeighbours * static_cast<std::size_t>(neighbours_));
                               more.resize(tree_.nearest(positions_[slot], more));
                               fit(slot, more, false, radius_of(more));
                             });
    }
    progress.advance(last - first);
  });
  progress.finish();
  return result;
}

std::vector<FittedCurvatures> estimate_curvatures(const PointSet& points, const CurvatureOptions& options,
                                                  Progress& progress) {
  return CurvatureEstimator(points, options).at_samples(progress);
}

}  // namespace sansmesh::inline v1
