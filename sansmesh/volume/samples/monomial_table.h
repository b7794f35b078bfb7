// Compile-time table of PolynomialOrder<3> up to degree 4, which kernels unroll.
#pragma once

#include <cstdint>

namespace sansmesh::inline v1::detail {

struct MonomialTable {
  static constexpr int kTerms = 35;
  std::uint8_t exponent[kTerms][3]{};
  std::uint8_t variable[kTerms]{}, predecessor[kTerms]{};  ///< monomial(j) = x_variable · monomial(predecessor)
  std::uint8_t lower[kTerms][3]{};                         ///< index of monomial(j) / x_k, where it exists

  constexpr MonomialTable() {
    int at = 0;
    for (int degree = 0; degree <= 4; ++degree)
      for (int i = degree; i >= 0; --i)
        for (int j = degree - i; j >= 0; --j, ++at) {
          const int e[3] = {i, j, degree - i - j};
          for (int k = 0; k < 3; ++k) exponent[at][k] = static_cast<std::uint8_t>(e[k]);
          for (int k = 2; k >= 0; --k) {
            if (e[k] == 0) continue;
            for (int l = 0; l < at; ++l) {
              bool same = true;
              for (int a = 0; a < 3; ++a) same = same && exponent[l][a] == e[a] - (a == k ? 1 : 0);
              if (same) lower[at][k] = static_cast<std::uint8_t>(l);
            }
          }
          for (int k = 2; k >= 0; --k)
            if (e[k] > 0) variable[at] = static_cast<std::uint8_t>(k), predecessor[at] = lower[at][k];
        }
  }
};

inline constexpr MonomialTable kMonomials;

}  // namespace sansmesh::inline v1::detail
