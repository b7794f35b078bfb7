#include "sansmesh/io/laz/layered_chunk.h"

#include <memory>
#include <vector>

#include "sansmesh/io/binary.h"
#include "sansmesh/io/laz/channel_layers.h"

namespace sansmesh::inline v1::io::laz {
namespace {

/// Layers in the order of the file; colours and others follow as far as the format has them.
constexpr std::size_t kPointLayers = 9;

std::size_t layer_count(const LazLayout& l) {
  return kPointLayers + (l.rgb != 0) + (l.infrared != 0) + (l.wave != 0) + l.extra_bytes;
}

}  // namespace

void encode_layered(const LazLayout& l, const char* records, std::size_t count, std::string& out) {
  std::vector<std::string> layers;
  layers.reserve(layer_count(l));
  const LayerRecords<const char> r{records, l.record, count, l.fixed_channels};
  std::vector<PointStep> steps(count);
  const auto add = [&](auto&& code) {
    ArithmeticEncoder encoder;
    code(encoder);
    layers.push_back(encoder.finish());
  };
  add([&](auto& coder) { code_returns_and_xy(coder, r, steps); });
  add([&](auto& coder) { code_z(coder, r, steps); });
  for_other_layers(l, r, steps, [&](const LayerField& field, auto&& code) {
    if (is_constant(r, field))
      layers.emplace_back();
    else
      add(code);
  });
  out.append(records, l.record);
  const auto put = [&out](std::size_t v) {
    const auto number = static_cast<std::uint32_t>(v);
    out.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  put(count);
  for (const std::string& layer : layers) put(layer.size());
  for (const std::string& layer : layers) out += layer;
}

struct LayeredChunk::Steps {
  std::vector<std::string_view> layers;
  std::vector<PointStep> of_point;
};

LayeredChunk::LayeredChunk(const LazLayout& layout, std::string_view bytes, std::size_t count, char* records)
    : layout_(layout), bytes_(bytes), count_(count), records_(records), steps_(std::make_unique<Steps>()) {
  const std::size_t layers = layer_count(layout);
  std::size_t at = layout.record + 4 + 4 * layers;
  if (bytes.size() < at) return;
  std::memcpy(records, bytes.data(), layout.record);
  for (std::size_t k = 0; k < layers; ++k) {
    const std::size_t length = load<std::uint32_t>(bytes.data() + layout.record + 4 + 4 * k);
    if (length > bytes.size() - at) return;
    steps_->layers.push_back(bytes.substr(at, length));
    at += length;
  }
  length_ = at;
}

LayeredChunk::~LayeredChunk() = default;

bool LayeredChunk::decode_positions() {
  if (length_ == 0) return false;
  const LayerRecords<char> r{records_, layout_.record, count_, layout_.fixed_channels};
  std::vector<PointStep>& steps = steps_->of_point;
  steps.resize(count_);
  if (count_ == 1) return true;
  ArithmeticDecoder first(steps_->layers[0]);
  if (!code_returns_and_xy(first, r, steps)) return false;
  if (steps_->layers[1].empty()) {
    repeat_first(r, {8, 4});
    return true;
  }
  ArithmeticDecoder second(steps_->layers[1]);
  return code_z(second, r, steps);
}

bool LayeredChunk::decode_rest() {
  if (count_ == 1) return true;
  const LayerRecords<char> r{records_, layout_.record, count_, layout_.fixed_channels};
  bool sound = true;
  std::size_t layer = 2;
  for_other_layers(layout_, r, steps_->of_point, [&](const LayerField& field, auto&& code) {
    const std::string_view bytes = steps_->layers[layer++];
    if (bytes.empty()) return repeat_first(r, field);
    ArithmeticDecoder decoder(bytes);
    if (sound) sound = code(decoder);
  });
  return sound;
}

}  // namespace sansmesh::inline v1::io::laz
