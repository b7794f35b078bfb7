// NRRD (teem.sourceforge.net/nrrd/format.html): lines "field: value" up to an empty one, then the numbers, or the names
// of their files.
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

std::optional<NumberType> nrrd_type(std::string_view name) {
  constexpr std::pair<std::string_view, NumberType> names[] = {
      {"signed char", NumberType::i8},
      {"int8", NumberType::i8},
      {"int8_t", NumberType::i8},
      {"uchar", NumberType::u8},
      {"unsigned char", NumberType::u8},
      {"uint8", NumberType::u8},
      {"uint8_t", NumberType::u8},
      {"short", NumberType::i16},
      {"short int", NumberType::i16},
      {"signed short", NumberType::i16},
      {"signed short int", NumberType::i16},
      {"int16", NumberType::i16},
      {"int16_t", NumberType::i16},
      {"ushort", NumberType::u16},
      {"unsigned short", NumberType::u16},
      {"unsigned short int", NumberType::u16},
      {"uint16", NumberType::u16},
      {"uint16_t", NumberType::u16},
      {"int", NumberType::i32},
      {"signed int", NumberType::i32},
      {"int32", NumberType::i32},
      {"int32_t", NumberType::i32},
      {"uint", NumberType::u32},
      {"unsigned int", NumberType::u32},
      {"uint32", NumberType::u32},
      {"uint32_t", NumberType::u32},
      {"longlong", NumberType::i64},
      {"long long", NumberType::i64},
      {"long long int", NumberType::i64},
      {"signed long long", NumberType::i64},
      {"signed long long int", NumberType::i64},
      {"int64", NumberType::i64},
      {"int64_t", NumberType::i64},
      {"ulonglong", NumberType::u64},
      {"unsigned long long", NumberType::u64},
      {"unsigned long long int", NumberType::u64},
      {"uint64", NumberType::u64},
      {"uint64_t", NumberType::u64},
      {"float", NumberType::f32},
      {"double", NumberType::f64},
  };
  for (const auto& [n, type] : names) {
    if (name == n) return type;
  }
  return std::nullopt;
}

struct NrrdHeader {
  HeaderFields fields;
  std::vector<std::string> files;  ///< empty: the numbers follow
  std::string_view body;
};

NrrdHeader read_nrrd_header(const Input& in) {
  NrrdHeader header{HeaderFields(in), {}, {}};
  TextScanner text(in.bytes);
  text.line();  // the magic number
  bool list = false, ended = false;
  while (!text.at_end()) {
    const std::string_view line = text.line();
    if (list) {
      if (const std::string_view name = without_blanks(line); !name.empty()) header.files.push_back(beside(in, name));
      continue;
    }
    if (line.empty()) {
      ended = true;
      break;
    }
    if (line.starts_with('#')) continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      in.fail(fmt::format("its header has a line that is not 'field: value': {}", line.substr(0, 40)));
    if (line.substr(colon).starts_with(":=")) continue;  // user-defined keys and values
    const std::string name = lower_case(without_blanks(line.substr(0, colon)));
    const std::string_view value = without_blanks(line.substr(colon + 1));
    if (name == "data file" || name == "datafile") {
      if (value.starts_with("LIST"))
        list = true;
      else if (value.find('%') != std::string_view::npos)
        header.files = files_of_pattern(in, std::string(value));
      else
        header.files = {beside(in, value)};
    } else {
      header.fields.set(name, value);
    }
  }
  if (list && header.files.empty()) in.fail("announces a list of data files, but has none");
  if (header.files.empty() && !ended) in.fail("truncated: its header does not end");
  header.body = text.rest();
  return header;
}

/// Meaning of the file's axes.
struct NrrdAxes {
  std::vector<std::size_t> sizes;
  std::vector<std::size_t> space;  ///< at most three axes of the file
  std::optional<std::size_t> components, time;
};

bool is_component_kind(const std::string& kind) {
  for (const char* k : {"vector", "color", "normal", "gradient", "matrix", "complex", "quaternion", "point", "none"}) {
    if (kind.find(k) != std::string::npos && kind != "???") return true;
  }
  return false;
}

