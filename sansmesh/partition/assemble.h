// From supports with their functions to the arrays of PartitionData. Internal to partition/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/partition/leaf_fit.h"
#include "sansmesh/partition/partition_data.h"

namespace sansmesh::inline v1 {

/// Place of a block along the Morton curve, with those of all levels.
inline std::uint64_t curve_position(int level, std::uint64_t code) { return code << (3 * (20 - level)); }

/// A support of old or new: its function, further pieces (those of old data are chained by `next` through `chain`,
/// those of a fitted leaf are in `more`).
struct LeafRef {
  const LocalFunction* function;
  const Support* support;
  const LocalFunction* chain;
  const std::vector<LocalFunction>* more;
};
LeafRef ref_of(const PartitionData& data, std::size_t support);
LeafRef ref_of(const FittedLeaf& leaf);

/// Supports in the order of the Morton curve as the arrays of `data`, and their sums in its report.
void assemble(std::span<const LeafRef> leaves, PartitionData& data);

/// Appends the further pieces of a support to its function and those of all others. Throws DataError where there are
/// more functions than links can name.
void append_pieces(std::size_t support, std::span<const LocalFunction> pieces, std::vector<LocalFunction>& functions);

/// The sums over the supports in the report of `data`.
void sum_up(PartitionData& data);

}  // namespace sansmesh::inline v1
