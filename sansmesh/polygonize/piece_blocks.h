// Blocks for the mesh of minima and maxima of smooth functions, and which of these count in each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/field/piece_expression.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

using PieceNode = PieceExpression::Node;

/// More pieces than this cannot be cut out of one block.
inline constexpr std::size_t kMostPiecesInBlock = 251;
/// How many there are in an expression.
std::size_t distinct_pieces(std::span<const PieceNode> nodes);

/// What is known of the sign of a field.
enum class KnownSign : std::int8_t { inside = -1, unknown = 0, outside = 1 };

/// Leaves out of an expression (nodes after those that they name; pieces by any number) what the signs known of its
/// pieces decide. What is left is appended to `left`, with nodes counted from its end before; nothing if the sign of
/// all is known, which is returned. `sign(piece)` says what is known, `same(piece, piece)` which pieces are the same:
/// of these, that of the higher number counts as larger.
template <class Sign, class Same>
KnownSign prune(std::span<const PieceNode> nodes, std::vector<PieceNode>& left, Sign&& sign, Same&& same) {
  using Kind = PieceNode::Kind;
  struct State {
    KnownSign sign;
    std::uint32_t node;
  };
  thread_local std::vector<State> state;
  state.resize(nodes.size());
  const std::size_t before = left.size();
  const auto keep = [&](const PieceNode& n) {
    left.push_back(n);
    return State{KnownSign::unknown, static_cast<std::uint32_t>(left.size() - before - 1)};
  };
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const PieceNode& n = nodes[k];
    if (n.kind == Kind::piece) {
      const KnownSign s = sign(n.a);
      state[k] = s == KnownSign::unknown ? keep(n) : State{s, 0};
      continue;
    }
    const State a = state[n.a], b = state[n.b];
    const KnownSign deciding = n.kind == Kind::least ? KnownSign::inside : KnownSign::outside;
    if (a.sign == deciding || b.sign == deciding) {
      state[k] = {deciding, 0};
    } else if (a.sign != KnownSign::unknown) {
      state[k] = b;
    } else if (b.sign != KnownSign::unknown) {
      state[k] = a;
    } else if (const PieceNode& p = left[before + a.node], &q = left[before + b.node];
               p.kind == Kind::piece && q.kind == Kind::piece && (p.a == q.a || same(p.a, q.a))) {
      state[k] = (n.kind == Kind::least) == (p.a < q.a) ? a : b;
    } else {
      state[k] = keep({n.kind, a.node, b.node});
    }
  }
  const State root = state.back();
  if (root.sign != KnownSign::unknown) {
    left.resize(before);
    return root.sign;
  }
  // What the nodes on the way to a decision left behind goes, too.
  std::vector<std::uint8_t> used(left.size() - before, 0);
  used[root.node] = 1;
  for (std::size_t k = root.node + 1; k-- > 0;)
    if (used[k] && left[before + k].kind != Kind::piece) used[left[before + k].a] = used[left[before + k].b] = 1;
  std::vector<std::uint32_t> number(used.size());
  std::uint32_t kept = 0;
  for (std::size_t k = 0; k <= root.node; ++k) {
    if (!used[k]) continue;
    PieceNode n = left[before + k];
    if (n.kind != Kind::piece) n.a = number[n.a], n.b = number[n.b];
    number[k] = kept;
    left[before + kept++] = n;
  }
  left.resize(before + kept);
  return KnownSign::unknown;
}

struct PieceBlockOptions {
  /// Blocks of a curved piece are as small as triangles need to be that are so far off on average (length)...
  double mesh_error = 0;
  /// ... or exactly so large, if this is not 0 (length), and nothing gets smaller.
  double cell = 0;
  /// More blocks than this are an error.
  std::size_t most_blocks = 0;
};

/// The blocks that the surface may pass through, in the order of the tree, which is balanced.
struct PieceBlocks {
  struct Leaf {
    std::uint32_t block;
    std::uint32_t first, count;  ///< of its nodes: what counts within the block
  };
  BlockTree tree;
  std::vector<Leaf> leaves;
  std::vector<PieceNode> nodes;
  double scale = 0;  ///< edge of the root block
  /// Edge of the smallest block that would have to be smaller, had it been allowed; 0: none.
  double unresolved = 0;
  bool too_many = false;  ///< there are more than allowed; nothing else is of use
};

/// Cut as fine as needed, and no finer: where a piece bends within a block, and where two pieces come so close to each
/// other that, as straight as they are between lattice vertices, they could touch where they do not, or the other way
/// round. `shift` moves the blocks, 0..1: another try with other lattice points.
PieceBlocks piece_blocks(const PieceExpression& field, const Box3& box, const PieceBlockOptions& options, double shift,
                         Progress& progress);

}  // namespace sansmesh::inline v1
