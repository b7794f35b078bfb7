// Parts of point records in version 1 of the format, of writers before 2011; compare point_items.h.
#pragma once

#include <vector>

#include "sansmesh/io/laz/point10.h"
#include "sansmesh/io/laz/point_items.h"

namespace sansmesh::inline v1::io::laz {

/// Median of the last three numbers.
class MedianOfThree {
 public:
  std::int32_t value() const {
    const auto& v = last_;
    return std::max(std::min(v[0], v[1]), std::min(std::max(v[0], v[1]), v[2]));
  }
  void add(std::int32_t v) {
    last_[next_] = v;
    next_ = (next_ + 1) % 3;
  }

 private:
  std::array<std::int32_t, 3> last_;
  unsigned next_;
};

class FirstPointModel {
 public:
  void start(const Point10& first) { last_ = first; }

  template <class Coder>
  void code(Coder& coder, Point10& p) {
    p.x = code_step(coder, dx_, x_, last_.x, p.x, 0);
    const unsigned x_bits = dx_.bits();
    p.y = code_step(coder, dy_, y_, last_.y, p.y, std::min(x_bits, 19u));
    const unsigned bits = (x_bits + dy_.bits()) / 2;
    p.z = z_.code(coder, last_.z, p.z, std::min(bits, 19u));
    unsigned changed = 0;
    if constexpr (Coder::kEncodes) {
      changed = (p.intensity != last_.intensity) << 5 | (p.returns != last_.returns) << 4 |
                (p.classification != last_.classification) << 3 | (p.angle != last_.angle) << 2 |
                (p.user_data != last_.user_data) << 1 | (p.source != last_.source);
    }
    changed = coder.symbol(changed_, changed);
    Point10 now = last_;
    now.x = p.x, now.y = p.y, now.z = p.z;
    if (changed & 32) now.intensity = static_cast<std::uint16_t>(intensity_.code(coder, last_.intensity, p.intensity));
    const auto code_byte = [&](auto& models, std::uint8_t last, std::uint8_t wanted) {
      return low_byte(static_cast<int>(coder.symbol(models[last], wanted)));
    };
    if (changed & 16) now.returns = code_byte(returns_, last_.returns, p.returns);
    if (changed & 8) now.classification = code_byte(classification_, last_.classification, p.classification);
    if (changed & 4) now.angle = low_byte(angle_.code(coder, last_.angle, p.angle, bits < 3));
    if (changed & 2) now.user_data = code_byte(user_data_, last_.user_data, p.user_data);
    if (changed & 1) now.source = static_cast<std::uint16_t>(source_.code(coder, last_.source, p.source));
    last_ = p = now;
  }

 private:
  Point10 last_;
  MedianOfThree x_, y_;
  SymbolModel<64> changed_;
  IntegerModel<32> dx_;
  IntegerModel<32, 20> dy_, z_;
  IntegerModel<16> intensity_, source_;
  IntegerModel<8, 2> angle_;
  SparseModels<256, 256> returns_, classification_, user_data_;
};

/// Times: multiples of the last difference, or whole times.
class FirstTimeModel {
 public:
  void start(std::int64_t time) { last_ = time; }

  template <class Coder>
  void code(Coder& coder, std::int64_t& time) {
    const auto distance =
        static_cast<std::int64_t>(static_cast<std::uint64_t>(time) - static_cast<std::uint64_t>(last_));
    const auto wanted = static_cast<std::int32_t>(distance);
    unsigned s = 0;
    if constexpr (Coder::kEncodes) s = choose(distance);
    s = difference_ == 0 ? coder.symbol(first_, s) : coder.symbol(multiple_, s);
    const bool is_first = difference_ == 0;
    const unsigned whole = is_first ? 2 : kWhole, unchanged = is_first ? 0 : kWhole + 1;
    if (s == whole) {
      const std::uint32_t low = coder.bits(32, static_cast<std::uint32_t>(time));
      const std::uint64_t high = coder.bits(32, static_cast<std::uint32_t>(time >> 32));
      last_ = static_cast<std::int64_t>(high << 32 | low);
    } else if (s != unchanged) {
      const std::int32_t d =
          is_first ? difference_ = model_.code(coder, 0, wanted, 0) : code_multiple(coder, s, wanted);
      last_ =
          static_cast<std::int64_t>(static_cast<std::uint64_t>(last_) + static_cast<std::uint64_t>(std::int64_t{d}));
    }
    time = last_;
  }

 private:
  static constexpr unsigned kMost = 509, kWhole = 510;

  unsigned choose(std::int64_t distance) const {
    const bool is_first = difference_ == 0;
    if (distance == 0) return is_first ? 0 : kWhole + 1;
    if (distance != static_cast<std::int32_t>(distance)) return is_first ? 2 : kWhole;
    if (is_first) return 1;
    const float ratio = static_cast<float>(distance) / static_cast<float>(difference_);
    return static_cast<unsigned>(std::round(std::clamp(ratio, 0.0f, static_cast<float>(kMost))));
  }

  template <class Coder>
  std::int32_t code_multiple(Coder& coder, unsigned multiple, std::int32_t wanted) {
    const auto predicted = static_cast<std::int32_t>(multiple * static_cast<std::uint32_t>(difference_));
    const unsigned context = multiple == 0 ? 2 : multiple == 1 ? 1 : multiple < 10 ? 3 : multiple < 50 ? 4 : 5;
    const std::int32_t d = model_.code(coder, multiple == 0 ? difference_ / 4 : predicted, wanted, context);
    if (multiple == 1) difference_ = d, unusual_ = 0;
    if ((multiple == 0 || multiple == kMost) && ++unusual_ > 3) difference_ = d, unusual_ = 0;
    return d;
  }

  SymbolModel<3> first_;
  SymbolModel<512> multiple_;
  IntegerModel<32, 6> model_;
  std::int64_t last_;
  std::int32_t difference_;
  unsigned unusual_;
};

class FirstRgbModel {
 public:
  template <class Coder>
  void code(Coder& coder, const Rgb& last, Rgb& rgb) {
    unsigned changed = 0;
    if constexpr (Coder::kEncodes) {
      for (unsigned k = 0; k < 6; ++k)
        changed |= static_cast<unsigned>(byte_of(last[k / 2], k % 2) != byte_of(rgb[k / 2], k % 2)) << k;
    }
    changed = coder.symbol(changed_, changed);
    Rgb now = {};
    for (unsigned k = 0; k < 6; ++k) {
      int byte = byte_of(last[k / 2], k % 2);
      if (changed >> k & 1) byte = low_byte(bytes_.code(coder, byte, byte_of(rgb[k / 2], k % 2), k));
      now[k / 2] = static_cast<std::uint16_t>(now[k / 2] | byte << 8 * (k % 2));
    }
    rgb = now;
  }

 private:
  SymbolModel<64> changed_;
  IntegerModel<8, 6> bytes_;
};

/// Extra bytes.
class FirstBytesModel {
 public:
  explicit FirstBytesModel(std::size_t count) : lengths_(count) {}

  template <class Coder>
  std::uint8_t code(Coder& coder, std::size_t k, std::uint8_t last, std::uint8_t wanted) {
    return low_byte(model_.code_in(coder, lengths_[k], last, wanted));
  }

 private:
  IntegerModel<8> model_ = {};
  std::vector<SymbolModel<9>> lengths_;
};

}  // namespace sansmesh::inline v1::io::laz
