// Block trees for meshes of minima and maxima of smooth functions, with the pieces that matter in each block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/field/piece_expression.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

using PieceNode = PieceExpression::Node;

/// Largest number of pieces that one block may have.
inline constexpr std::size_t kMostPiecesInBlock = 251;
/// Number of distinct pieces in an expression.
std::size_t distinct_pieces(std::span<const PieceNode> nodes);

/// Known sign of a field in a region.
enum class KnownSign : std::int8_t { inside = -1, unknown = 0, outside = 1 };

/// Removes from an expression the nodes whose outcome the known signs of its pieces decide. Nodes follow their
/// operands; pieces have arbitrary indices. The remaining nodes are appended to `left`, numbered from its previous end;
/// nothing is appended if the sign of the whole is known, which is returned. `sign(piece)` is the known sign of a
/// piece. `same(piece, piece)` tests whether two pieces are identical; of these, the one with the larger index counts
/// as larger.
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
  // Removes nodes that a later decision made unreachable.
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
  /// Mean distance between a curved piece and its triangles that determines the block size (length)...
  double mesh_error = 0;
  /// ... or, if not 0, the fixed block size (length), below which no block is divided.
  double cell = 0;
  /// Largest number of blocks; more are an error.
  std::size_t most_blocks = 0;
};

/// Blocks that the surface may cross, in the order of the tree, which is balanced.
struct PieceBlocks {
  struct Leaf {
    std::uint32_t block;
    std::uint32_t first, count;  ///< range of its nodes: the part of the expression that matters in the block
  };
  BlockTree tree;
  std::vector<Leaf> leaves;
  std::vector<PieceNode> nodes;
  double scale = 0;  ///< edge of the root block
  /// Edge of the smallest block that should have been divided further but could not be; 0: none.
  double unresolved = 0;
  bool too_many = false;  ///< more blocks than allowed; all other members are invalid
};

/// Divides blocks where a piece curves within a block, and where two pieces, linear between lattice vertices, could
/// touch although they do not, or vice versa. `shift` (0..1) moves the blocks, to retry with other lattice points.
PieceBlocks piece_blocks(const PieceExpression& field, const Box3& box, const PieceBlockOptions& options, double shift,
                         Progress& progress);

}  // namespace sansmesh::inline v1
