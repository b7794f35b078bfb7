#include "sansmesh/partition/fit/child_density.h"

#include <cstddef>
#include <cstdint>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1 {
namespace {

/// Least mean number of samples in a sample's cell, in one sheet and in two.
constexpr float kLeast = 2.5f, kLeastOfTwoSheets = 1.5f;
/// Least λ1 λ2 / (λ1 + λ2)² of the principal variances of the samples in a cell. It is 0.25 for samples of the same
/// density in all directions, and near 0 on scan lines farther apart than the edge of the cells.
constexpr float kLeastSpread = 0.21f;
/// Cells with more samples show the shape of the object and not the pattern of the samples.
constexpr float kMostForSpread = 50, kTooMany = 500;

}  // namespace

ChildDensity::ChildDensity(const SampleTree& tree, int level) : sums_(tree.level(level).size()) {
  const auto& child = tree.level(level).child;
  const auto& begin = tree.level(level + 1).begin;
  const auto positions = tree.positions();
  parallel_for(0, sums_.size(), 1024, [&](std::size_t c) {
    Sums& sums = sums_[c];
    for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
      const std::uint32_t first = begin[k], end = begin[k + 1];
      const auto n = static_cast<float>(end - first);
      sums.samples += n, sums.squares += n * n;
      if (n < 3 || n > kTooMany) continue;
      Vec3f sum;
      for (std::uint32_t i = first; i < end; ++i) sum += positions[i] - positions[first];
      const Vec3f mean = positions[first] + sum / n;
      Symmetric3T<float> s;
      for (std::uint32_t i = first; i < end; ++i) s.add(positions[i] - mean);
      // Both are invariants of the matrix. The factor removes the bias of the product for few samples.
      const float trace = s.xx + s.yy + s.zz;
      const float pairs = s.xx * s.yy - s.xy * s.xy + s.yy * s.zz - s.yz * s.yz + s.xx * s.zz - s.xz * s.xz;
      sums.areas += pairs * n / (n - 2), sums.traces += trace * trace;
    }
  });
}

bool ChildDensity::suffices(const SampleTree::Neighbours& around, float two_sheets) const {
  Sums all;
  for (const std::int32_t o : around) {
    if (o < 0) continue;
    const Sums& sums = sums_[static_cast<std::size_t>(o)];
    all.samples += sums.samples, all.squares += sums.squares;
    all.areas += sums.areas, all.traces += sums.traces;
  }
  if (all.squares < (kLeast + two_sheets * (kLeastOfTwoSheets - kLeast)) * all.samples) return false;
  return all.squares > kMostForSpread * all.samples || all.areas >= (1 - two_sheets) * kLeastSpread * all.traces;
}

}  // namespace sansmesh::inline v1
