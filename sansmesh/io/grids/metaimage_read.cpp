// MetaImage: lines "Name = value"; the last one locates the numbers.
#include <fmt/core.h>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/grids/header_fields.h"
#include "sansmesh/io/grids/image_block.h"
#include "sansmesh/io/grids/time_steps.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

/// `longs`: whether types called long have 8 bytes, which differs between writers.
std::optional<NumberType> met_type(std::string name, bool longs) {
  name = lower_case(name);
  if (name.ends_with("_array")) name.resize(name.size() - 6);
  if (name == "met_char" || name == "met_ascii_char") return NumberType::i8;
  if (name == "met_uchar") return NumberType::u8;
  if (name == "met_short") return NumberType::i16;
  if (name == "met_ushort") return NumberType::u16;
  if (name == "met_int") return NumberType::i32;
  if (name == "met_uint") return NumberType::u32;
  if (name == "met_long") return longs ? NumberType::i64 : NumberType::i32;
  if (name == "met_ulong") return longs ? NumberType::u64 : NumberType::u32;
  if (name == "met_long_long") return NumberType::i64;
  if (name == "met_ulong_long") return NumberType::u64;
  if (name == "met_float") return NumberType::f32;
  if (name == "met_double") return NumberType::f64;
  return std::nullopt;
}

struct MetaHeader {
  HeaderFields fields;
  std::string data_file;
  std::string_view body;  ///< bytes after the header
};

MetaHeader read_meta_header(const Input& in) {
  MetaHeader header{HeaderFields(in), {}, {}};
  TextScanner text(in.bytes);
  while (!text.at_end()) {
    const std::string_view line = text.line();
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      if (without_blanks(line).empty()) continue;
      in.fail(fmt::format("its header has a line that is not 'Name = value': {}", line.substr(0, 40)));
    }
    const std::string_view name = without_blanks(line.substr(0, equals)),
                           value = without_blanks(line.substr(equals + 1));
    if (lower_case(name) == "elementdatafile") {
      if (value.empty()) break;
      header.data_file = value;
      header.body = text.rest();
      return header;
    }
    header.fields.set(name, value);
  }
  in.fail("truncated or not a MetaImage: its header does not locate the numbers (ElementDataFile)");
}

ImageLayout meta_layout(const HeaderFields& fields, std::size_t n, const std::vector<double>& sizes) {
  ImageLayout layout;
  for (std::size_t k = 0; k < std::min<std::size_t>(n, 3); ++k) layout.dims[k] = static_cast<std::size_t>(sizes[k]);
  const auto spacing = fields.numbers({"elementspacing", "elementsize"}, n);
  const auto origin = fields.numbers({"offset", "position", "origin"}, n);
  const auto turn = fields.numbers({"transformmatrix", "rotation", "orientation"}, n * n);
  const std::size_t axes = std::min<std::size_t>(n, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    if (k >= axes) {
      layout.steps[k] = {};  // perpendicular to the others
      continue;
    }
    const double length = spacing ? (*spacing)[k] : 1.0;
    Vec3 direction;
    if (turn) {
      for (std::size_t c = 0; c < axes; ++c) direction[c] = (*turn)[k * n + c];
    } else {
      direction[k] = 1;
    }
    layout.steps[k] = direction * length;
    if (origin) layout.origin[k] = (*origin)[k];
  }
  return layout;
}

std::vector<std::string> meta_files(const Input& in, const MetaHeader& header) {
  std::vector<std::string> files;
  if (lower_case(header.data_file).starts_with("list")) {
    TextScanner text(header.body);
    while (!text.at_end()) {
      if (const std::string_view name = without_blanks(text.line()); !name.empty()) files.push_back(beside(in, name));
    }
    if (files.empty()) in.fail("announces a list of data files, but has none");
    return files;
  }
  if (header.data_file.find('%') != std::string::npos) return files_of_pattern(in, header.data_file);
  return {beside(in, header.data_file)};
}

}  // namespace

