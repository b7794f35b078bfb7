#include "sansmesh/polygonize/pieces/piece_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kLeastLevel = 3;
/// Largest product of a block's edge and a piece's curvature: the piece is then one sheet in the block.
constexpr double kMostCurvature = 0.7;
/// Smallest block edge as a fraction of the root's; tips end here.
constexpr double kSmallest = 3.2e-5;
/// Triangles of a block with edge e are about e/2 wide. Straddling a surface of curvature κ, their mean error is
/// κ(e/2)²/24. For a singly curved surface it would be half, but simplification consumes most of that gain;
/// kSinglyCurvedShare is the measured factor.
constexpr double kErrorShare = 1.0 / 96;
constexpr double kSinglyCurvedShare = 0.7;
/// Half the block's diagonal plus the largest move of lattice vertices (piece_cut.cpp), over the block's edge.
constexpr double kReachOfBlock = 0.8661 + 0.161;
/// Blocks with more pieces, or more planes (limited by the cost of cutting), are divided further; for planes only down
/// to this fraction of the root's edge, because smaller blocks do not reduce the number of planes through one point or
/// line.
constexpr std::size_t kManyPieces = 16, kManyPlanes = 60;
constexpr double kSmallestOfPlanes = 1.0 / 100;
/// Smallest block edge for pieces that approach each other: below, the resolution of float is reached.
constexpr double kRoundingOfMesh = 1e-7;
constexpr std::array<double, 3> kShift{0.3819, 0.2361, 0.4271};
/// Survey of curved pieces that determines the root's size: deepest level, largest number of blocks, number of sizes
/// compared, and the required ratio of blocks for a larger root.
constexpr int kSurveyLevels = 4;
constexpr std::size_t kSurveyBlocks = 8192;
constexpr int kSizesOfRoot = 24;
constexpr double kWorthALargerRoot = 0.9;
/// Fraction of the accepted error and curvature: blocks are usually smaller than allowed, here most are as large as
/// allowed.
constexpr double kErrorOfLargest = 0.8;

double error_share(const PieceExpression& field, std::uint32_t piece) {
  return field.singly_curved(piece) ? kSinglyCurvedShare * kErrorShare : kErrorShare;
}

struct Chooser {
  const PieceExpression& field;
  const PieceBlockOptions& options;
  double scale;

  enum class Verdict : std::uint8_t { fine, cut, cut_if_allowed, too_small };

  /// A node at the centre and the corners of a block.
  struct Seen {
    std::array<double, 9> value{};
    Vec3 gradient;
    bool curved = false;
    std::vector<std::uint32_t> pieces;  ///< nodes that are pieces, of its operands and itself
  };

  /// Whether two sheets with opposite normals come closer than the deviation from linearity. (Sheets with equal normals
  /// are one sheet wherever both count.) Each sheet counts where it approximately equals the value of its side.
  bool too_close(const Seen& a, const Seen& of_a, const Seen& b, const Seen& of_b, const std::array<Vec3, 9>& offset,
                 double edge) const {
    const double middle = a.value[0] + b.value[0];
    const Vec3 slope = a.gradient + b.gradient;
    double off = 0;
    for (std::size_t k = 1; k < 9; ++k)
      off = std::max(off, std::abs(a.value[k] + b.value[k] - middle - dot(slope, offset[k])));
    const double steep = norm(slope);
    if (off < kRoundingOfMesh * scale || std::abs(middle) > 0.87 * steep * edge + 2 * off || steep * edge > 4 * off)
      return false;
    for (std::size_t k = 0; k < 9; ++k)
      if (std::abs(a.value[k] - of_a.value[k]) <= 2 * off && std::abs(b.value[k] - of_b.value[k]) <= 2 * off)
        return true;
    return false;
  }