NrrdAxes nrrd_axes(const Input& in, const HeaderFields& fields, const std::vector<std::optional<Vec3>>& directions) {
  const auto n = fields.whole({"dimension"});
  if (!n || *n < 1 || *n > 5) in.fail("its header gives no number of axes (dimension) of 1 to 5");
  const auto sizes = fields.numbers({"sizes"}, static_cast<std::size_t>(*n));
  if (!sizes) in.fail("its header gives no sizes");
  NrrdAxes axes;
  for (const double s : *sizes) {
    if (!(s >= 1) || s > 0x1p40 || s != std::floor(s)) in.fail("its header gives an impossible size");
    axes.sizes.push_back(static_cast<std::size_t>(s));
  }
  std::vector<std::string> kinds(axes.sizes.size());
  if (const std::string* const text = fields.find({"kinds"})) {
    TextScanner s(*text);
    for (std::string& k : kinds) k = lower_case(s.word());
  }
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < axes.sizes.size(); ++k) {
    const bool spatial = directions.empty() ? !is_component_kind(kinds[k]) && kinds[k] != "list" && kinds[k] != "time"
                                            : directions[k].has_value();
    if (spatial)
      axes.space.push_back(k);
    else
      others.push_back(k);
  }
  // If the header does not describe more than three axes, the first one is components if it is short, else the last one
  // is time.
  while (axes.space.size() > 3) {
    const bool first = axes.sizes[axes.space.front()] <= 9 && others.empty();
    others.push_back(first ? axes.space.front() : axes.space.back());
    axes.space.erase(first ? axes.space.begin() : axes.space.end() - 1);
    std::sort(others.begin(), others.end());
  }
  for (const std::size_t k : others) {
    const bool time =
        kinds[k] == "time" || kinds[k] == "list" || (kinds[k].empty() && k > 0 && k + 1 == axes.sizes.size());
    std::optional<std::size_t>& axis = time ? axes.time : axes.components;
    if (axis) in.fail("its header has several axes of components or of time, which is not supported");
    axis = k;
  }
  if (axes.space.empty()) in.fail("its header has no axes in space");
  return axes;
}

/// "(1,0,0) none (0,1,0) (0,0,1)": directions of axes with their spacing.
std::vector<std::optional<Vec3>> nrrd_vectors(const Input& in, const std::string& text) {
  std::vector<std::optional<Vec3>> vectors;
  TextScanner s(text);
  for (s.skip_space(); !s.at_end(); s.skip_space()) {
    if (s.rest().starts_with("none")) {
      vectors.push_back(std::nullopt);
      s = TextScanner(s.rest().substr(4));
      continue;
    }
    if (!s.rest().starts_with('(')) in.fail(fmt::format("its header gives vectors as '{}'", text.substr(0, 60)));
    s = TextScanner(s.rest().substr(1));
    Vec3 v;
    for (std::size_t c = 0;; ++c) {
      double number = 0;
      const bool nan = s.rest().starts_with("nan");
      if (c >= 3 || (!s.number(number) && !nan))
        in.fail(fmt::format("its header gives vectors as '{}'", text.substr(0, 60)));
      v[c] = number;
      s.skip_blanks();
      const char next = s.at_end() ? ' ' : s.rest().front();
      if (next != ',' && next != ')') in.fail(fmt::format("its header gives vectors as '{}'", text.substr(0, 60)));
      s = TextScanner(s.rest().substr(1));
      if (next == ')') break;
    }
    vectors.push_back(v);
  }
  return vectors;
}

