#include "sansmesh/io/reference_text.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "sansmesh/core/option_text.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/output_destination.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kLongestPrj = std::size_t{1} << 20;
constexpr std::string_view kUnknown = "unknown";

std::string name_beside(const std::string& file) {
  std::filesystem::path path(file);
  if (lower_case(path.extension().string()) == ".gz") path.replace_extension();
  return path.replace_extension(".prj").string();
}

std::string short_name(const std::string& name) {
  return printable(std::filesystem::path(name).filename().string(), 200);
}

/// System of a file .prj that exists; null if its text is none.
SharedSystem read_prj(const std::string& name) {
  std::ifstream stream(name, std::ios::binary);
  std::string text(kLongestPrj, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return system_of_text(without_byte_order_mark(text));
}

bool has_records(const FormatInfo& format) {
  return format.system_capacity == SystemCapacity::records || format.system_capacity == SystemCapacity::records_of_text;
}

/// Whether programs that read such a file know WKT only. Its ending has two parts, of which the last is another
/// format's.
bool needs_text(const std::string& file) {
  const std::string name = lower_case(file);
  const std::vector<const FormatInfo*> all = formats();
  return std::any_of(all.begin(), all.end(), [&](const FormatInfo* f) {
    return f->system_capacity == SystemCapacity::records_of_text && name.ends_with("." + std::string(f->endings));
  });
}

/// Whether the system is in the file or in a file .prj beside it.
bool keeps_system(const FormatInfo& format, const ReferenceSystem& system) {
  if (!wkt_of(system).empty()) return true;
  if (has_records(format) && !system.geo_keys.empty()) return true;
  return format.system_capacity != SystemCapacity::beside && system.code != 0;
}

}  // namespace

SharedSystem system_of_line(std::string_view line) {
  return line == kUnknown ? std::make_shared<const ReferenceSystem>() : system_of_text(line);
}

bool states_unknown(const ReferenceSystem& s) {
  return s.wkt.empty() && s.geo_keys.empty() && s.code == 0 && s.vertical_code == 0 && s.name.empty() &&
         s.unit.empty() && s.vertical_unit.empty();
}

std::string system_line(const ReferenceSystem* system) {
  if (!system) return {};
  if (states_unknown(*system)) return std::string(kUnknown);
  std::string line = wkt_of(*system);
  if (line.empty() && system->code != 0) {
    line = "EPSG:" + std::to_string(system->code);
    if (system->vertical_code != 0) line += "+" + std::to_string(system->vertical_code);
  }
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return line;
}

SharedSystem system_of_ply(std::string_view bytes) {
  TextScanner header(bytes);
  if (header.line() != "ply") return nullptr;
  for (int lines = 0; !header.at_end() && lines < 10000; ++lines) {
    const std::string_view line = header.line();
    if (line.starts_with("end_header")) break;
    if (line.starts_with(kSystemComment)) return system_of_line(line.substr(kSystemComment.size()));
  }
  return nullptr;
}

bool has_system_beside(const std::string& file) {
  std::error_code none;
  return std::filesystem::is_regular_file(name_beside(file), none);
}

SharedSystem system_beside(const Input& in) {
  if (!has_system_beside(in.file)) return nullptr;
  const std::string name = name_beside(in.file);
  SharedSystem system = read_prj(name);
  if (!system) in.warn("the file " + short_name(name) + " beside it is no WKT of a reference system: ignored");
  return system;
}

void write_system_beside(const std::string& file, const ReferenceSystem* system) {
  const std::string text = system ? wkt_of(*system) : std::string();
  if (text.empty() || has_system_beside(file) || find_output_destination(file).stream) return;
  write_whole(name_beside(file), {text, "\n"});
}

std::string system_remark(const std::string& file, const ReferenceSystem* system) {
  const FormatInfo* const format = format_of_name(file);
  if (!format) return {};
  if (system && !keeps_system(*format, *system))
    return "cannot hold the reference system (" + system_words(*system) + "), of which no WKT is known: left out; " +
           (system->code != 0 ? "LAS, LAZ, PLY and GLB hold it" : "LAS and LAZ hold it");
  if (system && needs_text(file) && !states_unknown(*system) && wkt_of(*system).empty())
    return "holds the reference system (" + system_words(*system) +
           ") without WKT, which is not known: programs that read octrees may take it for unknown";
  if (format->system_capacity == SystemCapacity::text || !has_system_beside(file)) return {};
  if (has_records(*format) && system) return {};
  const std::string name = name_beside(file);
  const SharedSystem other = read_prj(name);
  if (!other && !system) return {};
  if (!system)
    return "the file " + short_name(name) + " beside it states a reference system (" + system_words(*other) +
           "), which counts for this file, too: rename one of them if it is of other data";
  if (other && may_be_equal(other.get(), system)) return {};
  return "the file " + short_name(name) + " beside it " +
         (other ? "states another reference system (" + system_words(*other) + ")" : "is no WKT") +
         " and was kept: rename one of them";
}

}  // namespace sansmesh::inline v1::io
