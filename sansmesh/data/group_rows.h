// Groups indices by row: a counting sort into compressed sparse rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sansmesh/cell_list.h"

namespace sansmesh::inline v1 {

/// Rows of at most 2³² − 1 entries in total, in half the memory of the offsets of Adjacency.
using Adjacency32 = AdjacencyT<std::uint32_t>;

/// each_entry(visit) calls visit(row, entry) for all entries, and is called twice. Entries of a row keep their order.
/// `Offset` must be able to count all entries.
template <class Offset = std::uint64_t, class EachEntry>
AdjacencyT<Offset> group_rows(std::size_t rows, const EachEntry& each_entry) {
  AdjacencyT<Offset> groups;
  groups.first.assign(rows + 1, 0);
  each_entry([&](std::size_t row, std::size_t) { ++groups.first[row + 1]; });
  std::partial_sum(groups.first.begin(), groups.first.end(), groups.first.begin());
  groups.entries.resize(groups.first.back());
  std::vector<Offset> next(groups.first.begin(), groups.first.end() - 1);
  each_entry(
      [&](std::size_t row, std::size_t entry) { groups.entries[next[row]++] = static_cast<std::uint32_t>(entry); });
  return groups;
}

}  // namespace sansmesh::inline v1