  Verdict look(const Vec3& center, double edge, std::span<const PieceNode> nodes) const {
    thread_local std::vector<Seen> seen;
    const double radius = kReachOfBlock * edge;
    bool curved = false, strongly_curved = false, tiny = false, coarse = false;
    std::size_t count = 0;
    for (const PieceNode& n : nodes) {
      if (n.kind != PieceNode::Kind::piece) continue;
      ++count;
      const double curvature = field.curvature_bound(n.a, center, radius);
      curved = curved || curvature > 0;
      strongly_curved = strongly_curved || curvature * edge > kMostCurvature;
      tiny = tiny || (curvature * edge > kMostCurvature && std::isfinite(curvature));  // a tip has unbounded curvature
      coarse = coarse || curvature * edge * edge * error_share(field, n.a) > options.mesh_error;
    }
    if (options.cell > 0) {
      if (edge <= 1.0001 * options.cell) return tiny ? Verdict::too_small : Verdict::fine;
      if (curved) return Verdict::cut;
    }
    if (edge < kSmallest * scale) return tiny ? Verdict::too_small : Verdict::fine;
    if (strongly_curved) return Verdict::cut_if_allowed;
    if (count > kManyPieces) count = distinct_pieces(nodes);
    const std::size_t most_planes = edge < kSmallestOfPlanes * scale ? kMostPiecesInBlock : kManyPlanes;
    if (count > (curved ? kManyPieces : most_planes)) return Verdict::cut_if_allowed;
    if (coarse) return Verdict::cut;
    if (!curved || count < 2) return Verdict::fine;
    std::array<Vec3, 9> x, offset;
    x[0] = center;
    for (std::size_t k = 0; k < 8; ++k) {
      offset[k + 1] = Vec3{k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0} * (edge / 2);
      x[k + 1] = center + offset[k + 1];
    }
    seen.resize(std::max(seen.size(), nodes.size()));
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const PieceNode& n = nodes[i];
      Seen& now = seen[i];
      now.pieces.clear();
      if (n.kind == PieceNode::Kind::piece) {
        std::array<Vec3, 9> gradient;
        field.evaluate_piece(n.a, x, now.value, gradient);
        now.gradient = gradient[0];
        now.curved = field.curvature_bound(n.a, center, radius) > 0;
        now.pieces.push_back(i);
        continue;
      }
      const Seen &a = seen[n.a], &b = seen[n.b];
      const bool least = n.kind == PieceNode::Kind::least;
      for (std::size_t k = 0; k < 9; ++k)
        now.value[k] = least ? std::min(a.value[k], b.value[k]) : std::max(a.value[k], b.value[k]);
      for (const std::uint32_t p : a.pieces)
        for (const std::uint32_t q : b.pieces)
          if ((seen[p].curved || seen[q].curved) && too_close(seen[p], a, seen[q], b, offset, edge))
            return Verdict::cut_if_allowed;
      now.pieces = a.pieces;
      now.pieces.insert(now.pieces.end(), b.pieces.begin(), b.pieces.end());
      if (now.pieces.size() <= kManyPieces) continue;  // nodes may be operands of several others
      std::sort(now.pieces.begin(), now.pieces.end());
      now.pieces.erase(std::unique(now.pieces.begin(), now.pieces.end()), now.pieces.end());
    }
    return Verdict::fine;
  }
};

/// Prunes the expression using the values at the block's centre; false if nothing is left.
bool prune_block(const PieceExpression& field, const Vec3& center, double edge, std::span<const PieceNode> nodes,
                 std::vector<PieceNode>& left) {
  const double radius = kReachOfBlock * edge;
  const auto sign = [&](std::uint32_t piece) {
    double value = 0;
    field.evaluate_piece(piece, {&center, 1}, {&value, 1}, {});
    return value > radius ? KnownSign::outside : value < -radius ? KnownSign::inside : KnownSign::unknown;
  };
  const auto same = [&](std::uint32_t a, std::uint32_t b) {
    return field.same_within(a, center, radius) == field.same_within(b, center, radius);
  };
  return prune(nodes, left, sign, same) == KnownSign::unknown;
}

constexpr std::size_t kChunkOfBlocks = 256;

struct ChunkOfBlocks {
  std::vector<PieceNode> nodes;
  std::vector<PieceBlocks::Leaf> met;  ///< node indices relative to the chunk's first
  std::vector<std::uint8_t> verdict;
};

/// Blocks of one level of the tree, with what their parents leave of the expression.
struct OpenBlocks {
  struct Block {
    std::uint32_t block;
    std::uint32_t first, count;  ///< nodes of the parent block
  };
  std::vector<Block> blocks;
  std::vector<PieceNode> nodes;

  OpenBlocks() = default;
  explicit OpenBlocks(const PieceExpression& field)
      : blocks{{0, 0, static_cast<std::uint32_t>(field.nodes().size())}}, nodes(field.nodes()) {}

  void add_children(const ChunkOfBlocks& chunk, const PieceBlocks::Leaf& parent, std::uint32_t first_child) {
    if (appended_ != &chunk) {
      appended_ = &chunk;
      offset_ = static_cast<std::uint32_t>(nodes.size());
      nodes.insert(nodes.end(), chunk.nodes.begin(), chunk.nodes.end());
    }
    for (std::uint32_t k = 0; k < 8; ++k) blocks.push_back({first_child + k, offset_ + parent.first, parent.count});
  }

