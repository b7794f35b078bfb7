#include "sansmesh/deform/folds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFoldChunk = 512;

/// The points of a lattice over a box.
struct FoldLattice {
  Box3 box;
  std::array<std::size_t, 3> sizes;
  Vec3 spacing;

  std::size_t points() const { return sizes[0] * sizes[1] * sizes[2]; }
  std::array<std::size_t, 3> index(std::size_t p) const {
    return {p % sizes[0], p / sizes[0] % sizes[1], p / sizes[0] / sizes[1]};
  }
  Vec3 at(std::size_t p) const {
    const auto i = index(p);
    Vec3 x = box.lower;
    for (std::size_t k = 0; k < 3; ++k) x[k] += spacing[k] * static_cast<double>(i[k]);
    return x;
  }
  /// Points on faces represent half the volume of others, on edges a quarter, at corners an eighth.
  double volume(std::size_t p) const {
    const auto i = index(p);
    double v = 1;
    for (std::size_t k = 0; k < 3; ++k)
      if (i[k] == 0 || i[k] + 1 == sizes[k]) v /= 2;
    return v;
  }
};

std::vector<float> determinants_on(const SpaceMap& map, const FoldLattice& lattice, Progress& progress) {
  std::vector<float> determinants(lattice.points());
  const std::size_t chunks = (lattice.points() + kFoldChunk - 1) / kFoldChunk;
  progress.begin("folds", chunks);
  parallel_for(0, chunks, 1, [&](std::size_t chunk) {
    const std::size_t first = chunk * kFoldChunk, n = std::min(kFoldChunk, lattice.points() - first);
    std::vector<Vec3> x(n), positions(n);
    std::vector<Jacobian> jacobians(n);
    std::vector<double> gaps(map.has_gaps() ? n : 0);
    for (std::size_t i = 0; i < n; ++i) x[i] = lattice.at(first + i);
    map.map(x, {positions, jacobians, gaps, {}});
    for (std::size_t i = 0; i < n; ++i) {
      const bool counts = is_finite(positions[i]) && (gaps.empty() || gaps[i] <= 0);
      const Jacobian& j = jacobians[i];
      determinants[first + i] =
          counts ? static_cast<float>(dot(j[0], cross(j[1], j[2]))) : std::numeric_limits<float>::quiet_NaN();
    }
    progress.advance();
  });
  progress.finish();
  return determinants;
}

}  // namespace

FoldReport find_folds(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                      Progress& progress) {
  FoldLattice lattice{box, sizes, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(box.upper[k] > box.lower[k]) || !std::isfinite(box.upper[k] - box.lower[k]))
      throw ArgumentError("the box for folds has no size along axis " + std::to_string(k + 1));
    if (sizes[k] < 2 || sizes[k] > 4096)
      throw ArgumentError("folds need a lattice of 2 to 4096 points along each axis, not " + std::to_string(sizes[k]));
    lattice.spacing[k] = (box.upper[k] - box.lower[k]) / static_cast<double>(sizes[k] - 1);
  }
  if (lattice.points() > std::numeric_limits<std::uint32_t>::max())
    throw ArgumentError("folds need a lattice of at most 2^32 points");
  std::vector<float> determinants = determinants_on(map, lattice, progress);

  UnionFind sets(lattice.points());
  const std::array<std::size_t, 3> strides{1, sizes[0], sizes[0] * sizes[1]};
  FoldReport report;
  double whole = 0, folded = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < determinants.size(); ++p) {
    if (std::isnan(determinants[p])) continue;
    whole += lattice.volume(p), least = std::min(least, double{determinants[p]});
    if (determinants[p] > 0) continue;
    folded += lattice.volume(p);
    const auto i = lattice.index(p);
    for (std::size_t k = 0; k < 3; ++k)
      if (i[k] > 0 && determinants[p - strides[k]] <= 0)
        sets.join(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(p - strides[k]));
  }
  std::unordered_map<std::uint32_t, std::size_t> numbers;
  std::vector<double> points;
  for (std::size_t p = 0; p < determinants.size(); ++p) {
    if (!(determinants[p] <= 0)) continue;
    const auto [found, is_new] = numbers.try_emplace(sets.find(static_cast<std::uint32_t>(p)), report.folds.size());
    if (is_new) report.folds.emplace_back(), points.push_back(0);
    Fold& fold = report.folds[found->second];
    const Vec3 x = lattice.at(p);
    for (const double side : {-0.5, 0.5}) {
      Vec3 corner = x + lattice.spacing * side;
      for (std::size_t k = 0; k < 3; ++k) corner[k] = std::clamp(corner[k], box.lower[k], box.upper[k]);
      fold.box.extend(corner);
    }
    fold.center += x, points[found->second] += 1;
    fold.share += lattice.volume(p) / whole;
    fold.least = std::min(fold.least, double{determinants[p]});
  }
  for (std::size_t f = 0; f < report.folds.size(); ++f) report.folds[f].center = report.folds[f].center / points[f];
  std::stable_sort(report.folds.begin(), report.folds.end(),
                   [](const Fold& a, const Fold& b) { return a.share > b.share; });
  report.share = whole > 0 ? folded / whole : 0;
  report.least = whole > 0 ? least : 1;
  report.determinants.kind = GridKind::lattice;
  report.determinants.origin = box.lower;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < sizes[k]; ++i)
      report.determinants.axes[k].push_back(lattice.spacing[k] * static_cast<double>(i));
  report.determinants.point_arrays.set("determinant", std::move(determinants));
  return report;
}

namespace {

constexpr ReportRow kFoldRows[] = {
    reported<&Fold::center>({.text = "Centre of the fold", .unit = "length"}),
    reported<&Fold::share>({.text = "Share of the volume in this fold", .unit = "share"})};

}  // namespace

const ReportSchema& Fold::schema() {
  static constexpr ReportSchema schema{kFoldRows};
  return schema;
}

namespace {

constexpr ReportRow kFoldReportRows[] = {
    reported<&FoldReport::share>({.name = "folded", .text = "Folded share of the volume", .unit = "share"}),
    reported<&FoldReport::folds>({.text = "Folds, the largest first"})};

}  // namespace

const ReportSchema& FoldReport::schema() {
  static constexpr ReportSchema schema{kFoldReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
