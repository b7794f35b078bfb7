// Layers of point formats 6 to 10. Each function codes one layer of a chunk in both directions; see layered_chunk.h.
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/io/binary.h"
#include "sansmesh/io/laz/laz_layout.h"
#include "sansmesh/io/laz/point_items.h"
#include "sansmesh/io/laz/return_contexts.h"
#include "sansmesh/io/laz/running_median.h"

namespace sansmesh::inline v1::io::laz {

/// Records of a chunk. Decoders write them; the first record is stored uncompressed.
template <class Bytes>
struct LayerRecords {
  Bytes* first;
  std::size_t stride, count;
  bool fixed_channels;  ///< version 4

  Bytes* at(std::size_t i) const { return first + i * stride; }
};

/// Contexts of a point in all layers, from the first layer.
struct PointStep {
  std::uint8_t channel;
  std::uint8_t end : 2;  ///< 1 for the last return, plus 2 for the first one
  std::uint8_t time_changed : 1;
  std::uint8_t angle_changed : 1;
  std::uint8_t source_changed : 1;
  std::uint8_t channel_changed : 1;
  std::uint8_t level;      ///< return_level
  std::uint8_t z_context;  ///< from the sizes of the steps in x and y
};

/// A part of a record: the bits of `mask` in each byte.
struct LayerField {
  std::size_t offset, bytes;
  std::uint8_t mask = 0xff;
};

/// Copies the field of the first record to all others: its layer is left out.
inline void repeat_first(const LayerRecords<char>& r, const LayerField& f) {
  for (std::size_t i = 1; i < r.count; ++i)
    for (std::size_t k = f.offset; k < f.offset + f.bytes; ++k)
      r.at(i)[k] = static_cast<char>((r.at(i)[k] & ~f.mask) | (r.first[k] & f.mask));
}

inline bool is_constant(const LayerRecords<const char>& r, const LayerField& f) {
  for (std::size_t i = 1; i < r.count; ++i)
    for (std::size_t k = f.offset; k < f.offset + f.bytes; ++k)
      if ((r.at(i)[k] ^ r.first[k]) & f.mask) return false;
  return true;
}

/// The value in a record for encoders, 0 for decoders.
template <class Coder, class T>
T given(const char* p) {
  if constexpr (Coder::kEncodes) return load<T>(p);
  return T{};
}

template <class Coder, class Bytes, class T>
void give(Bytes* p, const T& value) {
  if constexpr (!Coder::kEncodes) std::memcpy(p, &value, sizeof value);
}

template <class Coder>
bool is_damaged(const Coder& coder) {
  if constexpr (!Coder::kEncodes) return coder.damaged();
  return false;
}

/// Calls code(model, last, record, step) for all points but the first. `model` is that of the point's channel; at the
/// first point of a channel, start(model, previous record, model of the previous record or null) initialises it. `last`
/// is the model that holds the last point. False if the bytes of a decoder are damaged. `attached`: layers of colours,
/// wave packets and extra bytes, which have the defects of version 3 (layered_chunk.h).
template <class Model, bool attached = false, class Coder, class Bytes, class Start, class Code>
bool code_layer(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps, Start&& start,
                Code&& code) {
  std::array<std::unique_ptr<Model>, 4> models;
  unsigned channel = steps[0].channel;
  models[channel] = std::make_unique<Model>();
  start(*models[channel], r.first, nullptr);
  const bool defective = attached && !r.fixed_channels;
  for (std::size_t i = 1; i < r.count; ++i) {
    Model* last = models[channel].get();
    const unsigned next = !defective || steps[i].channel_changed ? steps[i].channel : 0;
    if (next != channel) {
      channel = next;
      const bool is_new = !models[channel];
      if (is_new) {
        models[channel] = std::make_unique<Model>();
        start(*models[channel], r.at(i - 1), last);
      }
      if (is_new || !defective) last = models[channel].get();
    }
    code(*models[channel], *last, r.at(i), steps[i]);
    if (i % 1024 == 0 && is_damaged(coder)) return false;
  }
  return !is_damaged(coder);
}

/// First layer: channels, changes of other attributes, returns, x and y. Sets the steps of all points.
template <class Coder, class Bytes>
bool code_returns_and_xy(Coder& coder, const LayerRecords<Bytes>& r, std::vector<PointStep>& steps);

template <class Coder, class Bytes>
bool code_z(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  struct Model {
    IntegerModel<32, 20> z;
    std::array<std::int32_t, 8> last;
  };
  const auto start = [](Model& m, const char* previous, const Model*) {
    m.last.fill(load<std::int32_t>(previous + 8));
  };
  return code_layer<Model>(coder, r, steps, start, [&](Model& m, Model&, Bytes* p, const PointStep& step) {
    std::int32_t& z = m.last[step.level];
    z = m.z.code(coder, z, given<Coder, std::int32_t>(p + 8), step.z_context);
    give<Coder>(p + 8, z);
  });
}

/// Layers of one byte, whose models depend on the previous value.
struct ByteModels {
  std::array<SymbolModel<256>, 64> models;
  std::uint8_t last;
};

template <class Coder, class Bytes>
bool code_classification(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  const auto start = [](ByteModels& m, const char* previous, const ByteModels*) {
    m.last = load<std::uint8_t>(previous + 16);
  };
  return code_layer<ByteModels>(coder, r, steps, start, [&](ByteModels& m, ByteModels&, Bytes* p, PointStep step) {
    const unsigned context = (m.last & 31u) << 1 | (step.end == 3);
    m.last = static_cast<std::uint8_t>(coder.symbol(m.models[context], given<Coder, std::uint8_t>(p + 16)));
    give<Coder>(p + 16, m.last);
  });
}

template <class Coder, class Bytes>
bool code_user_data(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  const auto start = [](ByteModels& m, const char* previous, const ByteModels*) {
    m.last = load<std::uint8_t>(previous + 17);
  };
  return code_layer<ByteModels>(coder, r, steps, start, [&](ByteModels& m, ByteModels&, Bytes* p, PointStep) {
    m.last = static_cast<std::uint8_t>(coder.symbol(m.models[m.last / 4], given<Coder, std::uint8_t>(p + 17)));
    give<Coder>(p + 17, m.last);
  });
}

/// Classification flags, scan direction and edge of flight line; the byte also has the channel.
template <class Coder, class Bytes>
bool code_flags(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  struct Model {
    std::array<SymbolModel<64>, 64> models;
    unsigned last;
  };
  const auto flags = [](unsigned byte) { return (byte & 15u) | byte >> 6 << 4; };
  const auto start = [&](Model& m, const char* previous, const Model*) {
    m.last = flags(load<std::uint8_t>(previous + 15));
  };
  return code_layer<Model>(coder, r, steps, start, [&](Model& m, Model&, Bytes* p, const PointStep& step) {
    m.last = coder.symbol(m.models[m.last], flags(given<Coder, std::uint8_t>(p + 15)));
    give<Coder>(p + 15, static_cast<std::uint8_t>((m.last & 15u) | step.channel << 4 | m.last >> 4 << 6));
  });
}

template <class Coder, class Bytes>
bool code_intensity(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  struct Model {
    IntegerModel<16, 4> intensity;
    std::array<std::uint16_t, 8> last;
  };
  const auto start = [](Model& m, const char* previous, const Model*) {
    m.last.fill(load<std::uint16_t>(previous + 12));
  };
  return code_layer<Model>(coder, r, steps, start, [&](Model& m, Model&, Bytes* p, const PointStep& step) {
    std::uint16_t& v = m.last[static_cast<unsigned>(step.end) << 1 | step.time_changed];
    v = static_cast<std::uint16_t>(m.intensity.code(coder, v, given<Coder, std::uint16_t>(p + 12), step.end));
    give<Coder>(p + 12, v);
  });
}

template <class Coder, class Bytes>
bool code_angle(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  struct Model {
    IntegerModel<16, 2> angle;
    std::int16_t last;
  };
  const auto start = [](Model& m, const char* previous, const Model*) { m.last = load<std::int16_t>(previous + 18); };
  return code_layer<Model>(coder, r, steps, start, [&](Model& m, Model&, Bytes* p, const PointStep& step) {
    if (step.angle_changed)
      m.last =
          static_cast<std::int16_t>(m.angle.code(coder, m.last, given<Coder, std::int16_t>(p + 18), step.time_changed));
    give<Coder>(p + 18, m.last);
  });
}

template <class Coder, class Bytes>
bool code_source(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  struct Model {
    IntegerModel<16> source;
    std::uint16_t last;
  };
  const auto start = [](Model& m, const char* previous, const Model*) { m.last = load<std::uint16_t>(previous + 20); };
  return code_layer<Model>(coder, r, steps, start, [&](Model& m, Model&, Bytes* p, const PointStep& step) {
    if (step.source_changed)
      m.last = static_cast<std::uint16_t>(m.source.code(coder, m.last, given<Coder, std::uint16_t>(p + 20)));
    give<Coder>(p + 20, m.last);
  });
}

template <class Coder, class Bytes>
bool code_time(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps) {
  struct Model {
    TimeModel<true> time;
    std::int64_t last;
  };
  const auto start = [](Model& m, const char* previous, const Model*) {
    m.last = load<std::int64_t>(previous + 22);
    m.time.start(m.last);
  };
  return code_layer<Model>(coder, r, steps, start, [&](Model& m, Model&, Bytes* p, const PointStep& step) {
    if (step.time_changed) {
      m.last = Coder::kEncodes ? load<std::int64_t>(p + 22) : m.last;
      m.time.code(coder, m.last);
    }
    give<Coder>(p + 22, m.last);
  });
}

template <class Coder, class Bytes>
bool code_rgb(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps, std::size_t offset) {
  struct Model {
    RgbModel rgb;
    Rgb last;
  };
  const auto start = [offset](Model& m, const char* previous, const Model* from) {
    m.last = from ? from->last : load<Rgb>(previous + offset);
  };
  return code_layer<Model, true>(coder, r, steps, start, [&](Model& m, Model& last, Bytes* p, const PointStep&) {
    Rgb rgb = given<Coder, Rgb>(p + offset);
    m.rgb.code(coder, last.last, rgb);
    last.last = rgb;
    give<Coder>(p + offset, rgb);
  });
}

template <class Coder, class Bytes>
bool code_infrared(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps,
                   std::size_t offset) {
  struct Model {
    SymbolModel<4> changed;
    std::array<SymbolModel<256>, 2> differences;
    std::uint16_t last;
  };
  const auto start = [offset](Model& m, const char* previous, const Model* from) {
    m.last = from ? from->last : load<std::uint16_t>(previous + offset);
  };
  return code_layer<Model, true>(coder, r, steps, start, [&](Model& m, Model& last, Bytes* p, const PointStep&) {
    const auto v = given<Coder, std::uint16_t>(p + offset);
    const unsigned d = v ^ last.last;
    const unsigned changed = coder.symbol(m.changed, ((d & 255u) != 0) | (d >> 8 != 0) << 1);
    std::array<std::uint8_t, 2> now;
    for (unsigned half = 0; half < 2; ++half) {
      now[half] = byte_of(last.last, half);
      if (changed >> half & 1)
        now[half] = low_byte(
            now[half] + static_cast<int>(coder.symbol(m.differences[half], low_byte(byte_of(v, half) - now[half]))));
    }
    last.last = static_cast<std::uint16_t>(now[1] << 8 | now[0]);
    give<Coder>(p + offset, last.last);
  });
}

template <class Coder, class Bytes>
bool code_wave(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps, std::size_t offset) {
  struct Model {
    WaveModel wave;
    std::array<char, WaveModel::kBytes> last;
  };
  const auto start = [offset](Model& m, const char* previous, const Model* from) {
    std::memcpy(m.last.data(), from ? from->last.data() : previous + offset, WaveModel::kBytes);
  };
  return code_layer<Model, true>(coder, r, steps, start, [&](Model& m, Model& last, Bytes* p, const PointStep&) {
    m.wave.code(coder, last.last.data(), p + offset);
    std::memcpy(last.last.data(), p + offset, WaveModel::kBytes);
  });
}

/// An extra byte.
template <class Coder, class Bytes>
bool code_byte(Coder& coder, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps, std::size_t offset) {
  struct Model {
    SymbolModel<256> difference;
    std::uint8_t last;
  };
  const auto start = [offset](Model& m, const char* previous, const Model* from) {
    m.last = from ? from->last : load<std::uint8_t>(previous + offset);
  };
  return code_layer<Model, true>(coder, r, steps, start, [&](Model& m, Model& last, Bytes* p, const PointStep&) {
    const int d = given<Coder, std::uint8_t>(p + offset) - last.last;
    last.last = low_byte(last.last + static_cast<int>(coder.symbol(m.difference, low_byte(d))));
    give<Coder>(p + offset, last.last);
  });
}

/// Calls visit(field, code) for all layers after those of the positions, with code(coder) -> bool.
template <class Bytes, class Visit>
void for_other_layers(const LazLayout& l, const LayerRecords<Bytes>& r, const std::vector<PointStep>& steps,
                      Visit&& visit) {
  using F = LayerField;
  visit(F{16, 1}, [&](auto& coder) { return code_classification(coder, r, steps); });
  visit(F{15, 1, 0xcf}, [&](auto& coder) { return code_flags(coder, r, steps); });
  visit(F{12, 2}, [&](auto& coder) { return code_intensity(coder, r, steps); });
  visit(F{18, 2}, [&](auto& coder) { return code_angle(coder, r, steps); });
  visit(F{17, 1}, [&](auto& coder) { return code_user_data(coder, r, steps); });
  visit(F{20, 2}, [&](auto& coder) { return code_source(coder, r, steps); });
  visit(F{22, 8}, [&](auto& coder) { return code_time(coder, r, steps); });
  if (l.rgb) visit(F{l.rgb, 6}, [&](auto& coder) { return code_rgb(coder, r, steps, l.rgb); });
  if (l.infrared) visit(F{l.infrared, 2}, [&](auto& coder) { return code_infrared(coder, r, steps, l.infrared); });
  if (l.wave) visit(F{l.wave, WaveModel::kBytes}, [&](auto& coder) { return code_wave(coder, r, steps, l.wave); });
  for (std::size_t k = l.extra; k < l.extra + l.extra_bytes; ++k)
    visit(F{k, 1}, [&, k](auto& coder) { return code_byte(coder, r, steps, k); });
}

/// Models of the first layer and the last point of a channel.
struct ReturnsAndXyModel {
  std::array<SymbolModel<128>, 8> changed;
  SymbolModel<3> channel;
  std::array<SymbolModel<16>, 16> counts, numbers;
  SymbolModel<13> number_at_same_time;
  IntegerModel<32, 2> dx;
  IntegerModel<32, 22> dy;
  std::array<RunningMedian, 12> x_steps, y_steps;
  std::size_t last;  ///< index of the last point
  std::int32_t x, y;
  unsigned number, count;  ///< returns
  bool time_changed;

