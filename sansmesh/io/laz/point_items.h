// Parts of point records that LAZ compresses in the same way point by point and in layers.
//
// Each part has a function code(coder, …, value) for both directions: an encoder reads `value`, a decoder sets it.
#pragma once

#include <cmath>
#include <cstring>

#include "sansmesh/io/laz/integer_model.h"

namespace sansmesh::inline v1::io::laz {

/// Differences of bytes are stored modulo 256.
inline std::uint8_t low_byte(int v) { return static_cast<std::uint8_t>(v); }
/// The low (half 0) or high byte.
inline std::uint8_t byte_of(std::uint16_t v, unsigned half) { return static_cast<std::uint8_t>(half ? v >> 8 : v); }

/// GPS times: the bits of four recent times as integers, and multiples of their latest differences.
/// `layered`: the time is known to differ from the previous one.
template <bool layered>
class TimeModel {
 public:
  void start(std::int64_t time) { times_[0] = time; }

  template <class Coder>
  void code(Coder& coder, std::int64_t& time) {
    // An encoder changes the sequence at most once.
    for (int tries = 0; tries < 4; ++tries) {
      Step step = Step::difference;
      unsigned detail = 0;
      if constexpr (Coder::kEncodes) choose(time, step, detail);
      if (differences_[last_] == 0)
        code_first(coder, step, detail);
      else
        code_multiple(coder, step, detail);
      switch (step) {
        case Step::unchanged:
          break;
        case Step::difference:
          code_difference(coder, detail, time);
          break;
        case Step::whole:
          code_whole(coder, time);
          break;
        case Step::other:
          last_ = (last_ + detail) & 3;
          continue;
      }
      time = times_[last_];
      return;
    }
    coder.set_damaged();
  }

 private:
  enum class Step : std::uint8_t { unchanged, difference, whole, other };
  static constexpr int kMost = 500, kLeast = -10;  ///< multiples
  static constexpr unsigned kUnchanged = kMost - kLeast + 1;

  std::int64_t distance(std::int64_t time, unsigned k) const {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(time) - static_cast<std::uint64_t>(times_[k]));
  }

  /// `detail`: for differences their multiple as it is coded, for other sequences how many further.
  void choose(std::int64_t time, Step& step, unsigned& detail) const {
    const auto is_near = [&](unsigned k) { return distance(time, k) == static_cast<std::int32_t>(distance(time, k)); };
    if (!layered && time == times_[last_]) {
      step = Step::unchanged;
    } else if (is_near(last_)) {
      if (differences_[last_] == 0) return;
      const float ratio = static_cast<float>(distance(time, last_)) / static_cast<float>(differences_[last_]);
      const auto multiple = static_cast<int>(std::round(std::min(std::max(ratio, -1000.0f), 1000.0f)));
      detail = static_cast<unsigned>(multiple >= 0 ? std::min(multiple, kMost) : kMost - std::max(multiple, kLeast));
    } else {
      step = Step::whole;
      for (unsigned i = 1; i < 4 && step == Step::whole; ++i)
        if (is_near((last_ + i) & 3)) step = Step::other, detail = i;
    }
  }

  /// After a sequence's first time there is no difference yet.
  template <class Coder>
  void code_first(Coder& coder, Step& step, unsigned& detail) {
    constexpr unsigned skipped = layered ? 1 : 0;
    unsigned s = step == Step::other ? 2 + detail : static_cast<unsigned>(step);
    s = coder.symbol(first_, s - skipped) + skipped;
    step = static_cast<Step>(std::min(s, 3u));
    if (step == Step::other) detail = s - 2;
  }

  template <class Coder>
  void code_multiple(Coder& coder, Step& step, unsigned& detail) {
    constexpr unsigned whole = layered ? kUnchanged : kUnchanged + 1;
    unsigned s = detail;
    if constexpr (Coder::kEncodes) {
      if (step == Step::unchanged) s = kUnchanged;
      if (step == Step::whole || step == Step::other) s = whole + detail;
    }
    s = coder.symbol(multiple_, s);
    step = s < kUnchanged ? Step::difference : s < whole ? Step::unchanged : s == whole ? Step::whole : Step::other;
    detail = step == Step::other ? s - whole : s;
  }

  template <class Coder>
  void code_difference(Coder& coder, unsigned multiple, std::int64_t time) {
    const auto wanted = static_cast<std::int32_t>(distance(time, last_));
    std::int32_t& previous = differences_[last_];
    std::uint8_t& unusual = unusual_[last_];
    std::int32_t difference = 0;
    if (previous == 0) {
      previous = difference = model_.code(coder, 0, wanted, 0);
      unusual = 0;
    } else {
      const int factor = multiple <= kMost ? static_cast<int>(multiple) : kMost - static_cast<int>(multiple);
      const auto predicted =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(factor) * static_cast<std::uint32_t>(previous));
      const unsigned context = factor == 0        ? 7
                               : factor == 1      ? 1
                               : factor == kMost  ? 4
                               : factor == kLeast ? 6
                               : factor < 0       ? 5
                               : factor < 10      ? 2
                                                  : 3;
      difference = model_.code(coder, predicted, wanted, context);
      if (factor == 1) unusual = 0;
      if ((factor == 0 || factor == kMost || factor == kLeast) && ++unusual > 3) previous = difference, unusual = 0;
    }
    times_[last_] = static_cast<std::int64_t>(static_cast<std::uint64_t>(times_[last_]) +
                                              static_cast<std::uint64_t>(std::int64_t{difference}));
  }

  template <class Coder>
  void code_whole(Coder& coder, std::int64_t time) {
    const auto high = [](std::int64_t t) { return static_cast<std::int32_t>(t >> 32); };
    const auto upper = static_cast<std::uint32_t>(model_.code(coder, high(times_[last_]), high(time), 8));
    const std::uint32_t lower = coder.bits(32, static_cast<std::uint32_t>(time));
    last_ = next_ = (next_ + 1) & 3;
    times_[last_] = static_cast<std::int64_t>(std::uint64_t{upper} << 32 | lower);
    differences_[last_] = 0, unusual_[last_] = 0;
  }

  SymbolModel<layered ? 5 : 6> first_;
  SymbolModel<layered ? 515 : 516> multiple_;
  IntegerModel<32, 9> model_;
  unsigned last_, next_;
  std::array<std::int64_t, 4> times_;
  std::array<std::int32_t, 4> differences_;
  std::array<std::uint8_t, 4> unusual_;
};