ImageLayout nrrd_layout(const Input& in, const HeaderFields& fields, const NrrdAxes& axes,
                        const std::vector<std::optional<Vec3>>& directions) {
  ImageLayout layout;
  const std::size_t n = axes.sizes.size();
  std::vector<double> spacings(n, 1.0), minima(n, 0.0);
  const auto per_axis = [&](std::string_view name, std::vector<double>& values) {
    const std::string* const text = fields.find({name});
    if (!text) return;
    TextScanner s(*text);
    for (double& v : values) {
      const std::string_view word = s.word();
      TextScanner number(word);
      double found = 0;
      if (number.number(found) && number.at_end() && std::isfinite(found))
        v = found;
      else if (lower_case(word) != "nan" && lower_case(word) != "none")
        in.fail(fmt::format("'{}' of its header must be a number for each axis", name));
    }
  };
  per_axis("spacings", spacings);
  per_axis("axis mins", minima);
  per_axis("axismins", minima);
  for (std::size_t k = 0; k < 3; ++k) {
    if (k >= axes.space.size()) {
      layout.steps[k] = {};
      continue;
    }
    const std::size_t axis = axes.space[k];
    layout.dims[k] = axes.sizes[axis];
    if (directions.empty()) {
      Vec3 step;
      step[k] = spacings[axis];
      layout.steps[k] = step;
      layout.origin[k] = minima[axis];
    } else {
      layout.steps[k] = *directions[axis];
    }
  }
  if (const std::string* const origin = fields.find({"space origin"})) {
    const auto v = nrrd_vectors(in, *origin);
    if (v.size() != 1) in.fail("its header gives no single space origin");
    if (v[0]) layout.origin = *v[0];
  }
  return layout;
}

std::string nrrd_unhex(const Input& in, std::string_view text) {
  std::string bytes;
  int high = -1;
  for (const char c : text) {
    if (TextScanner::is_blank(c) || c == '\n') continue;
    const int v = c >= '0' && c <= '9'   ? c - '0'
                  : c >= 'a' && c <= 'f' ? c - 'a' + 10
                  : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                         : -1;
    if (v < 0) in.fail("its hexadecimal numbers contain other characters");
    if (high < 0) {
      high = v;
    } else {
      bytes += static_cast<char>(high * 16 + v);
      high = -1;
    }
  }
  return bytes;
}

/// The numbers of the file, in its order of axes.
AttributeValues nrrd_values(const Input& in, const NrrdHeader& header, NumberType type, std::uint64_t count) {
  const HeaderFields& fields = header.fields;
  const std::uint64_t needed = count * size_of(type);
  const std::string* const encoding_text = fields.find({"encoding"});
  const std::string encoding = encoding_text ? lower_case(*encoding_text) : "raw";
  const std::int64_t skip = fields.whole({"byte skip", "byteskip"}).value_or(0);
  const std::int64_t lines = fields.whole({"line skip", "lineskip"}).value_or(0);
  if (skip < -1 || lines < 0) in.fail("its header skips a negative number of bytes or lines");
  const bool gzip = encoding == "gzip" || encoding == "gz";
  std::optional<DataFiles> files;
  std::string_view bytes = header.body;
  // Lines are skipped before bytes; several files are joined only as a whole.
  const bool several = header.files.size() > 1;
  if (!header.files.empty()) {
    if (several && (lines > 0 || encoding != "raw"))
      in.fail("several data files are supported only if they are raw and without lines to skip");
    files.emplace(in, header.files, several ? skip : 0, needed);
    bytes = files->bytes();
  }
  const std::string& data_name = files ? files->name() : in.file;
  const Input data{data_name, bytes, in.report};
  for (std::int64_t k = 0; k < lines; ++k) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) data.fail("truncated: is shorter than the lines to skip");
    bytes.remove_prefix(end + 1);
  }
  const auto skip_bytes = [&] {
    if (several) return;
    const std::uint64_t n = skip >= 0               ? static_cast<std::uint64_t>(skip)
                            : bytes.size() > needed ? bytes.size() - needed
                                                    : 0;
    if (n > bytes.size()) data.fail("truncated: is shorter than the bytes to skip");
    bytes.remove_prefix(n);
  };
  if (encoding == "txt" || encoding == "text" || encoding == "ascii") {
    skip_bytes();
    return parse_values(data, bytes, count, type);
  }
  std::vector<char> unpacked;
  std::string unhexed;
  if (gzip && bytes.starts_with("\x1f\x8b")) {  // detached data files are decompressed when opened
    unpacked = unpack_values({data_name, bytes, in.report}, needed, needed + (std::uint64_t{1} << 20));
    bytes = {unpacked.data(), unpacked.size()};
  } else if (gzip && header.files.empty()) {
    data.fail("its numbers are not compressed as its header says, or truncated");
  } else if (encoding == "hex") {
    unhexed = nrrd_unhex(data, bytes);
    bytes = unhexed;
  } else if (!gzip && encoding != "raw") {
    in.fail(fmt::format("numbers in the encoding '{}' are not supported", encoding.substr(0, 40)));
  }
  skip_bytes();
  if (bytes.size() < needed) data.fail_short(needed, bytes.size());
  if (bytes.size() > needed)
    in.warn(fmt::format("{} bytes after the numbers are ignored", grouped(bytes.size() - needed)));
  const std::string* const endian = fields.find({"endian"});
  if (!endian && size_of(type) > 1 && encoding != "hex") in.fail("its header gives no byte order (endian)");
  // NOLINTNEXTLINE(bugprone-suspicious-stringview-data-usage): bytes for `count` numbers are there
  return decode_values(bytes.data(), count, type, endian && lower_case(*endian) == "big");
}

