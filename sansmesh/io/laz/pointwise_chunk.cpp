#include "sansmesh/io/laz/pointwise_chunk.h"

#include <memory>
#include <vector>

#include "sansmesh/io/binary.h"
#include "sansmesh/io/laz/first_items.h"
#include "sansmesh/io/laz/point10.h"
#include "sansmesh/io/laz/point_items.h"
#include "sansmesh/io/laz/return_contexts.h"
#include "sansmesh/io/laz/running_median.h"

namespace sansmesh::inline v1::io::laz {
namespace {

class Point10Model {
 public:
  void start(const Point10& first) {
    last_ = first;
    last_.intensity = 0;
  }

  template <class Coder>
  void code(Coder& coder, Point10& p) {
    unsigned changed = 0;
    if constexpr (Coder::kEncodes) {
      changed = (p.returns != last_.returns) << 5 | (p.intensity != intensity_[context(p)]) << 4 |
                (p.classification != last_.classification) << 3 | (p.angle != last_.angle) << 2 |
                (p.user_data != last_.user_data) << 1 | (p.source != last_.source);
    }
    changed = coder.symbol(changed_, changed);
    const auto code_byte = [&](unsigned bit, auto& models, std::uint8_t last, std::uint8_t& now) {
      if (changed & bit)
        now = low_byte(static_cast<int>(coder.symbol(models[last], now)));
      else if constexpr (!Coder::kEncodes)
        now = last;
    };
    code_byte(32, returns_, last_.returns, p.returns);
    const unsigned c = context(p);
    if (changed & 16)
      intensity_[c] =
          static_cast<std::uint16_t>(intensity_model_.code(coder, intensity_[c], p.intensity, std::min(c, 3u)));
    p.intensity = intensity_[c];
    code_byte(8, classification_, last_.classification, p.classification);
    if (changed & 4)
      p.angle = low_byte(last_.angle +
                         static_cast<int>(coder.symbol(angle_[p.returns >> 6 & 1], low_byte(p.angle - last_.angle))));
    else
      p.angle = last_.angle;
    code_byte(2, user_data_, last_.user_data, p.user_data);
    p.source = changed & 1 ? static_cast<std::uint16_t>(source_.code(coder, last_.source, p.source)) : last_.source;
    code_position(coder, p, c);
    last_ = p;
  }

 private:
  static unsigned number(const Point10& p) { return p.returns & 7; }
  static unsigned count(const Point10& p) { return p.returns >> 3 & 7; }
  static unsigned context(const Point10& p) { return kReturnContext[count(p)][number(p)]; }

  template <class Coder>
  void code_position(Coder& coder, Point10& p, unsigned c) {
    const unsigned single = count(p) == 1;
    p.x = code_step(coder, dx_, x_[c], last_.x, p.x, single);
    const unsigned bits = dx_.bits();
    p.y = code_step(coder, dy_, y_[c], last_.y, p.y, single + (bits < 20 ? bits & ~1u : 20));
    const unsigned both = (bits + dy_.bits()) / 2;
    std::int32_t& height = height_[return_level(count(p), number(p))];
    p.z = height = z_.code(coder, height, p.z, single + (both < 18 ? both & ~1u : 18));
  }

  Point10 last_;
  std::array<std::uint16_t, 16> intensity_;
  std::array<std::int32_t, 8> height_;
  std::array<RunningMedian, 16> x_, y_;
  SymbolModel<64> changed_;
  std::array<SymbolModel<256>, 2> angle_;
  IntegerModel<16, 4> intensity_model_;
  IntegerModel<16> source_;
  IntegerModel<32, 2> dx_;
  IntegerModel<32, 22> dy_;
  IntegerModel<32, 20> z_;
  SparseModels<256, 256> returns_, classification_, user_data_;
};

/// Extra bytes, each with a model of its difference to the last one.
class BytesModel {
 public:
  explicit BytesModel(std::size_t count) : differences_(count) {}

  template <class Coder>
  std::uint8_t code(Coder& coder, std::size_t k, std::uint8_t last, std::uint8_t wanted) {
    return low_byte(last + static_cast<int>(coder.symbol(differences_[k], low_byte(wanted - last))));
  }

 private:
  std::vector<SymbolModel<256>> differences_;
};

struct PointwiseModels {
  Point10Model point;
  TimeModel<false> time;
  RgbModel rgb;
  WaveModel wave;
  using Bytes = BytesModel;
};

/// Models of version 1.
struct FirstModels {
  FirstPointModel point;
  FirstTimeModel time;
  FirstRgbModel rgb;
  WaveModel wave;
  using Bytes = FirstBytesModel;
};

/// Codes all points but the first, whose record is stored.
template <class Models, class Coder, class Bytes>
void code_points(Coder& coder, const LazLayout& l, Bytes* records, std::size_t count) {
  if (count == 1) return;
  const auto models = std::make_unique<Models>();
  typename Models::Bytes extra(l.extra_bytes);
  models->point.start(load<Point10>(records));
  if (l.time) models->time.start(load<std::int64_t>(records + l.time));
  const auto give = [](Bytes* p, const auto& value) {
    if constexpr (!Coder::kEncodes) std::memcpy(p, &value, sizeof value);
  };
  const auto given = [](Bytes* p, auto value) {
    if constexpr (Coder::kEncodes) value = load<decltype(value)>(p);
    return value;
  };
  Rgb last_rgb = {};
  if (l.rgb) last_rgb = load<Rgb>(records + l.rgb);
  for (std::size_t i = 1; i < count; ++i) {
    Bytes* const p = records + i * l.record;
    if constexpr (!Coder::kEncodes)
      if (coder.damaged()) return;
    Point10 point = given(p, Point10{});
    models->point.code(coder, point);
    give(p, point);
    if (l.time) {
      std::int64_t time = given(p + l.time, std::int64_t{});
      models->time.code(coder, time);
      give(p + l.time, time);
    }
    if (l.rgb) {
      Rgb rgb = given(p + l.rgb, Rgb{});
      models->rgb.code(coder, last_rgb, rgb);
      last_rgb = rgb;
      give(p + l.rgb, rgb);
    }
    if (l.wave) models->wave.code(coder, p + l.wave - l.record, p + l.wave);
    for (std::size_t k = 0; k < l.extra_bytes; ++k) {
      Bytes* const byte = p + l.extra + k;
      const auto last = load<std::uint8_t>(byte - l.record);
      give(byte, extra.code(coder, k, last, given(byte, std::uint8_t{})));
    }
  }
}

}  // namespace

void encode_pointwise(const LazLayout& layout, const char* records, std::size_t count, std::string& out) {
  ArithmeticEncoder encoder;
  if (layout.first_version)
    code_points<FirstModels>(encoder, layout, records, count);
  else
    code_points<PointwiseModels>(encoder, layout, records, count);
  out.append(records, layout.record);
  out += encoder.finish();
}

std::size_t decode_pointwise(const LazLayout& layout, std::string_view bytes, std::size_t count, char* records) {
  if (bytes.size() < layout.record) return 0;
  std::memcpy(records, bytes.data(), layout.record);
  const std::string_view packed = bytes.substr(layout.record);
  ArithmeticDecoder decoder(packed);
  if (layout.first_version)
    code_points<FirstModels>(decoder, layout, records, count);
  else
    code_points<PointwiseModels>(decoder, layout, records, count);
  return decoder.damaged() ? 0 : layout.record + decoder.position(packed);
}

}  // namespace sansmesh::inline v1::io::laz
