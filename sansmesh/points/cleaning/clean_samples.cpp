#include "sansmesh/points/cleaning/clean_samples.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/points/cleaning/duplicates.h"

namespace sansmesh::inline v1 {
namespace {

/// Samples outside each side of the box of nearly all samples: a share of them, but in small clouds up to ten, if these
/// are at most a twentieth.
constexpr double kQuantile = 0.001, kLargestQuantile = 0.05;
constexpr std::size_t kFewOutside = 10;
constexpr float kMargin = 2;  // in extents of the box between the quantiles
constexpr std::size_t kBoxSamples = 100000;
constexpr double kManyDuplicates = 0.01;

/// Box of nearly all samples with a wide margin. If nearly all samples coincide, the box contains everything: then the
/// other samples are the cloud, not remote from it.
Box3f main_box(const PointSet& points) {
  const std::size_t stride = 1 + points.size() / kBoxSamples;
  std::vector<float> values((points.size() + stride - 1) / stride);
  const auto n = static_cast<double>(values.size());
  const auto few = std::min(kFewOutside, static_cast<std::size_t>(kLargestQuantile * n));
  const auto cut = std::max(static_cast<std::size_t>(kQuantile * n), few);
  Box3f box{{0, 0, 0}, {0, 0, 0}};
  float extent = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = points.positions[i * stride][k];
    box.lower[k] = nth_smallest(values, cut);
    box.upper[k] = nth_smallest(values, values.size() - 1 - cut);
    extent = std::max(extent, box.upper[k] - box.lower[k]);
  }
  const float wide = extent > 0 ? kMargin * extent : std::numeric_limits<float>::infinity();
  const Vec3f margin{wide, wide, wide};
  return {box.lower - margin, box.upper + margin};
}

}  // namespace

SampleCleaning clean_samples(PointSet& points) {
  SampleCleaning cleaning;
  std::vector<std::uint8_t> mask(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    mask[i] = !is_finite(points.positions[i]) || (points.has_normals() && !is_finite(points.normals[i]));
    cleaning.non_finite += mask[i];
  }
  if (cleaning.non_finite > 0) remove_samples(points, mask);
  if (points.size() == 0) return cleaning;

  const Box3f box = main_box(points);
  mask.assign(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    mask[i] = !box.contains(points.positions[i]);
    cleaning.far_away += mask[i];
  }
  if (cleaning.far_away > 0) remove_samples(points, mask);

  if (points.triangles.empty() && duplicate_share(points) > kManyDuplicates) {
    mask = find_duplicates(points);
    cleaning.duplicates = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
    remove_samples(points, mask);
  }
  return cleaning;
}

}  // namespace sansmesh::inline v1