  void start(const char* record, std::size_t i) {
    last = i;
    x = load<std::int32_t>(record), y = load<std::int32_t>(record + 4);
    number = load<std::uint8_t>(record + 14) & 15u, count = load<std::uint8_t>(record + 14) >> 4;
    time_changed = false;
  }

  unsigned context() const { return (number == 1) | (number >= count) << 1 | time_changed << 2; }

  /// Which attributes differ from the last point.
  unsigned changes(const char* record, const char* previous) const {
    const auto differs = [&](std::size_t offset, std::size_t bytes) {
      return static_cast<unsigned>(std::memcmp(record + offset, previous + offset, bytes) != 0);
    };
    const unsigned returns = load<std::uint8_t>(record + 14), step = ((returns & 15u) - number) & 15u;
    return differs(20, 2) << 5 | differs(22, 8) << 4 | differs(18, 2) << 3 | (returns >> 4 != count) << 2 |
           (step == 0    ? 0u
            : step == 1  ? 1u
            : step == 15 ? 2u
                         : 3u);
  }

  /// Returns that differ by more than 1.
  template <class Coder>
  unsigned code_number(Coder& coder, unsigned wanted) {
    if (time_changed) return coder.symbol(numbers[number], wanted);
    return (number + coder.symbol(number_at_same_time, (wanted - number - 2) & 15u) + 2) & 15u;
  }

