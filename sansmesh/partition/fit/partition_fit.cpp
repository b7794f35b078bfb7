#include "sansmesh/partition/fit/partition_fit.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/assemble.h"
#include "sansmesh/partition/far/openness.h"
#include "sansmesh/partition/fit/crease_fit.h"
#include "sansmesh/partition/fit/flatness.h"
#include "sansmesh/partition/fit/leaf_fit.h"
#include "sansmesh/partition/fit/sorted_samples.h"

namespace sansmesh::inline v1 {
namespace {

/// Fits the functions of the chosen blocks and writes them to the arrays of `data`.
void fit_leaves(const BlockFitter& fitter, const ScaleChoice& choice, PartitionData& data, Progress& progress) {
  constexpr std::size_t kChunk = 128;
  const std::size_t n = choice.leaves.size(), chunks = (n + kChunk - 1) / kChunk;
  progress.begin("final fits", n);
  std::vector<LocalFunction> functions(n);
  std::vector<Support> supports(n);
  struct Pieces {
    std::size_t support;
    std::vector<LocalFunction> more;
  };
  std::vector<std::vector<Pieces>> pieces(chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    FitWorkspace ws(fitter.tree);
    const std::size_t first = c * kChunk, last = std::min(n, first + kChunk);
    for (std::size_t i = first; i < last; ++i) {
      FittedLeaf leaf = fit_leaf(fitter, choice, choice.leaves[i], ws);
      functions[i] = leaf.function;
      functions[i].next = 0;
      supports[i] = leaf.support;
      if (!leaf.more.empty()) pieces[c].push_back({i, std::move(leaf.more)});
    }
    progress.advance(last - first);
  });
  for (const auto& chunk : pieces)
    for (const Pieces& p : chunk) append_pieces(p.support, p.more, functions);
  data.functions = std::move(functions);
  data.supports = std::move(supports);
  sum_up(data);
}

/// Records the flatness of the surface at the scale of each block for the polygoniser. Consumes the tree's levels and
/// the trials.
std::vector<PartitionData::Flatness> record_flatness(SampleTree& tree, const BlockFitter& fitter, ScaleChoice& choice,
                                                     const PartitionData& data) {
  const auto levels = static_cast<std::size_t>(choice.finest) + 1;
  std::vector<std::vector<std::uint64_t>> code(levels);
  std::vector<std::vector<float>> gap(levels);
  std::vector<PartitionData::Flatness> flatness(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    SampleTree::Level level = tree.take_level(static_cast<int>(l));
    gap[l].resize(level.size());
    parallel_for(0, gap[l].size(), 8192, [&](std::size_t c) {
      gap[l][c] = flatness_gap(fitter, choice, static_cast<int>(l), static_cast<std::uint32_t>(c));
    });
    code[l] = std::move(level.code);
    if (l + 1 < levels) flatness[l].child = std::move(level.child);
    choice.trials[l] = {};
  }
  for (std::size_t i = 0; i < data.supports.size(); ++i)
    if (const Support& support = data.supports[i]; support.creased)
      mark_crease(code, gap, tree.edge(), support.level, support.code, least_cosine(pieces_of(ref_of(data, i))));
  for (std::size_t l = 0; l < levels; ++l) {
    flatness[l].code = std::move(code[l]);
    flatness[l].gap = std::move(gap[l]);
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

/// Fills in all of `data` except the position of the cube.
void fit_samples(SampleTree& tree, double diagonal, PartitionData& data, Progress& progress) {
  ScaleChoice choice = choose_scales(tree, data.options, diagonal, progress);
  choice.sort_depth = data.basis.sort_depth;
  data.basis = choice;
  const BlockFitter fitter = fitter_of(tree, data.options, choice);
  fit_leaves(fitter, choice, data, progress);
  choice.kept = {};
  data.report.spacing = std::sqrt(data.report.area / static_cast<double>(tree.positions().size()));
  data.report.noise = std::sqrt(choice.variance);
  data.report.error = choice.accepted;
  data.report.accuracy = estimated_accuracy(choice, diagonal);
  progress.begin("look for open sheets");
  decide_open(data.options.open, tree.positions(), tree.normals(), data);
  data.flatness = record_flatness(tree, fitter, choice, data);
}

}  // namespace

PartitionOfUnity fit_partition_of_unity(PointSet points, const PartitionOptions& options, Progress& progress,
                                        PointSet* sorted) {
  options.validate();
  PartitionData data;
  data.options = options;
  const Box3f box = set_root_cube(points, data);
  snap_root_cube(box, points.positions, kLeastCompany, data);
  progress.begin("sort samples");
  data.basis.sort_depth = std::clamp(options.max_depth.value_or(deepest_level(points.positions, data.edge)),
                                     options.max_depth ? kLeastDepth : kLeastDepth + 1, kMostDepth);
  SampleTree tree = sort_samples(points, data, sorted);
  fit_samples(tree, box.diagonal(), data, progress);
  progress.finish();
  take_samples(tree, sorted);
  return PartitionOfUnity(std::move(data));
}

}  // namespace sansmesh::inline v1
