#include "sansmesh/triangulation/simplex_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

template <std::size_t M>
double determinant(const std::array<std::array<double, M>, M>& m) {
  if constexpr (M == 1) {
    return m[0][0];
  } else {
    double sum = 0;
    for (std::size_t row = 0; row < M; ++row) {
      std::array<std::array<double, M - 1>, M - 1> minor;
      for (std::size_t i = 0; i + 1 < M; ++i)
        for (std::size_t k = 0; k + 1 < M; ++k) minor[i][k] = m[i < row ? i : i + 1][k + 1];
      sum += (row % 2 == 0 ? 1 : -1) * m[row][0] * determinant<M - 1>(minor);
    }
    return sum;
  }
}

double binomial(int n, int k) { return k == 0 ? 1 : binomial(n - 1, k - 1) * n / k; }

// In random simplices: pieces face the positive side, and their measure equals the closed form.
template <int N>
void check_pieces() {
  std::mt19937 random(N);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  for (unsigned positive = 1; positive + 1 < 1u << (N + 1); ++positive) {
    std::array<std::array<double, N>, N + 1> v;
    std::array<double, N + 1> f;
    std::array<std::array<double, N>, N> edges;
    do {
      for (auto& p : v)
        for (double& c : p) c = uniform(random);
      for (std::size_t i = 0; i < N; ++i)
        for (std::size_t k = 0; k < N; ++k) edges[i][k] = v[i + 1][k] - v[0][k];
    } while (!(determinant<N>(edges) > 0.01));
    int above = 0;
    for (std::size_t i = 0; i <= N; ++i) {
      f[i] = uniform(random) * ((positive >> i & 1u) ? 1 : -1);
      above += positive >> i & 1u;
    }
    const auto pieces = simplex_cut<N>(positive);
    EXPECT_EQ(static_cast<double>(pieces.size()), binomial(N - 1, above - 1));
    double sum = 0;
    for (const CutPiece<N>& piece : pieces) {
      std::array<std::array<double, N>, N> c;
      for (std::size_t i = 0; i < N; ++i) {
        const auto [a, b] = piece[i];
        ASSERT_FALSE(positive >> a & 1u);
        ASSERT_TRUE(positive >> b & 1u);
        const double u = f[a] / (f[a] - f[b]);
        for (std::size_t k = 0; k < N; ++k) c[i][k] = v[a][k] * (1 - u) + v[b][k] * u;
      }
      std::array<std::array<double, N>, N> m;
      for (std::size_t i = 1; i < N; ++i)
        for (std::size_t k = 0; k < N; ++k) m[i - 1][k] = c[i][k] - c[0][k];
      // A vector along which f grows by 1 from the set: from c_0 to a positive vertex.
      const std::uint8_t b = piece[0].second;
      for (std::size_t k = 0; k < N; ++k) m[N - 1][k] = (v[b][k] - c[0][k]) / f[b];
      const double d = determinant<N>(m);
      EXPECT_GT(d, 0);
      sum += d;
    }
    // The volume of {f < s} is V times Σ (s − f_i)ᴺ / Π (f_k − f_i) over the f_i < s. (N − 1)! times its derivative at
    // s = 0 is the sum of the determinants.
    double slope = 0;
    for (std::size_t i = 0; i <= N; ++i) {
      if (f[i] > 0) continue;
      double product = 1;
      for (std::size_t k = 0; k <= N; ++k)
        if (k != i) product *= f[k] - f[i];
      slope += std::pow(-f[i], N - 1) / product;
    }
    EXPECT_NEAR(sum, slope * determinant<N>(edges), 1e-9 * (1 + std::abs(sum)));
  }
}

TEST(SimplexCut, PiecesFillTheZeroSetAndLookUp) {
  check_pieces<2>();
  check_pieces<3>();
  check_pieces<4>();
}

// The part of the cut in the face opposite vertex i equals the cut of that face.
template <int N>
void check_faces() {
  for (unsigned positive = 1; positive + 1 < 1u << (N + 1); ++positive)
    for (int i = 0; i <= N; ++i) {
      std::map<std::set<CutCorner>, int> in_face, all;
      for (const CutPiece<N>& piece : simplex_cut<N>(positive))
        for (std::size_t left = 0; left < N; ++left) {
          std::set<CutCorner> rest;
          bool within = true;
          for (std::size_t k = 0; k < N; ++k) {
            if (k == left) continue;
            rest.insert(piece[k]);
            within = within && piece[k].first != i && piece[k].second != i;
          }
          ++all[rest];
          if (within) ++in_face[rest];
        }
      std::map<std::set<CutCorner>, int> expected;
      const auto back = [&](std::uint8_t v) { return static_cast<std::uint8_t>(v < i ? v : v + 1); };
      const unsigned mask = (positive & ((1u << i) - 1)) | (positive >> (i + 1)) << i;
      for (const CutPiece<N - 1>& piece : simplex_cut<N - 1>(mask)) {
        std::set<CutCorner> corners;
        for (const auto& [a, b] : piece) corners.insert({back(a), back(b)});
        expected[corners] = 1;
      }
      EXPECT_EQ(in_face, expected);
      for (const auto& [face, count] : all) EXPECT_LE(count, 2);
    }
}

TEST(SimplexCut, FacesAreCutAsByThemselves) {
  check_faces<3>();
  check_faces<4>();
}

TEST(SimplexCut, NothingWithoutAChangeOfSign) {
  EXPECT_TRUE(simplex_cut<3>(0).empty());
  EXPECT_TRUE(simplex_cut<3>(15).empty());
  EXPECT_TRUE(simplex_cut<4>(31).empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
