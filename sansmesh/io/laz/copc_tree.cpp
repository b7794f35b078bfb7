#include "sansmesh/io/laz/copc_tree.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1::io::laz {
namespace {

/// Cells along the edge of a node.
constexpr std::int32_t kNodeCells = 128;
/// Nodes of at most this number of points have no children; children with fewer than the second join their parent.
constexpr std::size_t kLeafPoints = 10'000, kFewestOfChild = 256;
constexpr std::int32_t kDeepestWritten = 20;
constexpr std::size_t kInfoLength = 160, kVlrHeadLength = 54, kEvlrHeadLength = 60, kEntryLength = 32;

class TreeBuilder {
 public:
  explicit TreeBuilder(const std::vector<LasSteps>& points) : points_(points) {}

  CopcTree build() {
    CopcTree tree;
    if (points_.empty()) return tree;
    LasSteps lower = points_[0], upper = lower;
    for (const LasSteps& p : points_)
      for (std::size_t k = 0; k < 3; ++k) lower[k] = std::min(lower[k], p[k]), upper[k] = std::max(upper[k], p[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = lower[k], b = upper[k];
      tree.center[k] = 0.5 * (a + b);
      tree.half_size = std::max(tree.half_size, 0.5 * (b - a));
    }
    // A little larger than the box, so that no rounding puts a point outside.
    tree.half_size = std::max(1.0, tree.half_size * (1 + 1e-9) + 0.5);
    tree.spacing = 2 * tree.half_size / kNodeCells;
    std::vector<std::uint32_t> all(points_.size());
    std::iota(all.begin(), all.end(), 0u);
    const double half = tree.half_size;
    add_node(0, {0, 0, 0}, tree.center - Vec3{half, half, half}, 2 * half, std::move(all));
    tree.nodes = std::move(nodes_);
    return tree;
  }

 private:
  void add_node(std::int32_t level, const LasSteps& cube, const Vec3& lower, double edge,
                std::vector<std::uint32_t> points) {
    const std::size_t at = nodes_.size();
    nodes_.push_back({level, cube, {}});
    if (points.size() <= kLeafPoints || level == kDeepestWritten) {
      nodes_[at].points = std::move(points);
      return;
    }
    std::array<std::vector<std::uint32_t>, 8> children;
    std::vector<std::uint32_t> own = first_of_cells(lower, edge, points, children);
    points = {};
    for (std::vector<std::uint32_t>& child : children)
      if (child.size() < kFewestOfChild) own.insert(own.end(), child.begin(), child.end()), child.clear();
    std::sort(own.begin(), own.end());
    nodes_[at].points = std::move(own);
    for (std::size_t k = 0; k < 8; ++k) {
      if (children[k].empty()) continue;
      LasSteps at_child = cube;
      Vec3 corner = lower;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto bit = static_cast<std::int32_t>(k >> axis & 1);
        at_child[axis] = 2 * cube[axis] + bit, corner[axis] += bit * 0.5 * edge;
      }
      add_node(level + 1, at_child, corner, 0.5 * edge, std::move(children[k]));
    }
  }

  /// Returns the first point of each cell and distributes the others.
  std::vector<std::uint32_t> first_of_cells(const Vec3& lower, double edge, const std::vector<std::uint32_t>& points,
                                            std::array<std::vector<std::uint32_t>, 8>& children) const {
    std::vector<std::uint64_t> taken(std::size_t{kNodeCells} * kNodeCells * kNodeCells / 64, 0);
    std::vector<std::uint32_t> own;
    for (const std::uint32_t i : points) {
      std::size_t cell = 0, child = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto c = index_in<std::int32_t>((points_[i][k] - lower[k]) / edge * kNodeCells, 0, kNodeCells - 1);
        cell = cell * kNodeCells + static_cast<std::size_t>(c);
        child |= std::size_t{c >= kNodeCells / 2} << k;
      }
      std::uint64_t& word = taken[cell / 64];
      const std::uint64_t bit = std::uint64_t{1} << cell % 64;
      ((word & bit) != 0 ? children[child] : own).push_back(i);
      word |= bit;
    }
    return own;
  }

  const std::vector<LasSteps>& points_;
  std::vector<CopcNode> nodes_;
};

template <class T>
void put_number(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

CopcTree make_copc_tree(const std::vector<LasSteps>& points) { return TreeBuilder(points).build(); }

std::string copc_vlr(const CopcDescription& d) {
  std::string s(kVlrHeadLength + kInfoLength, '\0');
  s.replace(2, 4, "copc");
  put_number(s, 18, std::uint16_t{1}), put_number(s, 20, static_cast<std::uint16_t>(kInfoLength));
  s.replace(22, 9, "COPC info");
  const std::size_t at = kVlrHeadLength;
  for (std::size_t k = 0; k < 3; ++k) put_number(s, at + 8 * k, d.center[k]);
  put_number(s, at + 24, d.half_size), put_number(s, at + 32, d.spacing);
  put_number(s, at + 40, d.hierarchy), put_number(s, at + 48, d.hierarchy_bytes);
  put_number(s, at + 56, d.first_time), put_number(s, at + 64, d.last_time);
  return s;
}

std::string copc_evlr_head(std::size_t bytes) {
  std::string s(kEvlrHeadLength, '\0');
  s.replace(2, 4, "copc");
  put_number(s, 18, std::uint16_t{1000}), put_number(s, 20, std::uint64_t{bytes});
  s.replace(28, 14, "COPC hierarchy");
  return s;
}

std::string copc_page(const std::vector<CopcNode>& nodes, const std::vector<CopcChunk>& chunks) {
  std::string s(nodes.size() * kEntryLength, '\0');
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const std::size_t at = k * kEntryLength;
    put_number(s, at, nodes[k].level);
    for (std::size_t axis = 0; axis < 3; ++axis) put_number(s, at + 4 + 4 * axis, nodes[k].cube[axis]);
    put_number(s, at + 16, chunks[k].begin);
    put_number(s, at + 24, static_cast<std::int32_t>(chunks[k].bytes));
    put_number(s, at + 28, static_cast<std::int32_t>(nodes[k].points.size()));
  }
  return s;
}

}  // namespace sansmesh::inline v1::io::laz
