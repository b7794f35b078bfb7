// Models of integers in LAZ: the difference to a prediction as the number of its bits and its offset among the numbers
// with as many bits.
#pragma once

#include <cstdint>

#include "sansmesh/io/laz/arithmetic_coder.h"

namespace sansmesh::inline v1::io::laz {

/// Integers of `Bits` (8, 16 or 32) bits in one of several contexts.
template <unsigned Bits, unsigned Contexts = 1>
class IntegerModel {
 public:
  /// Codes `value`. Integers of less than 32 bits are unsigned.
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t predicted, std::int32_t value, unsigned context = 0) {
    return code_in(coder, lengths_[context], predicted, value);
  }
  /// The same with a context of the caller.
  template <class Coder>
  std::int32_t code_in(Coder& coder, SymbolModel<Bits + 1>& lengths, std::int32_t predicted, std::int32_t value) {
    std::uint32_t difference = 0;
    if constexpr (Coder::kEncodes) difference = wrap(static_cast<std::uint32_t>(value) - predicted);
    // Differences of k bits are -(2^k - 1)..-2^(k-1) and 2^(k-1) + 1..2^k; those of 0 bits are 0 and 1.
    const auto d = static_cast<std::int32_t>(difference);
    bits_ = static_cast<unsigned>(std::bit_width(d <= 0 ? 0u - difference : difference - 1));
    bits_ = coder.symbol(lengths, bits_);
    difference = code_place(coder, difference);
    if constexpr (Coder::kEncodes) return value;
    const std::uint32_t sum = static_cast<std::uint32_t>(predicted) + difference;
    if constexpr (Bits < 32) return static_cast<std::int32_t>(sum & ((1u << Bits) - 1));
    return static_cast<std::int32_t>(sum);
  }
  /// Bits of the difference that was coded last.
  unsigned bits() const { return bits_; }

 private:
  static constexpr unsigned kHigh = 8;  ///< higher bits of a difference have models, lower ones do not

  /// The difference modulo 2^Bits that is nearest to 0, with its sign.
  static std::uint32_t wrap(std::uint32_t difference) {
    if constexpr (Bits == 32) return difference;
    constexpr std::uint32_t half = 1u << (Bits - 1);
    return ((difference + half) & (2 * half - 1)) - half;
  }

  template <class Coder>
  std::uint32_t code_place(Coder& coder, std::uint32_t difference) {
    const unsigned k = bits_;
    if (k == 0) return coder.bit(one_, difference);
    if (k >= 32) return 0x80000000u;
    const std::uint32_t half = 1u << (k - 1);
    std::uint32_t offset = 0;
    if constexpr (Coder::kEncodes)
      offset = static_cast<std::int32_t>(difference) < 0 ? difference + (2 * half - 1) : difference - 1;
    if (k <= kHigh) {
      offset = code_low(coder, offset);
    } else if constexpr (Bits > kHigh) {
      const unsigned rest = k - kHigh;
      const std::uint32_t high = coder.symbol(high_[rest - 1], offset >> rest);
      offset = high << rest | coder.bits(rest, offset & ((1u << rest) - 1));
    }
    return offset >= half ? offset + 1 : offset - (2 * half - 1);
  }

  template <class Coder>
  unsigned code_low(Coder& coder, unsigned offset) {
    switch (bits_) {
      case 1:
        return coder.symbol(low1_, offset);
      case 2:
        return coder.symbol(low2_, offset);
      case 3:
        return coder.symbol(low3_, offset);
      case 4:
        return coder.symbol(low4_, offset);
      case 5:
        return coder.symbol(low5_, offset);
      case 6:
        return coder.symbol(low6_, offset);
      case 7:
        return coder.symbol(low7_, offset);
      default:
        return coder.symbol(low8_, offset);
    }
  }

  unsigned bits_;
  std::array<SymbolModel<Bits + 1>, Contexts> lengths_;
  BitModel one_;
  SymbolModel<2> low1_;
  SymbolModel<4> low2_;
  SymbolModel<8> low3_;
  SymbolModel<16> low4_;
  SymbolModel<32> low5_;
  SymbolModel<64> low6_;
  SymbolModel<128> low7_;
  SymbolModel<256> low8_;
  std::array<SymbolModel<256>, Bits - kHigh> high_;
};

}  // namespace sansmesh::inline v1::io::laz
