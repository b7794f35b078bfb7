#include "sansmesh/io/meshes/ply_header.h"

#include <fmt/core.h>

#include "sansmesh/core/option_text.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

NumberType parse_type(const Input& in, std::string_view word) {
  const std::string w = lower_case(word);
  if (w == "char" || w == "int8") return NumberType::i8;
  if (w == "uchar" || w == "uint8") return NumberType::u8;
  if (w == "short" || w == "int16") return NumberType::i16;
  if (w == "ushort" || w == "uint16") return NumberType::u16;
  if (w == "int" || w == "int32") return NumberType::i32;
  if (w == "uint" || w == "uint32") return NumberType::u32;
  if (w == "int64" || w == "longlong") return NumberType::i64;
  if (w == "uint64" || w == "ulonglong") return NumberType::u64;
  if (w == "float" || w == "float32") return NumberType::f32;
  if (w == "double" || w == "float64") return NumberType::f64;
  in.fail(fmt::format("malformed PLY header: unknown property type '{}'", word.substr(0, 40)));
}

}  // namespace

PlyHeader parse_ply_header(const Input& in) {
  PlyHeader header;
  TextScanner text(in.bytes);
  if (text.line() != "ply") in.fail("is not a PLY file (does not begin with 'ply')");
  bool have_format = false;
  for (;;) {
    if (text.at_end()) in.fail("truncated: the PLY header has no 'end_header'");
    const std::string_view line = text.line();
    if (line.size() > 4096) in.fail("malformed PLY header: a line of more than 4,096 characters");
    TextScanner words(line);
    const std::string_view key = words.word();
    if (key == "end_header") break;
    if (key.empty() || key == "comment" || key == "obj_info") continue;
    if (key == "format") {
      const std::string_view w = words.word();
      have_format = true;
      if (w == "ascii")
        header.encoding = PlyEncoding::ascii;
      else if (w == "binary_little_endian")
        header.encoding = PlyEncoding::little;
      else if (w == "binary_big_endian")
        header.encoding = PlyEncoding::big;
      else
        in.fail(fmt::format("malformed PLY header: unknown format '{}'", w.substr(0, 40)));
    } else if (key == "element") {
      PlyElement element;
      element.name = lower_case(words.word());
      if (element.name.empty() || !words.number(element.count)) {
        in.fail(fmt::format("malformed PLY header: '{}'", line.substr(0, 80)));
      }
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) in.fail("malformed PLY header: a property before any element");
      PlyProperty property;
      std::string_view type = words.word();
      if (type == "list") {
        property.is_list = true;
        property.count_type = parse_type(in, words.word());
        if (is_real(property.count_type)) in.fail("malformed PLY header: a list's length must be an integer");
        type = words.word();
      }
      property.type = parse_type(in, type);
      property.given = std::string(words.word());
      property.name = lower_case(property.given);
      if (property.name.empty()) in.fail(fmt::format("malformed PLY header: '{}'", line.substr(0, 80)));
      header.elements.back().properties.push_back(std::move(property));
    } else {
      in.fail(fmt::format("malformed PLY header: unknown keyword '{}'", key.substr(0, 40)));
    }
  }
  if (!have_format) in.fail("malformed PLY header: no 'format' line");
  header.body = text.rest();
  return header;
}

}  // namespace sansmesh::inline v1::io
