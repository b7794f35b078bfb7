// Groups indices by row: a counting sort into an Adjacency.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sansmesh/cell_list.h"

namespace sansmesh::inline v1 {

/// each_entry(visit) calls visit(row, entry) for all entries, and is called twice. Entries of a row keep their order.
template <class EachEntry>
Adjacency group_rows(std::size_t rows, const EachEntry& each_entry) {
  Adjacency groups;
  groups.first.assign(rows + 1, 0);
  each_entry([&](std::size_t row, std::size_t) { ++groups.first[row + 1]; });
  std::partial_sum(groups.first.begin(), groups.first.end(), groups.first.begin());
  groups.entries.resize(groups.first.back());
  std::vector<std::uint64_t> next(groups.first.begin(), groups.first.end() - 1);
  each_entry(
      [&](std::size_t row, std::size_t entry) { groups.entries[next[row]++] = static_cast<std::uint32_t>(entry); });
  return groups;
}

}  // namespace sansmesh::inline v1
