// Assembles supports and their functions into the arrays of PartitionData.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/partition/fit/leaf_fit.h"
#include "sansmesh/partition/partition_data.h"

namespace sansmesh::inline v1 {

/// Position of a block along the Morton curve, comparable between levels.
inline std::uint64_t curve_position(int level, std::uint64_t code) { return code << (3 * (20 - level)); }

/// A support from old data or a new fit: its function and further pieces (old data chain them by `next` through
/// `chain`, a fitted leaf has them in `more`).
struct LeafRef {
  const LocalFunction* function;
  const Support* support;
  const LocalFunction* chain;
  const std::vector<LocalFunction>* more;
};
LeafRef ref_of(const PartitionData& data, std::size_t support);
LeafRef ref_of(const FittedLeaf& leaf);

/// All pieces of a support's function, in joining order.
std::vector<LocalFunction> pieces_of(const LeafRef& leaf);

/// Writes supports, in the order of the Morton curve, to the arrays of `data`, and their sums to its report.
void assemble(std::span<const LeafRef> leaves, PartitionData& data);

/// Appends the further pieces of a support to its function and the functions of all others. Throws DataError for more
/// functions than links can address.
void append_pieces(std::size_t support, std::span<const LocalFunction> pieces, std::vector<LocalFunction>& functions);

/// Computes the sums over the supports in the report of `data`.
void sum_up(PartitionData& data);

}  // namespace sansmesh::inline v1
