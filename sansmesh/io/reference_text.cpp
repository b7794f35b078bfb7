#include "sansmesh/io/reference_text.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/output_destination.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kLongestPrj = std::size_t{1} << 20;

std::string name_beside(const std::string& file) {
  std::filesystem::path path(file);
  if (lower(path.extension().string()) == ".gz") path.replace_extension();
  return path.replace_extension(".prj").string();
}

}  // namespace

std::string system_line(const ReferenceSystem* system) {
  if (!system) return {};
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
    if (line.starts_with(kSystemComment)) return system_of_text(line.substr(kSystemComment.size()));
  }
  return nullptr;
}

SharedSystem system_beside(const Input& in) {
  const std::string name = name_beside(in.file);
  std::error_code none;
  if (!std::filesystem::is_regular_file(name, none)) return nullptr;
  std::ifstream stream(name, std::ios::binary);
  std::string text(kLongestPrj, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  SharedSystem system = system_of_text(without_byte_order_mark(text));
  if (!system)
    in.warn("the file " + std::filesystem::path(name).filename().string() +
            " beside it is no WKT of a reference system: ignored");
  return system;
}

void write_system_beside(const std::string& file, const ReferenceSystem* system) {
  const std::string text = system ? wkt_of(*system) : std::string();
  if (text.empty() || find_output_destination(file).stream) return;
  write_whole(name_beside(file), {text, "\n"});
}

}  // namespace sansmesh::inline v1::io