/// Red, green and blue of 16 bits.
using Rgb = std::array<std::uint16_t, 3>;

class RgbModel {
 public:
  template <class Coder>
  void code(Coder& coder, const Rgb& last, Rgb& rgb) {
    unsigned changed = 0;
    if constexpr (Coder::kEncodes) {
      for (unsigned c = 0; c < 3; ++c) {
        const unsigned d = last[c] ^ rgb[c];
        changed |= ((d & 0xff) != 0) << 2 * c | (d >> 8 != 0) << (2 * c + 1);
      }
      changed |= (rgb[0] != rgb[1] || rgb[0] != rgb[2]) << 6;
    }
    changed = coder.symbol(changed_, changed);
    std::array<std::array<std::uint8_t, 2>, 3> now;  // low and high bytes
    const bool gray = (changed & 64) == 0;
    const auto code_byte = [&](unsigned c, unsigned half, int predicted) {
      now[c][half] = byte_of(last[c], half);
      if (!(changed >> (2 * c + half) & 1)) return;
      predicted = std::clamp(predicted, 0, 255);
      const unsigned d = coder.symbol(differences_[2 * c + half], low_byte(byte_of(rgb[c], half) - predicted));
      now[c][half] = low_byte(predicted + static_cast<int>(d));
    };
    for (unsigned half = 0; half < 2; ++half) code_byte(0, half, byte_of(last[0], half));
    for (unsigned half = 0; half < 2 && !gray; ++half) {
      const int red = now[0][half] - byte_of(last[0], half);
      code_byte(1, half, red + byte_of(last[1], half));
      const int green = now[1][half] - byte_of(last[1], half);
      code_byte(2, half, (red + green) / 2 + byte_of(last[2], half));
    }
    for (unsigned c = 0; c < 3; ++c) {
      const auto& bytes = now[gray ? 0 : c];
      rgb[c] = static_cast<std::uint16_t>(bytes[1] << 8 | bytes[0]);
    }
  }

 private:
  SymbolModel<128> changed_;
  std::array<SymbolModel<256>, 6> differences_;  ///< low and high byte of red, then of green and blue
};

/// Wave packet: index of its descriptor, offset and size of its bytes, location of the return, direction.
class WaveModel {
 public:
  static constexpr std::size_t kBytes = 29;

  template <class Coder, class Bytes>
  void code(Coder& coder, const char* last, Bytes* record) {
    using i32 = std::int32_t;
    using u64 = std::uint64_t;
    const auto at = [](const char* p, std::size_t offset, auto v) {
      std::memcpy(&v, p + offset, sizeof v);
      return v;
    };
    const auto given = [&](std::size_t offset, auto v) { return Coder::kEncodes ? at(record, offset, v) : v; };
    const auto set = [&](std::size_t offset, auto v) {
      if constexpr (!Coder::kEncodes) std::memcpy(record + offset, &v, sizeof v);
    };
    set(0, low_byte(static_cast<int>(coder.symbol(descriptor_, given(0, std::uint8_t{})))));
    const u64 old = at(last, 1, u64{}), size = at(last, 9, std::uint32_t{});
    u64 offset = given(1, u64{});
    unsigned kind = 3;
    if constexpr (Coder::kEncodes) {
      const auto d = static_cast<std::int64_t>(offset - old);
      if (d == static_cast<i32>(d)) kind = d == 0 ? 0 : d == static_cast<i32>(size) ? 1 : 2;
    }
    kind_ = kind = coder.symbol(kinds_[kind_], kind);
    if (kind == 0) offset = old;
    if (kind == 1) offset = old + size;
    if (kind == 2) {
      difference_ = difference_model_.code(coder, difference_, static_cast<i32>(offset - old));
      offset = old + static_cast<u64>(std::int64_t{difference_});
    }
    if (kind == 3) {
      const std::uint32_t low = coder.bits(32, static_cast<std::uint32_t>(offset));
      offset = u64{coder.bits(32, static_cast<std::uint32_t>(offset >> 32))} << 32 | low;
    }
    set(1, offset);
    set(9, size_.code(coder, at(last, 9, i32{}), given(9, i32{})));
    set(13, location_.code(coder, at(last, 13, i32{}), given(13, i32{})));
    for (unsigned k = 0; k < 3; ++k)
      set(17 + 4 * k, direction_.code(coder, at(last, 17 + 4 * k, i32{}), given(17 + 4 * k, i32{}), k));
  }

 private:
  SymbolModel<256> descriptor_;
  std::array<SymbolModel<4>, 4> kinds_;
  IntegerModel<32> difference_model_, size_, location_;
  IntegerModel<32, 3> direction_;
  unsigned kind_;
  std::int32_t difference_;
};

}  // namespace sansmesh::inline v1::io::laz
