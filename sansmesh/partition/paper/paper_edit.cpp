#include "sansmesh/partition/paper/paper_edit.h"

#include <atomic>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/edit/replace_supports.h"
#include "sansmesh/partition/paper/paper_local.h"

namespace sansmesh::inline v1 {

bool fails_coverage(const LocalFunction& function, const Support& support, const PaperCoverage& coverage) {
  if (support.state != Support::fitted) return false;
  if (support.samples < kEnoughForPlane) return true;
  return function.degree >= 2 &&
         static_cast<double>(support.coverage) < coverage[static_cast<std::size_t>(function.degree) - 2];
}

EditResult set_paper_degree(const PartitionData& data, const Selection& chosen, std::optional<int> degree,
                            const EditSamples& samples, Progress& progress) {
  PaperOptions options = *data.paper;
  if (options.coverage == kNoCoverage) options.coverage = kThesisCoverage;
  const PaperFitter fitter(samples.positions, samples.normals, data.lower, data.edge, options, data.basis.accepted);
  progress.begin("fit again", chosen.size());
  std::vector<FittedLeaf> leaves(chosen.size());
  std::atomic<std::size_t> kept{0}, lower{0};
  parallel_ranges(0, chosen.size(), 64, [&](std::size_t first, std::size_t last) {
    PaperFitter::Workspace ws;
    for (std::size_t i = first; i < last; ++i) {
      const LocalFunction& old = data.functions[chosen[i]];
      const Support& support = data.supports[chosen[i]];
      FittedLeaf& leaf = leaves[i];
      const PaperBlock block{support.level, support.code, fitter.ball(old.center, fitter.radius(support.level))};
      if (block.ids.size() < kEnoughForPlane) {
        ++kept;
        leaf = {old, {}, support};
        continue;
      }
      const PaperLocal local = fitter.approximate(block, ws, degree.value_or(-1));
      lower += degree && local.function.degree < *degree;
      leaf = leaf_of(fitter, local);
    }
    progress.advance(last - first);
  });
  EditResult result = replace_supports(data, chosen, std::move(leaves));
  result.changes -= kept;
  result.lower = lower;
  return result;
}

}  // namespace sansmesh::inline v1