std::size_t product_before(const NrrdAxes& axes, std::size_t axis) {
  std::size_t s = 1;
  for (std::size_t k = 0; k < axis; ++k) s *= axes.sizes[k];
  return s;
}

/// One of `steps` along the axis of time: axes after an axis are blocks of it.
AttributeValues nrrd_step(const AttributeValues& values, const NrrdAxes& axes, std::size_t step, std::size_t steps,
                          std::size_t count) {
  const std::size_t inner = product_before(axes, *axes.time), outer = count / (inner * steps);
  return std::visit(
      [&](const auto& from) {
        std::decay_t<decltype(from)> to;
        to.reserve(inner * outer);
        for (std::size_t o = 0; o < outer; ++o) {
          const auto begin = from.begin() + static_cast<std::ptrdiff_t>((o * steps + step) * inner);
          to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(inner));
        }
        return AttributeValues(std::move(to));
      },
      values);
}

/// Moves the components first: `inner` points precede their axis in `count` numbers.
AttributeValues components_first(const AttributeValues& values, std::size_t components, std::size_t inner,
                                 std::size_t count) {
  const std::size_t blocks = count / (inner * components);
  return std::visit(
      [&](const auto& from) {
        auto to = from;
        for (std::size_t b = 0; b < blocks; ++b) {
          for (std::size_t c = 0; c < components; ++c) {
            for (std::size_t i = 0; i < inner; ++i)
              to[(b * inner + i) * components + c] = from[(b * components + c) * inner + i];
          }
        }
        return AttributeValues(std::move(to));
      },
      values);
}

}  // namespace

GridData read_nrrd(const Input& in, std::size_t step) {
  const NrrdHeader header = read_nrrd_header(in);
  const HeaderFields& fields = header.fields;
  const std::string* const type_name = fields.find({"type"});
  if (!type_name) in.fail("its header gives no type of numbers");
  const auto type = nrrd_type(lower_case(*type_name));
  if (!type) in.fail(fmt::format("numbers of the type '{}' are not supported", type_name->substr(0, 40)));
  std::vector<std::optional<Vec3>> directions;
  if (const std::string* const text = fields.find({"space directions"})) directions = nrrd_vectors(in, *text);
  const auto n = fields.whole({"dimension"});
  if (!directions.empty() && (!n || static_cast<std::int64_t>(directions.size()) != *n))
    in.fail("its header must give one space direction for each axis");
  const NrrdAxes axes = nrrd_axes(in, fields, directions);
  std::uint64_t count = 1;
  for (const std::size_t s : axes.sizes) count = checked_product(in, {count, s});
  checked_product(in, {count, 8});
  const std::size_t steps = axes.time ? axes.sizes[*axes.time] : 1;
  check_time_step(in.file, step, steps);

  AttributeValues values = nrrd_values(in, header, *type, count);
  if (axes.time) values = nrrd_step(values, axes, step, steps, count);
  const std::size_t components = axes.components ? axes.sizes[*axes.components] : 1;
  if (axes.components) {
    std::size_t inner = product_before(axes, *axes.components);
    if (inner > 1 && axes.time && *axes.time < *axes.components) inner /= steps;
    if (inner > 1) values = components_first(values, components, inner, count / steps);
  }
  GridData result;
  result.format = "NRRD";
  result.blocks.push_back(image_block(in, nrrd_layout(in, fields, axes, directions)));
  result.blocks[0].point_arrays.set({"value", std::move(values), components});
  return result;
}

}  // namespace sansmesh::inline v1::io