GridData read_metaimage(const Input& in, std::size_t step) {
  const MetaHeader header = read_meta_header(in);
  const HeaderFields& fields = header.fields;
  const auto n = fields.whole({"ndims"});
  if (!n || *n < 1 || *n > 4) in.fail("its header gives no number of axes (NDims) of 1 to 4");
  const std::size_t axes = static_cast<std::size_t>(*n);
  const auto sizes = fields.numbers({"dimsize"}, axes);
  if (!sizes) in.fail("its header gives no size (DimSize)");
  std::uint64_t points = 1;
  for (const double s : *sizes) {
    if (!(s >= 1) || s > 0x1p40 || s != std::floor(s)) in.fail("its header gives an impossible size (DimSize)");
    points = checked_product(in, {points, static_cast<std::uint64_t>(s)});
  }
  const std::uint64_t steps = axes == 4 ? static_cast<std::uint64_t>((*sizes)[3]) : 1;
  check_time_step(in.file, step, steps);
  const auto channels = fields.whole({"elementnumberofchannels"}).value_or(1);
  if (channels < 1 || channels > 1024) in.fail("its header gives an impossible number of channels");
  const std::string* const type_name = fields.find({"elementtype"});
  if (!type_name) in.fail("its header gives no type of numbers (ElementType)");
  std::optional<NumberType> type = met_type(*type_name, false);
  if (!type) in.fail(fmt::format("numbers of the type '{}' are not supported", type_name->substr(0, 40)));
  const std::uint64_t count = checked_product(in, {points, static_cast<std::uint64_t>(channels)});
  const bool text = fields.find({"binarydata"}) && !fields.flag({"binarydata"});
  const bool big = fields.flag({"elementbyteordermsb", "binarydatabyteordermsb"});
  const bool packed = fields.flag({"compresseddata"});
  const std::int64_t skip = fields.whole({"headersize"}).value_or(0);
  checked_product(in, {count, 8});

  std::optional<DataFiles> files;
  std::string_view bytes = header.body;
  const bool local = lower_case(header.data_file) == "local";
  if (!local) {
    files.emplace(in, meta_files(in, header), packed ? std::max<std::int64_t>(skip, 0) : skip, count * size_of(*type));
    bytes = files->bytes();
  }
  const std::string& data_name = files ? files->name() : in.file;
  const Input data{data_name, bytes, in.report};
  std::vector<char> unpacked;
  if (packed) {
    // One more byte would show that there is more data than the header announces.
    unpacked = unpack_values(data, count * size_of(*type), count * 8 + 1);
    bytes = {unpacked.data(), unpacked.size()};
  }
  if (bytes.size() == count * 8) type = met_type(*type_name, true);

  AttributeValues values;
  const std::size_t of_step = count / steps;
  if (text) {
    AttributeValues all = parse_values(data, bytes, count, *type);
    if (steps == 1) {
      values = std::move(all);
    } else {
      values = std::visit(
          [&](const auto& v) {
            const auto begin = v.begin() + static_cast<std::ptrdiff_t>(step * of_step);
            return AttributeValues(std::decay_t<decltype(v)>(begin, begin + static_cast<std::ptrdiff_t>(of_step)));
          },
          all);
    }
  } else {
    const std::uint64_t needed = count * size_of(*type);
    if (bytes.size() < needed) data.fail_short(needed, bytes.size());
    if (bytes.size() > needed)
      in.warn(fmt::format("{} bytes after the numbers are ignored", grouped(bytes.size() - needed)));
    values = decode_values(bytes.data() + step * of_step * size_of(*type), of_step, *type, big);
  }
  GridData result;
  result.blocks.push_back(image_block(in, meta_layout(fields, axes, *sizes)));
  result.blocks[0].point_arrays.set({"value", std::move(values), static_cast<std::size_t>(channels)});
  result.format = "MetaImage";
  return result;
}

}  // namespace sansmesh::inline v1::io
