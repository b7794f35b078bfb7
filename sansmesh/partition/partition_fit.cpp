#include <algorithm>
#include <cmath>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/leaf_fit.h"
#include "sansmesh/partition/partition_of_unity.h"

namespace sansmesh {
namespace {

std::vector<FittedLeaf> fit_leaves(const BlockFitter& fitter, const ScaleChoice& choice, Progress& progress) {
  const std::size_t n = choice.leaves.size();
  progress.begin("final fits", n);
  std::vector<FittedLeaf> leaves(n);
  parallel_ranges(0, n, 128, [&](std::size_t first, std::size_t last) {
    FitWorkspace ws;
    for (std::size_t i = first; i < last; ++i) leaves[i] = fit_leaf(fitter, choice, choice.leaves[i], ws);
    progress.advance(last - first);
  });
  return leaves;
}

/// What the polygoniser will need to know: how flat is the surface at the scale of each block?
std::vector<PartitionData::Flatness> record_flatness(const BlockFitter& fitter, const ScaleChoice& choice,
                                                     const std::vector<FittedLeaf>& leaves) {
  const auto levels = static_cast<std::size_t>(choice.finest) + 1;
  std::vector<std::vector<std::uint64_t>> code(levels);
  std::vector<std::vector<float>> gap(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    code[l] = fitter.tree.level(static_cast<int>(l)).code;
    gap[l].resize(choice.trials[l].size());
    for (std::size_t c = 0; c < gap[l].size(); ++c)
      gap[l][c] = flatness_gap(fitter, choice, static_cast<int>(l), static_cast<std::uint32_t>(c));
  }
  for (const FittedLeaf& leaf : leaves)
    if (leaf.support.creased) mark_crease(code, gap, fitter.tree.edge(), leaf.support.level, leaf.support.code);
  std::vector<PartitionData::Flatness> flatness(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    flatness[l].code = std::move(code[l]);
    flatness[l].gap = std::move(gap[l]);
    if (l + 1 < levels) flatness[l].child = std::vector(fitter.tree.level(static_cast<int>(l)).child);
  }
  return flatness;
}

double estimated_accuracy(const ScaleChoice& choice, double diagonal) {
  double squares = 0;
  for (const Leaf& leaf : choice.leaves)
    squares +=
        std::min<double>(choice.trials[static_cast<std::size_t>(leaf.level)][leaf.cell].risk, diagonal * diagonal);
  return std::sqrt(squares / static_cast<double>(choice.leaves.size()));
}

}  // namespace

PartitionOfUnity fit_partition_of_unity(const PointSet& points, const PartitionOptions& options, Progress& progress,
                                        std::vector<std::uint32_t>* order) {
  options.validate();
  if (points.size() < 4) throw DataError("partition of unity: at least 4 points are needed");
  if (points.normals.size() != points.size()) throw DataError("partition of unity: points need oriented normals");
  const Box3f box = bounds(points);
  const float extent = std::max({box.size().x, box.size().y, box.size().z});
  if (!(extent > 0)) throw DataError("partition of unity: all points coincide");

  PartitionData data;
  data.options = options;
  data.origin = points.origin;
  data.edge = 1.1f * extent;
  data.lower = box.center() - Vec3f{1, 1, 1} * (0.5f * data.edge);

  progress.begin("sort samples");
  // Deep enough that the finest occupied cells hold about one sample even where the cloud is densest.
  data.basis.sort_depth = std::clamp(options.max_depth.value_or(static_cast<int>(
                                         std::ceil(0.5 * std::log2(static_cast<double>(points.size())) + 1.5))),
                                     options.max_depth ? 2 : 3, 14);
  const SampleTree tree(points.positions, points.normals, data.lower, data.edge, data.basis.sort_depth);
  if (order) order->assign(tree.order().begin(), tree.order().end());

  const ScaleChoice choice = choose_scales(tree, options, box.diagonal(), progress);
  data.basis.tried = choice.tried;
  data.basis.finest = choice.finest;
  data.basis.variance = choice.variance;
  data.basis.accepted = choice.accepted;
  data.basis.support = static_cast<double>(choice.support);
  const BlockFitter fitter{tree, options, choice.support, choice.finest};
  std::vector<FittedLeaf> leaves = fit_leaves(fitter, choice, progress);
  data.flatness = record_flatness(fitter, choice, leaves);
  std::vector<LeafRef> refs;
  refs.reserve(leaves.size());
  for (const FittedLeaf& leaf : leaves) refs.push_back(ref_of(leaf));
  assemble(refs, data);
  data.report.spacing = std::sqrt(data.report.area / static_cast<double>(points.size()));
  data.report.noise = std::sqrt(choice.variance);
  data.report.error = choice.accepted;
  data.report.accuracy = estimated_accuracy(choice, box.diagonal());
  progress.finish();
  return PartitionOfUnity(std::move(data));
}

}  // namespace sansmesh
