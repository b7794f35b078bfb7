#include "sansmesh/partition/assemble.h"

#include <algorithm>
#include <limits>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

LeafRef ref_of(const PartitionData& data, std::size_t support) {
  return {&data.functions[support], &data.supports[support], data.functions.data(), nullptr};
}

LeafRef ref_of(const FittedLeaf& leaf) { return {&leaf.function, &leaf.support, nullptr, &leaf.more}; }

std::vector<LocalFunction> pieces_of(const LeafRef& leaf) {
  std::vector<LocalFunction> pieces{*leaf.function};
  if (leaf.more) {
    pieces.insert(pieces.end(), leaf.more->begin(), leaf.more->end());
  } else {
    for (std::int32_t next = leaf.function->next; next != 0; next = leaf.chain[next - 1].next)
      pieces.push_back(leaf.chain[next - 1]);
  }
  return pieces;
}

void append_pieces(std::size_t support, std::span<const LocalFunction> pieces, std::vector<LocalFunction>& functions) {
  std::size_t tail = support;
  for (const LocalFunction& piece : pieces) {
    if (functions.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
      throw DataError("partition of unity: too many local functions");
    functions.push_back(piece);
    functions.back().next = 0;
    functions[tail].next = static_cast<std::int32_t>(functions.size());
    tail = functions.size() - 1;
  }
}

void sum_up(PartitionData& data) {
  PartitionReport& report = data.report;
  report.functions = data.supports.size();
  report.depth = 0;
  report.creased = 0;
  report.area = 0;
  report.open_area = 0;
  report.functions_of_degree = {};
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    report.depth = std::max<int>(report.depth, data.supports[i].level);
    report.creased += data.supports[i].creased;
    ++report.functions_of_degree[static_cast<std::size_t>(data.functions[i].degree)];
    // Summed like the far field, in the precision of its patches.
    const float area = norm(data.functions[i].nu * data.supports[i].area);
    report.area += area;
    if (data.supports[i].open) report.open_area += area;
  }
}

void assemble(std::span<const LeafRef> leaves, PartitionData& data) {
  const std::size_t n = leaves.size();
  std::vector<LocalFunction> functions(n);
  std::vector<Support> supports(n);
  parallel_for(0, n, 4096, [&](std::size_t i) {
    functions[i] = *leaves[i].function;
    functions[i].next = 0;
    supports[i] = *leaves[i].support;
  });
  for (std::size_t i = 0; i < n; ++i) {
    const std::vector<LocalFunction> pieces = pieces_of(leaves[i]);
    append_pieces(i, std::span(pieces).subspan(1), functions);
  }
  data.functions = std::move(functions);
  data.supports = std::move(supports);
  data.find_slopes();
  sum_up(data);
}

}  // namespace sansmesh::inline v1
