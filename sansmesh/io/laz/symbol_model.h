// Adaptive probability models of LAZ's arithmetic coder (isenburg2013; said2004).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace sansmesh::inline v1::io::laz {

/// Binary model. All models are ready for use if their bytes are 0: the first use initialises them.
class BitModel {
 public:
  static constexpr unsigned kShift = 13;  ///< log2 of the total probability

  /// Probability of 0, in 2^-kShift.
  std::uint32_t zero() {
    if (left_ == 0) refresh();
    return probability_;
  }
  void count(unsigned bit) {
    zeros_ += bit == 0;
    --left_;
  }

 private:
  void refresh() {
    if (cycle_ == 0) {
      zeros_ = 1, all_ = 2, probability_ = 1u << (kShift - 1);
      cycle_ = left_ = 4;
      return;
    }
    all_ += cycle_;
    if (all_ > 1u << kShift) {
      all_ = (all_ + 1) >> 1, zeros_ = (zeros_ + 1) >> 1;
      if (zeros_ == all_) ++all_;
    }
    probability_ = zeros_ * (0x80000000u / all_) >> (31 - kShift);
    cycle_ = left_ = std::min(5 * cycle_ >> 2, 64u);
  }

  std::uint32_t left_, cycle_, zeros_, all_, probability_;
};

/// Model of symbols 0..N-1.
template <unsigned N>
class SymbolModel {
 public:
  static constexpr unsigned kSymbols = N;
  static constexpr unsigned kShift = 15;  ///< log2 of the total probability

  /// Updates the distribution if it is due. `tables`: also the table of `find`.
  template <bool tables>
  void prepare() {
    if (left_ == 0) refresh<tables>();
  }
  /// Sum of the probabilities of all symbols before `symbol`, in 2^-kShift.
  std::uint32_t below(unsigned symbol) const { return below_[symbol]; }
  /// The symbol with below(symbol) <= value < below(symbol + 1). `value` is at most 2^kShift + 64: rounding of the
  /// coder's interval adds a few values to the last symbol.
  unsigned find(std::uint32_t value) const {
    if constexpr (kTable) {
      unsigned symbol = table_[value >> kTableShift];
      while (below_[symbol + 1] <= value) ++symbol;
      return symbol;
    } else {
      unsigned symbol = 0;
      for (unsigned k = 1; k < N; ++k) symbol += below_[k] <= value;
      return symbol;
    }
  }
  void count(unsigned symbol) {
    ++counts_[symbol];
    --left_;
  }

 private:
  static constexpr bool kTable = N > 16;
  static constexpr unsigned kTableBits = kTable ? std::min(static_cast<unsigned>(std::bit_width(N - 1)), 8u) : 0;
  static constexpr unsigned kTableShift = kShift - kTableBits;
  using Entry = std::conditional_t<(N > 256), std::uint16_t, std::uint8_t>;

  template <bool tables>
  void refresh() {
    constexpr std::uint32_t most = 1u << kShift;
    total_ = cycle_ == 0 ? N : total_ + cycle_;
    if (cycle_ == 0) counts_.fill(1);
    if (total_ > most) {
      total_ = 0;
      for (std::uint16_t& c : counts_) total_ += c = static_cast<std::uint16_t>((c + 1) >> 1);
    }
    const std::uint32_t scale = 0x80000000u / total_;
    std::uint32_t sum = 0;
    for (unsigned k = 0; k < N; ++k) {
      below_[k] = static_cast<std::uint16_t>(scale * sum >> (31 - kShift));
      sum += counts_[k];
    }
    below_[N] = 0xffff;
    if constexpr (kTable && tables) {
      unsigned entry = 0;
      for (unsigned k = 1; k < N; ++k)
        for (const unsigned end = (below_[k] - 1u) >> kTableShift; entry <= end; ++entry)
          table_[entry] = static_cast<Entry>(k - 1);
      for (; entry < table_.size(); ++entry) table_[entry] = static_cast<Entry>(N - 1);
    }
    const unsigned next = cycle_ == 0 ? (N + 6) >> 1 : std::min(5u * cycle_ >> 2, (N + 6) << 3);
    cycle_ = left_ = static_cast<std::uint16_t>(next);
  }

  std::uint16_t left_, cycle_;
  std::uint32_t total_;
  std::array<std::uint16_t, N> counts_;
  std::array<std::uint16_t, N + 1> below_;
  /// The symbol at the first place of each stretch of 2^kTableShift places, and one stretch more for rounding.
  std::array<Entry, kTable ? (1u << kTableBits) + 1 : 0> table_;
};

/// Models of many contexts, each of which is created at its first use: chunks of few points use few of them.
template <unsigned N, unsigned Contexts>
class SparseModels {
 public:
  SymbolModel<N>& operator[](unsigned context) {
    std::unique_ptr<SymbolModel<N>>& model = models_[context];
    if (!model) model = std::make_unique<SymbolModel<N>>();
    return *model;
  }

 private:
  std::array<std::unique_ptr<SymbolModel<N>>, Contexts> models_;
};

}  // namespace sansmesh::inline v1::io::laz
