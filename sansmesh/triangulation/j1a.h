// The J₁ᴬ triangulation in two, three and four dimensions (castelo2006): the simplices of a 2:1 balanced tree of cubic
// blocks as six-tuples, with closed rules for their vertices and neighbours and no stored topology.
//
// In a block [−1, 1]ᴺ a simplex is a path from the centre v_0 of the block over the centre of a face to those of ever
// smaller faces and, unless a neighbour is finer, to a corner. Where the path first meets a face (or edge) that a finer
// neighbour refines, it continues to the centre of one of the parts of that face, and from there by half steps:
//
//     v_i = v_{i−1} + s_a e_a                 a = π_i, i < h
//     v_h = v_{h−1} + s_a e_a + ½ Σ t_b e_b   a = π_h, b = π_{h+1} … π_N
//     v_i = v_{i−1} + ½ s_a e_a               a = π_i, i > h
//
// h = N means that the path meets nothing refined (v_N is a corner). Every simplex of the tree has exactly one valid
// tuple.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace sansmesh::inline v1 {

/// Integer position of a block among those of its level: block `cell` of level l is the cube [cell, cell + 1]·2⁻ˡ.
template <int N>
using BlockCell = std::array<std::int32_t, N>;

/// Vertices are exact integers: multiples of a quarter of the edge of a block of level kDeepestBlockLevel. A block of
/// level 0 is kLatticeEdge units wide.
constexpr int kDeepestBlockLevel = 28;
constexpr std::int64_t kLatticeEdge = std::int64_t{4} << kDeepestBlockLevel;
template <int N>
using LatticeVertex = std::array<std::int64_t, N>;

/// Interface of the tree to the triangulation. The domain is the union of all leaves; blocks outside do not exist and
/// count as not finer. The functions below require that leaves that share a face or an edge differ by at most one level
/// (2:1 balance), and that no level exceeds kDeepestBlockLevel.
template <int N>
class BlockView {
 public:
  virtual ~BlockView() = default;
  /// True if the block of exactly this level and cell exists and has no children.
  virtual bool is_leaf(int level, const BlockCell<N>& cell) const = 0;
  /// True if the block of exactly this level and cell exists and has children.
  virtual bool subdivided(int level, const BlockCell<N>& cell) const = 0;
};

/// S = (g, r, π, s, t, h). Two valid simplices are the same if and only if their tuples are equal.
template <int N>
struct Simplex {
  BlockCell<N> cell{};                 ///< g
  std::uint8_t level = 0;              ///< r
  std::array<std::uint8_t, N> axis{};  ///< π: axis[i − 1] is the axis of step i
  std::array<std::int8_t, N> sign{};   ///< s, ±1, by axis
  std::array<std::int8_t, N> extra{};  ///< t, by axis: ±1 for the axes of the steps after h, else 0
  std::uint8_t steps = N;              ///< h, 1 … N

  friend bool operator==(const Simplex&, const Simplex&) = default;
};

/// v_0 … v_N.
template <int N>
std::array<LatticeVertex<N>, N + 1> vertices(const Simplex<N>& simplex);

/// Sign (±1) of the determinant of (v_1 − v_0, …, v_N − v_0).
template <int N>
int orientation(const Simplex<N>& simplex);

/// True if the tuple is well formed and denotes a simplex of the triangulation of this tree.
template <int N>
bool is_valid(const BlockView<N>& tree, const Simplex<N>& simplex);

/// All simplices of a leaf in a fixed order; 2ᴺ N! of them if no neighbour is finer. Throws ArgumentError if the block
/// is not a leaf.
template <int N>
std::vector<Simplex<N>> simplices_of(const BlockView<N>& tree, int level, const BlockCell<N>& cell);

/// The simplex on the other side of the face opposite v_i, or nothing at the boundary of the domain. Its vertices are
/// those of `simplex` in the same order, except for v_i; pivot(pivot(S, i), i) = S. `simplex` must be valid. Throws
/// ArgumentError for i outside 0 … N, and if it detects that the tree is not balanced.
template <int N>
std::optional<Simplex<N>> pivot(const BlockView<N>& tree, const Simplex<N>& simplex, int i);

/// A simplex that contains the point, in units of the edge of a block of level 0; nothing outside the domain. The
/// choice on a common face is fixed but arbitrary.
template <int N>
std::optional<Simplex<N>> locate(const BlockView<N>& tree, const std::array<double, N>& point);

/// Sets for each vertex whether it is inside (1) or not (0).
template <int N>
using InsideTest = std::function<void(std::span<const LatticeVertex<N>> vertices, std::span<std::uint8_t> inside)>;

/// All simplices with vertices both inside and outside that can be reached from the seeds by pivoting across faces with
/// vertices both inside and outside: one component of the level set for each crossing seed, breadth first. Seeds that
/// do not cross are skipped. Each vertex is tested once, all those of one front in one call.
template <int N>
std::vector<Simplex<N>> walk_crossing(const BlockView<N>& tree, std::span<const Simplex<N>> seeds,
                                      const InsideTest<N>& inside);

}  // namespace sansmesh::inline v1
