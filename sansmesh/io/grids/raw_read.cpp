// Numbers without a header, in a layout given by the user or by the file's name.
#include <fmt/core.h>

#include <filesystem>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/grids/image_block.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

std::optional<NumberType> raw_type(std::string_view word) {
  constexpr std::pair<std::string_view, NumberType> names[] = {
      {"uint8", NumberType::u8},    {"int8", NumberType::i8},    {"uint16", NumberType::u16},
      {"int16", NumberType::i16},   {"uint32", NumberType::u32}, {"int32", NumberType::i32},
      {"uint64", NumberType::u64},  {"int64", NumberType::i64},  {"float32", NumberType::f32},
      {"float64", NumberType::f64}, {"float", NumberType::f32},  {"double", NumberType::f64},
      {"u8", NumberType::u8},       {"u16", NumberType::u16},    {"f32", NumberType::f32},
      {"uchar", NumberType::u8},    {"ushort", NumberType::u16}, {"short", NumberType::i16}};
  for (const auto& [name, type] : names) {
    if (word == name) return type;
  }
  return std::nullopt;
}

}  // namespace

std::optional<RawLayout> raw_layout_of_name(const std::string& file) {
  std::string name = lower_case(std::filesystem::path(file).filename().string());
  RawLayout layout;
  bool sized = false, typed = false;
  std::string word;
  name += '.';
  for (const char c : name) {
    if (c != '_' && c != '.' && c != '-' && c != ' ') {
      word += c;
      continue;
    }
    std::array<std::size_t, 3> dims{};
    TextScanner s(word);
    bool whole = true;
    for (std::size_t k = 0; k < 3 && whole; ++k) {
      whole = s.number(dims[k]) && dims[k] > 0;
      if (k < 2 && whole) {
        whole = s.rest().starts_with('x');
        if (whole) s = TextScanner(s.rest().substr(1));
      }
    }
    if (whole && s.at_end()) layout.dims = dims, sized = true;
    if (const auto type = raw_type(word)) layout.type = *type, typed = true;
    word.clear();
  }
  if (!sized || !typed) return std::nullopt;
  return layout;
}

GridData read_raw(const Input& in, const RawLayout& layout) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (layout.dims[k] < 1) throw ArgumentError("`dims` must be at least 1 along each axis");
    if (!(layout.spacing[k] > 0) || !std::isfinite(layout.spacing[k]))
      throw ArgumentError("`spacing` must be greater than 0");
  }
  if (layout.components < 1) throw ArgumentError("`raw_components` must be at least 1");
  const std::uint64_t count = checked_product(in, {layout.dims[0], layout.dims[1], layout.dims[2], layout.components});
  const std::uint64_t needed = count * size_of(layout.type);
  const auto size = [&] {
    return fmt::format("{} x {} x {} numbers of the type {}", layout.dims[0], layout.dims[1], layout.dims[2],
                       name_of(layout.type));
  };
  if (in.bytes.size() < layout.header_bytes || in.bytes.size() - layout.header_bytes < needed) {
    in.fail(fmt::format("truncated, or not of that layout: {}{} take {} bytes, it has {}", size(),
                        layout.header_bytes > 0 ? fmt::format(" and a header of {} bytes", layout.header_bytes) : "",
                        grouped(needed + layout.header_bytes), grouped(in.bytes.size())));
  }
  const std::uint64_t more = in.bytes.size() - layout.header_bytes - needed;
  if (more > 0) {
    in.fail(fmt::format("not of that layout: {} take {} bytes, it has {} more (`header_bytes`?)", size(),
                        grouped(needed), grouped(more)));
  }
  ImageLayout image;
  image.dims = layout.dims;
  for (std::size_t k = 0; k < 3; ++k) image.steps[k] = image.steps[k] * layout.spacing[k];
  GridData data;
  data.format = fmt::format("raw, {}", name_of(layout.type));
  data.blocks.push_back(image_block(in, image));
  data.blocks[0].point_arrays.set(
      {"value", decode_values(in.bytes.data() + layout.header_bytes, count, layout.type, layout.big_endian),
       layout.components});
  return data;
}

}  // namespace sansmesh::inline v1::io
