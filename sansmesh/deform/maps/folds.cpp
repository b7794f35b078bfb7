#include "sansmesh/deform/maps/folds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/deform/maps/box_lattice.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFoldChunk = 512;

/// Volume of a point in cells: points on faces represent half the volume of others, on edges a quarter, at corners an
/// eighth.
double volume_at(const BoxLattice& lattice, std::size_t p) {
  const BoxLattice::Index i = lattice.index(p);
  double v = 1;
  for (std::size_t k = 0; k < 3; ++k)
    if (i[k] == 0 || i[k] + 1 == lattice.sizes[k]) v /= 2;
  return v;
}

std::vector<float> determinants_on(const SpaceMap& map, const BoxLattice& lattice, Progress& progress) {
  std::vector<float> determinants(lattice.size());
  const std::size_t chunks = (lattice.size() + kFoldChunk - 1) / kFoldChunk;
  progress.begin("folds", chunks);
  parallel_for(0, chunks, 1, [&](std::size_t chunk) {
    const std::size_t first = chunk * kFoldChunk, n = std::min(kFoldChunk, lattice.size() - first);
    std::vector<Vec3> x(n), positions(n);
    std::vector<Jacobian> jacobians(n);
    std::vector<double> gaps(map.has_gaps() ? n : 0);
    for (std::size_t i = 0; i < n; ++i) x[i] = lattice.position(first + i);
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
  const BoxLattice lattice(box, sizes);
  lattice.validate("the search for folds");
  if (lattice.size() > std::numeric_limits<std::uint32_t>::max())
    throw ArgumentError("the search for folds needs a lattice of at most 2^32 points");
  std::vector<float> determinants = determinants_on(map, lattice, progress);

  UnionFind sets(lattice.size());
  const BoxLattice::Index strides = lattice.strides();
  FoldReport report;
  double whole = 0, folded = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < determinants.size(); ++p) {
    if (std::isnan(determinants[p])) continue;
    whole += volume_at(lattice, p), least = std::min(least, double{determinants[p]});
    if (determinants[p] > 0) continue;
    folded += volume_at(lattice, p);
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
    const Vec3 x = lattice.position(p);
    for (const double side : {-0.5, 0.5}) {
      Vec3 corner = x + lattice.spacing * side;
      for (std::size_t k = 0; k < 3; ++k) corner[k] = std::clamp(corner[k], box.lower[k], box.upper[k]);
      fold.box.extend(corner);
    }
    fold.center += x, points[found->second] += 1;
    fold.share += volume_at(lattice, p) / whole;
    fold.least = std::min(fold.least, double{determinants[p]});
  }
  for (std::size_t f = 0; f < report.folds.size(); ++f) report.folds[f].center = report.folds[f].center / points[f];
  std::stable_sort(report.folds.begin(), report.folds.end(),
                   [](const Fold& a, const Fold& b) { return a.share > b.share; });
  report.share = whole > 0 ? folded / whole : 0;
  report.least = whole > 0 ? least : 1;
  report.determinants = lattice.grid();
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
