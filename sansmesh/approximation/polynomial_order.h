// Order in which polynomials in one to three variables are orthogonalised, and the inner products of each step.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// Number of monomials in `dimension` (1, 2 or 3) variables up to `degree` >= 0.
constexpr int monomial_count(int dimension, int degree) {
  if (dimension == 1) return degree + 1;
  const int triangle = (degree + 1) * (degree + 2) / 2;
  return dimension == 2 ? triangle : triangle * (degree + 3) / 3;
}

/// Triangle of monomials of Bartels & Jezioranski (bartels1985): row d holds the monomials of degree d and is divided
/// into one range per variable. The range of x_k holds the products of x_k with the ranges k, k+1, … of the previous
/// row. Indices count from 0, row by row: 1 | x₁ x₂ | x₁² x₁x₂ x₂² | … Multiplication preserves this order (a before b
/// implies x_k·a before x_k·b), and both savings rest on that.
template <int D>
class PolynomialOrder {
 public:
  static constexpr int kMaxDegree = 8;
  static constexpr int kSize = monomial_count(D, kMaxDegree);

  /// One inner product ⟨x_k ψ_{j'}, ψ_l⟩ in the recurrence of ψ_j.
  enum class Source : std::uint8_t {
    kComputed,  ///< no earlier step has computed it
    kReused,    ///< ⟨x_k ψ_l, ψ_{j'}⟩ was computed for the polynomial whose predecessor is l
    kNorm       ///< x_k·monomial(l) = monomial(j'): it is ⟨ψ_{j'}, ψ_{j'}⟩
  };
  struct Term {
    Source source;
    std::uint32_t slot;  ///< index of the stored product (kComputed, kReused)
  };

  struct Step {
    std::array<std::uint8_t, D> exponent{};
    int degree = 0;
    int variable = 0;     ///< k with monomial(j) = x_k · monomial(predecessor); 0 for j = 0
    int predecessor = 0;  ///< j'; 0 for j = 0
    /// Lowest l with a coefficient alpha_jl that need not vanish. All l with x_k·monomial(l) before monomial(j') drop
    /// out, since ⟨x_k ψ_{j'}, ψ_l⟩ = ⟨ψ_{j'}, x_k ψ_l⟩. These include all l below the predecessor of j'.
    int first = 0;
    std::vector<Term> terms;  ///< for l = first .. j − 1
  };

  /// Shared table for this number of variables.
  static const PolynomialOrder& get();

  const Step& operator[](int j) const { return steps_[static_cast<std::size_t>(j)]; }
  /// Index of x_k · monomial(l), for monomials below the highest degree.
  int product(int k, int l) const { return product_[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)]; }
  /// Number of slots used by the steps 0 .. j.
  std::uint32_t slots(int j) const { return slots_[static_cast<std::size_t>(j)]; }

 private:
  PolynomialOrder();
  std::vector<Step> steps_;
  std::vector<std::uint32_t> slots_;
  std::array<std::vector<int>, D> product_;
};

extern template class PolynomialOrder<1>;
extern template class PolynomialOrder<2>;
extern template class PolynomialOrder<3>;

}  // namespace sansmesh::inline v1