 private:
  const ChunkOfBlocks* appended_ = nullptr;
  std::uint32_t offset_ = 0;
};

/// Prunes the expression in each block and calls `see(center, edge, nodes)`.
template <class See>
std::vector<ChunkOfBlocks> look_at_level(const PieceExpression& field, const BlockTree& tree, const OpenBlocks& open,
                                         See&& see) {
  const std::size_t n = open.blocks.size(), chunks = (n + kChunkOfBlocks - 1) / kChunkOfBlocks;
  std::vector<ChunkOfBlocks> found(chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    ChunkOfBlocks& chunk = found[c];
    for (std::size_t i = c * kChunkOfBlocks; i < std::min(n, (c + 1) * kChunkOfBlocks); ++i) {
      check_cancelled();
      const OpenBlocks::Block& o = open.blocks[i];
      const Vec3 center = tree.block_center(o.block);
      const double edge = tree.block_edge(o.block);
      const auto first = static_cast<std::uint32_t>(chunk.nodes.size());
      if (!prune_block(field, center, edge, std::span(open.nodes).subspan(o.first, o.count), chunk.nodes)) continue;
      const auto count = static_cast<std::uint32_t>(chunk.nodes.size() - first);
      chunk.met.push_back({o.block, first, count});
      chunk.verdict.push_back(see(center, edge, std::span<const PieceNode>(chunk.nodes).subspan(first, count)));
    }
  });
  return found;
}
std::vector<ChunkOfBlocks> look_at_level(const PieceExpression& field, const BlockTree& tree, const OpenBlocks& open) {
  return look_at_level(field, tree, open,
                       [](const Vec3&, double, std::span<const PieceNode>) { return std::uint8_t{0}; });
}

/// Blocks halve from the root on, so that a piece has blocks between the largest allowed size and half of it. Returns
/// the factor of the root's size, 1..2, that minimises the number of blocks along all curved pieces.
double best_root(const PieceExpression& field, const Vec3& lower, double edge, const PieceBlockOptions& options) {
  BlockTree tree(lower, edge);
  struct Allowed {
    double edge, area;
  };
  std::vector<Allowed> all;
  OpenBlocks open(field);
  for (int level = 0; !open.blocks.empty(); ++level) {
    const std::vector<ChunkOfBlocks> found = look_at_level(field, tree, open);
    const bool last = level == kSurveyLevels || 8 * open.blocks.size() > kSurveyBlocks;
    open = {};
    for (const ChunkOfBlocks& c : found)
      for (const PieceBlocks::Leaf& m : c.met) {
        if (!last) {
          open.add_children(c, m, static_cast<std::uint32_t>(tree.subdivide(m.block)));
          continue;
        }
        const double e = tree.block_edge(m.block);
        for (std::size_t i = m.first; i < m.first + m.count; ++i) {
          if (c.nodes[i].kind != PieceNode::Kind::piece) continue;
          const double curvature = field.curvature_bound(c.nodes[i].a, tree.block_center(m.block), kReachOfBlock * e);
          if (!(curvature > 0) || !std::isfinite(curvature)) continue;
          const double coarsest =
              std::sqrt(kErrorOfLargest * options.mesh_error / (curvature * error_share(field, c.nodes[i].a)));
          const double allowed = std::min(kErrorOfLargest * kMostCurvature / curvature, coarsest);
          if (allowed < e) all.push_back({allowed, std::min(e * e, 4 / (curvature * curvature))});
        }
      }
  }
  double best = 1, least = 0;
  for (int k = 0; k < kSizesOfRoot; ++k) {
    const double root = std::exp2(static_cast<double>(k) / kSizesOfRoot);
    double blocks = 0;
    for (const Allowed& a : all) {
      const double e = root * edge * std::exp2(-std::ceil(std::log2(root * edge / a.edge)));
      blocks += a.area / (e * e);
    }
    if (k == 0) least = kWorthALargerRoot * blocks;
    if (blocks < least) least = blocks, best = root;
  }
  return best;
}