  template <class Coder>
  void code_xy(Coder& coder, std::int32_t to_x, std::int32_t to_y, PointStep& step) {
    const auto code_step = [&](auto& model, RunningMedian& median, std::int32_t& v, std::int32_t to, unsigned context) {
      const auto from = static_cast<std::uint32_t>(v);
      const auto wanted = static_cast<std::int32_t>(static_cast<std::uint32_t>(to) - from);
      const std::int32_t d = model.code(coder, median.value(), wanted, context);
      median.add(d);
      v = static_cast<std::int32_t>(from + static_cast<std::uint32_t>(d));
    };
    const unsigned of_return = kWideReturnContext[count][number] * 2u | time_changed, single = count == 1;
    code_step(dx, x_steps[of_return], x, to_x, single);
    const unsigned bits = dx.bits();
    code_step(dy, y_steps[of_return], y, to_y, single + (bits < 20 ? bits & ~1u : 20));
    const unsigned both = (bits + dy.bits()) / 2;
    step.level = static_cast<std::uint8_t>(return_level(count, number));
    step.z_context = static_cast<std::uint8_t>(single + (both < 18 ? both & ~1u : 18));
    step.end = static_cast<std::uint8_t>((number >= count) | (number == 1) << 1) & 3u;
  }
};

template <class Coder, class Bytes>
bool code_returns_and_xy(Coder& coder, const LayerRecords<Bytes>& r, std::vector<PointStep>& steps) {
  using Model = ReturnsAndXyModel;
  std::array<std::unique_ptr<Model>, 4> models;
  const auto channel_of = [](const char* p) { return load<std::uint8_t>(p + 15) >> 4 & 3u; };
  unsigned channel = channel_of(r.first);
  models[channel] = std::make_unique<Model>();
  models[channel]->start(r.first, 0);
  steps[0].channel = static_cast<std::uint8_t>(channel);
  for (std::size_t i = 1; i < r.count; ++i) {
    Bytes* const p = r.at(i);
    Model* m = models[channel].get();
    unsigned changed = 0, to = channel;
    if constexpr (Coder::kEncodes) {
      to = channel_of(p);
      const Model& of = models[to] ? *models[to] : *m;
      changed = (to != channel) << 6 | of.changes(p, r.at(of.last));
    }
    changed = coder.symbol(m->changed[m->context()], changed);
    if (changed & 64) {
      channel = (channel + coder.symbol(m->channel, (to - channel - 1) & 3u) + 1) & 3u;
      if (!models[channel]) {
        models[channel] = std::make_unique<Model>();
        models[channel]->start(r.at(i - 1), i - 1);
      }
      m = models[channel].get();
    }
    const unsigned returns = given<Coder, std::uint8_t>(p + 14);
    m->time_changed = (changed & 16) != 0;
    if (changed & 4) m->count = coder.symbol(m->counts[m->count], returns >> 4);
    if ((changed & 3) == 3) m->number = m->code_number(coder, returns & 15u);
    if ((changed & 3) == 1) m->number = (m->number + 1) & 15u;
    if ((changed & 3) == 2) m->number = (m->number + 15) & 15u;
    PointStep& step = steps[i];
    step.channel = static_cast<std::uint8_t>(channel);
    step.channel_changed = changed >> 6 & 1u, step.time_changed = changed >> 4 & 1u,
    step.angle_changed = changed >> 3 & 1u, step.source_changed = changed >> 5 & 1u;
    m->code_xy(coder, given<Coder, std::int32_t>(p), given<Coder, std::int32_t>(p + 4), step);
    m->last = i;
    give<Coder>(p, m->x), give<Coder>(p + 4, m->y);
    give<Coder>(p + 14, static_cast<std::uint8_t>(m->number | m->count << 4));
    give<Coder>(p + 15, static_cast<std::uint8_t>(channel << 4));
    if (i % 1024 == 0 && is_damaged(coder)) return false;
  }
  return !is_damaged(coder);
}

}  // namespace sansmesh::inline v1::io::laz
