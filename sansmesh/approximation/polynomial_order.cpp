#include "sansmesh/approximation/polynomial_order.h"

#include <map>
#include <tuple>

namespace sansmesh::inline v1 {

template <int D>
const PolynomialOrder<D>& PolynomialOrder<D>::get() {
  static const PolynomialOrder order;
  return order;
}

template <int D>
PolynomialOrder<D>::PolynomialOrder() {
  std::map<std::array<std::uint8_t, D>, int> index;
  steps_.resize(1);
  index[steps_[0].exponent] = 0;

  // Row by row, range by range. range[k] is the start of x_k's range in the previous row.
  std::array<int, D> range{};
  int row_end = 1;
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    std::array<int, D> next{};
    for (int k = 0; k < D; ++k) {
      next[static_cast<std::size_t>(k)] = static_cast<int>(steps_.size());
      for (int l = range[static_cast<std::size_t>(k)]; l < row_end; ++l) {
        Step step;
        step.exponent = steps_[static_cast<std::size_t>(l)].exponent;
        ++step.exponent[static_cast<std::size_t>(k)];
        step.degree = degree;
        step.variable = k;
        step.predecessor = l;
        index[step.exponent] = static_cast<int>(steps_.size());
        steps_.push_back(step);
      }
    }
    range = next;
    row_end = static_cast<int>(steps_.size());
  }

  for (int k = 0; k < D; ++k)
    for (int l = 0; l < monomial_count(D, kMaxDegree - 1); ++l) {
      auto exponent = steps_[static_cast<std::size_t>(l)].exponent;
      ++exponent[static_cast<std::size_t>(k)];
      product_[static_cast<std::size_t>(k)].push_back(index.at(exponent));
    }

  // Products that a step reuses from earlier steps: they are symmetric in (l, j') for the same variable.
  std::map<std::tuple<int, int, int>, std::uint32_t> known;
  slots_.assign(1, 0);
  for (int j = 1; j < static_cast<int>(steps_.size()); ++j) {
    Step& step = steps_[static_cast<std::size_t>(j)];
    const int k = step.variable, p = step.predecessor;
    while (product(k, step.first) < p) ++step.first;
    for (int l = step.first; l < j; ++l) {
      const std::tuple key{k, l < p ? l : p, l < p ? p : l};
      const auto it = known.find(key);
      if (l < p && product(k, l) == p) {
        step.terms.push_back({Source::kNorm, 0});
      } else if (it != known.end()) {
        step.terms.push_back({Source::kReused, it->second});
      } else {
        const auto slot = static_cast<std::uint32_t>(known.size());
        known.emplace(key, slot);
        step.terms.push_back({Source::kComputed, slot});
      }
    }
    slots_.push_back(static_cast<std::uint32_t>(known.size()));
  }
}

template class PolynomialOrder<1>;
template class PolynomialOrder<2>;
template class PolynomialOrder<3>;

}  // namespace sansmesh::inline v1
