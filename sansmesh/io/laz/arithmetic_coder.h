// Arithmetic coder of LAZ (isenburg2013; said2004, with 32-bit intervals that shrink by whole bytes).
//
// Encoder and decoder have the same functions: value = coder.symbol(model, value) writes a value that it returns, or
// ignores it and returns the next one. So one description of a format serves both directions.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/io/laz/symbol_model.h"

namespace sansmesh::inline v1::io::laz {

inline constexpr std::uint32_t kShortest = 1u << 24;  ///< shorter intervals are extended by a byte

class ArithmeticDecoder {
 public:
  static constexpr bool kEncodes = false;

  explicit ArithmeticDecoder(std::string_view bytes)
      : at_(reinterpret_cast<const unsigned char*>(bytes.data())), end_(at_ + bytes.size()) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next();
    if (value_ == length_) value_ = 0, wrong_ = true;
  }

  /// Whether no encoder produces these bytes: they end early or contradict themselves.
  bool damaged() const { return wrong_ || missing_ > kSlack; }
  /// Marks a contradiction that the caller has found.
  void set_damaged() { wrong_ = true; }
  /// Bytes read so far, if there were enough.
  std::size_t position(std::string_view bytes) const {
    return static_cast<std::size_t>(at_ - reinterpret_cast<const unsigned char*>(bytes.data()));
  }

  template <unsigned N>
  unsigned symbol(SymbolModel<N>& model, unsigned = 0) {
    model.template prepare<true>();
    const std::uint32_t unit = length_ >> SymbolModel<N>::kShift;
    const unsigned s = model.find(value_ / unit);
    const std::uint32_t first = model.below(s) * unit;
    // The last symbol includes the values that the division of the interval has left over.
    length_ = (s + 1 < N ? model.below(s + 1) * unit : length_) - first;
    value_ -= first;
    extend();
    model.count(s);
    return s;
  }
  unsigned bit(BitModel& model, unsigned = 0) {
    const std::uint32_t zero = model.zero() * (length_ >> BitModel::kShift);
    const unsigned b = value_ >= zero;
    length_ = b ? length_ - zero : zero;
    value_ -= b ? zero : 0;
    extend();
    model.count(b);
    return b;
  }
  /// A number of `count` (1 to 32) equally probable bits.
  std::uint32_t bits(unsigned count, std::uint32_t = 0) {
    if (count > 19) {
      const std::uint32_t low = few_bits(16);
      return few_bits(count - 16) << 16 | low;
    }
    return few_bits(count);
  }

 private:
  /// An encoder pads its bytes so that a decoder reads none beyond them; some writers pad less.
  static constexpr unsigned kSlack = 8;

  unsigned next() {
    if (at_ < end_) return *at_++;
    ++missing_;
    return 0;
  }
  void extend() {
    while (length_ < kShortest) {
      value_ = value_ << 8 | next();
      length_ <<= 8;
    }
  }
  std::uint32_t few_bits(unsigned count) {
    length_ >>= count;
    const std::uint32_t v = value_ / length_;
    value_ -= v * length_;
    extend();
    if (v >> count) wrong_ = true;
    return v & ((1u << count) - 1);
  }

  std::uint32_t value_ = 0, length_ = 0xffffffff;
  const unsigned char* at_;
  const unsigned char* end_;
  unsigned missing_ = 0;
  bool wrong_ = false;
};

class ArithmeticEncoder {
 public:
  static constexpr bool kEncodes = true;

  template <unsigned N>
  unsigned symbol(SymbolModel<N>& model, unsigned s) {
    model.template prepare<false>();
    const std::uint32_t unit = length_ >> SymbolModel<N>::kShift;
    const std::uint32_t first = model.below(s) * unit;
    narrow(first, (s + 1 < N ? model.below(s + 1) * unit : length_) - first);
    model.count(s);
    return s;
  }
  unsigned bit(BitModel& model, unsigned b) {
    const std::uint32_t zero = model.zero() * (length_ >> BitModel::kShift);
    narrow(b ? zero : 0, b ? length_ - zero : zero);
    model.count(b);
    return b;
  }
  std::uint32_t bits(unsigned count, std::uint32_t v) {
    if (count > 19) {
      few_bits(16, v & 0xffff);
      few_bits(count - 16, v >> 16);
    } else {
      few_bits(count, v);
    }
    return v;
  }
  void set_damaged() {}

  /// The bytes, padded for the decoder, which reads ahead.
  std::string finish() {
    const bool wide = length_ > 2 * kShortest;
    narrow(wide ? kShortest : kShortest >> 1, wide ? kShortest >> 1 : kShortest >> 9);
    bytes_.append(wide ? 3 : 2, '\0');
    return std::move(bytes_);
  }

 private:
  void few_bits(unsigned count, std::uint32_t v) {
    const std::uint32_t unit = length_ >> count;
    narrow(v * unit, unit);
  }
  void narrow(std::uint32_t first, std::uint32_t length) {
    if (base_ + first < base_) carry();
    base_ += first;
    length_ = length;
    while (length_ < kShortest) {
      bytes_.push_back(static_cast<char>(base_ >> 24));
      base_ <<= 8, length_ <<= 8;
    }
  }
  void carry() {
    for (auto p = bytes_.rbegin(); p != bytes_.rend(); ++p)
      if (static_cast<unsigned char>(++*p) != 0) return;
  }

  std::uint32_t base_ = 0, length_ = 0xffffffff;
  std::string bytes_;
};

}  // namespace sansmesh::inline v1::io::laz
