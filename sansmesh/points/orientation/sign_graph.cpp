#include "sansmesh/points/orientation/sign_graph.h"

#include <algorithm>
#include <cstdlib>
#include <queue>
#include <unordered_map>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

struct Candidate {
  std::int64_t majority;
  std::uint32_t a, b;
  // Largest majority first; indices break ties.
  friend bool operator<(const Candidate& l, const Candidate& r) {
    if (l.majority != r.majority) return l.majority < r.majority;
    return l.a != r.a ? l.a > r.a : l.b > r.b;
  }
};

}  // namespace

void SignForest::flatten() {
  std::vector<std::uint32_t> parent(size());
  std::vector<std::uint8_t> flip(size());
  parallel_for(0, size(), 16384, [&](std::size_t i) {
    auto root = static_cast<std::uint32_t>(i);
    std::uint8_t turned = 0;
    while (parent_[root] != root) turned ^= flip_[root], root = parent_[root];
    parent[i] = root, flip[i] = turned;
  });
  parent_.swap(parent), flip_.swap(flip);
}

void contract(SignForest& forest, const std::vector<SignVote>& votes) {
  // Sums of votes between current sets, stored for both. A set is named after one of its members; the votes in its row
  // refer to that member's sign.
  std::unordered_map<std::uint32_t, std::unordered_map<std::uint32_t, std::int64_t>> sums;
  for (const SignVote& vote : votes) {
    const SignForest::Root a = forest.find(vote.a), b = forest.find(vote.b);
    if (a.index == b.index) continue;
    const std::int64_t weight = a.flip != b.flip ? -vote.weight : vote.weight;
    sums[a.index][b.index] += weight;
    sums[b.index][a.index] += weight;
  }
  std::priority_queue<Candidate> queue;
  const auto push = [&](std::uint32_t a, std::uint32_t b, std::int64_t weight) {
    queue.push({std::abs(weight), std::min(a, b), std::max(a, b)});
  };
  for (const auto& [a, row] : sums)
    for (const auto& [b, weight] : row)
      if (a < b) push(a, b, weight);

  while (!queue.empty()) {
    const Candidate best = queue.top();
    queue.pop();
    const auto row_a = sums.find(best.a);
    if (row_a == sums.end()) continue;
    const auto cell = row_a->second.find(best.b);
    if (cell == row_a->second.end() || std::abs(cell->second) != best.majority) continue;  // outdated
    const bool opposite = cell->second < 0;
    forest.join(best.a, best.b, opposite);
    // Merges the shorter list of neighbours into the longer; its signs flip with their set.
    std::uint32_t keep = best.a, move = best.b;
    if (sums[keep].size() < sums[move].size()) std::swap(keep, move);
    const auto moved = std::move(sums[move]);
    sums.erase(move);
    sums[keep].erase(move);
    for (const auto& [other, weight] : moved) {
      if (other == keep) continue;
      const std::int64_t turned = opposite ? -weight : weight;
      sums[other].erase(move);
      const std::int64_t sum = sums[keep][other] += turned;
      sums[other][keep] = sum;
      push(keep, other, sum);
    }
  }
}

}  // namespace sansmesh::inline v1