/// Divides the blocks level by level; false if there are more than allowed.
bool divide_where_needed(const PieceExpression& field, const PieceBlockOptions& options, const Chooser& chooser,
                         Progress& progress, PieceBlocks& result) {
  BlockTree& tree = result.tree;
  OpenBlocks open(field);
  for (int level = 0; !open.blocks.empty(); ++level) {
    progress.check();
    const std::vector<ChunkOfBlocks> found =
        look_at_level(field, tree, open, [&](const Vec3& center, double e, std::span<const PieceNode> nodes) {
          return static_cast<std::uint8_t>(level < kLeastLevel ? Chooser::Verdict::cut
                                                               : chooser.look(center, e, nodes));
        });
    const double e = result.scale / static_cast<double>(1u << level);
    const bool may_cut = level < BlockTree::kMaxLevel && (options.cell == 0 || e > 1.0001 * options.cell);
    open = {};
    for (const ChunkOfBlocks& c : found) {
      for (std::size_t i = 0; i < c.met.size(); ++i) {
        const auto verdict = static_cast<Chooser::Verdict>(c.verdict[i]);
        if (verdict == Chooser::Verdict::too_small) result.unresolved = e;
        if (!may_cut || verdict == Chooser::Verdict::fine || verdict == Chooser::Verdict::too_small) continue;
        open.add_children(c, c.met[i], static_cast<std::uint32_t>(tree.subdivide(c.met[i].block)));
      }
      if (tree.size() > options.most_blocks) return false;
    }
  }
  tree.balance();
  return true;
}

/// Collects the leaves with their expressions, in the order of the tree.
void collect_leaves(const PieceExpression& field, Progress& progress, PieceBlocks& result) {
  const BlockTree& tree = result.tree;
  OpenBlocks open(field);
  while (!open.blocks.empty()) {
    progress.check();
    const std::vector<ChunkOfBlocks> found = look_at_level(field, tree, open);
    open = {};
    for (const ChunkOfBlocks& c : found)
      for (const PieceBlocks::Leaf& m : c.met) {
        if (!tree.is_leaf(m.block)) {
          open.add_children(c, m, static_cast<std::uint32_t>(tree[m.block].first_child));
          continue;
        }
        const auto first = static_cast<std::uint32_t>(result.nodes.size());
        result.nodes.insert(result.nodes.end(), c.nodes.begin() + m.first, c.nodes.begin() + m.first + m.count);
        result.leaves.push_back({m.block, first, m.count});
      }
  }
  std::vector<std::uint32_t> rank(tree.size(), 0);
  const std::vector<std::uint32_t> leaves = tree.leaves();
  for (std::size_t i = 0; i < leaves.size(); ++i) rank[leaves[i]] = static_cast<std::uint32_t>(i);
  std::sort(result.leaves.begin(), result.leaves.end(),
            [&](const PieceBlocks::Leaf& a, const PieceBlocks::Leaf& b) { return rank[a.block] < rank[b.block]; });
}

}  // namespace

std::size_t distinct_pieces(std::span<const PieceNode> nodes) {
  if (nodes.size() == 1) return 1;
  thread_local std::vector<std::uint32_t> pieces;
  pieces.clear();
  for (const PieceNode& n : nodes)
    if (n.kind == PieceNode::Kind::piece) pieces.push_back(n.a);
  std::sort(pieces.begin(), pieces.end());
  return static_cast<std::size_t>(std::unique(pieces.begin(), pieces.end()) - pieces.begin());
}

PieceBlocks piece_blocks(const PieceExpression& field, const Box3& box, const PieceBlockOptions& options, double shift,
                         Progress& progress) {
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  double edge = longest * 1.07;
  const double scale = edge;
  if (options.cell > 0) {
    edge = options.cell;
    // At most an eighth of the root for any cell: values are quantised relative to its edge (piece_cut.cpp).
    while (edge < longest * 1.001 + 2 * options.cell || edge < 8 * options.cell) edge *= 2;
  } else {
    edge *= best_root(field, box.center() - Vec3{edge, edge, edge} * 0.5, edge, options);
  }
  const double room = edge - longest;
  Vec3 lower = box.center() - Vec3{edge, edge, edge} * 0.5;
  for (std::size_t k = 0; k < 3; ++k) lower[k] += (std::fmod(kShift[k] + shift, 1.0) - 0.5) * 0.9 * room;
  PieceBlocks result{BlockTree(lower, edge), {}, {}, edge, 0, false};
  progress.begin("blocks");
  if (!divide_where_needed(field, options, {field, options, options.cell > 0 ? edge : scale}, progress, result)) {
    result.too_many = true;
    return result;
  }
  collect_leaves(field, progress, result);
  progress.finish();
  return result;
}

}  // namespace sansmesh::inline v1
