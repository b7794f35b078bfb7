#include "sansmesh/triangulation/simplex_cut.h"

#include <cstddef>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

template <std::size_t M>
double cut_determinant(std::array<std::array<double, M>, M> m) {
  double d = 1;
  for (std::size_t c = 0; c < M; ++c) {
    std::size_t pivot = c;
    while (pivot < M && m[pivot][c] == 0) ++pivot;
    if (pivot == M) return 0;
    if (pivot != c) std::swap(m[pivot], m[c]), d = -d;
    d *= m[c][c];
    for (std::size_t r = c + 1; r < M; ++r) {
      const double f = m[r][c] / m[c][c];
      for (std::size_t k = c; k < M; ++k) m[r][k] -= f * m[c][k];
    }
  }
  return d;
}

/// All pieces for each set of positive vertices.
template <int N>
class CutTable {
 public:
  CutTable() {
    for (unsigned positive = 0; positive < kMasks; ++positive) {
      std::vector<std::uint8_t> below, above;
      for (int i = 0; i <= N; ++i) (positive >> i & 1u ? above : below).push_back(static_cast<std::uint8_t>(i));
      if (!below.empty() && !above.empty()) add_paths(below, above, 0, 0, {}, 0, pieces_[positive]);
    }
  }
  std::span<const CutPiece<N>> operator[](unsigned positive) const { return pieces_[positive % kMasks]; }

 private:
  static constexpr unsigned kMasks = 1u << (N + 1);

  static void add_paths(const std::vector<std::uint8_t>& below, const std::vector<std::uint8_t>& above, std::size_t i,
                        std::size_t j, CutPiece<N> path, std::size_t length, std::vector<CutPiece<N>>& out) {
    path[length] = {below[i], above[j]};
    if (length + 1 == N) return out.push_back(turned(path));
    if (i + 1 < below.size()) add_paths(below, above, i + 1, j, path, length + 1, out);
    if (j + 1 < above.size()) add_paths(below, above, i, j + 1, path, length + 1, out);
  }

  /// Test on v_0 = 0 and v_i the unit vectors, with corners at the midpoints.
  static CutPiece<N> turned(CutPiece<N> piece) {
    const auto unit = [](std::uint8_t v) {
      std::array<double, N> x{};
      if (v > 0) x[v - 1u] = 1;
      return x;
    };
    std::array<std::array<double, N>, N> m{};
    const auto add = [&](std::size_t row, double factor, std::uint8_t v) {
      const auto x = unit(v);
      for (std::size_t k = 0; k < N; ++k) m[row][k] += factor * x[k];
    };
    for (std::size_t i = 1; i < N; ++i) {
      add(i - 1, 1, piece[i].first), add(i - 1, 1, piece[i].second);
      add(i - 1, -1, piece[0].first), add(i - 1, -1, piece[0].second);
    }
    add(N - 1, 1, piece[0].second), add(N - 1, -1, piece[0].first);
    if (cut_determinant<N>(m) < 0) std::swap(piece[N - 2], piece[N - 1]);
    return piece;
  }

  std::array<std::vector<CutPiece<N>>, kMasks> pieces_;
};

}  // namespace

template <int N>
std::span<const CutPiece<N>> simplex_cut(unsigned positive) {
  static const CutTable<N> table;
  return table[positive];
}

template std::span<const CutPiece<2>> simplex_cut<2>(unsigned);
template std::span<const CutPiece<3>> simplex_cut<3>(unsigned);
template std::span<const CutPiece<4>> simplex_cut<4>(unsigned);

}  // namespace sansmesh::inline v1
