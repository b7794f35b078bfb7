#include "sansmesh/io/formats.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/names.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

bool has_ending(const FormatInfo& format, std::string_view ending) {
  const auto endings = words_of(format.endings);
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

void add_ending(std::string_view ending, std::vector<std::string>& list) {
  std::string with_dot = "." + std::string(ending);
  if (std::find(list.begin(), list.end(), with_dot) == list.end()) list.push_back(std::move(with_dot));
}

/// The same among the library's own formats.
std::optional<FormatId> own_format_of_content(std::string_view bytes) {
  const auto begins = [&](std::string_view s) { return bytes.starts_with(s); };
  if (begins("ply\n") || begins("ply\r")) return FormatId::ply;
  if (begins("LASF")) return bytes.size() > 104 && (bytes[104] & 0x80) != 0 ? FormatId::laz : FormatId::las;
  if (begins("ASTM-E57")) return FormatId::e57;
  if (begins("glTF")) return FormatId::glb;
  if (begins("# .PCD") || begins("VERSION 0.7\n") || begins("VERSION .7\n")) return FormatId::pcd;
  if (begins("OFF\n") || begins("OFF\r") || begins("OFF ") || begins("COFF") || begins("NOFF")) return FormatId::off;
  if (bytes.substr(0, 4096).find("<VTKFile") != std::string_view::npos) return FormatId::vtk_xml;
  if (begins("# vtk DataFile")) return FormatId::vtk_legacy;
  if (begins("NRRD000")) return FormatId::nrrd;
  if (begins("ObjectType") || begins("NDims")) return FormatId::metaimage;
  if (bytes.size() > 132 && bytes.substr(128, 4) == "DICM") return FormatId::dicom;
  if (begins("\x89HDF\r\n\x1a\n") || begins("CDF\x01") || begins("CDF\x02") || begins("CDF\x05"))
    return FormatId::exodus;
  if (begins("#std ")) return FormatId::nek_field;
  if (begins("$MeshFormat")) return FormatId::gmsh;
  if (bytes.substr(0, 64).find("ADF Database") != std::string_view::npos) return FormatId::cgns;
  return std::nullopt;
}

}  // namespace

Registry<FormatInfo>& FormatInfo::registry() {
  static Registry<FormatInfo> all("format", own_formats());
  return all;
}

std::vector<const FormatInfo*> formats() { return FormatInfo::registry().all(); }

namespace {

const FormatInfo* own_format(FormatId id) { return formats()[static_cast<std::size_t>(id)]; }

}  // namespace

const FormatInfo* format_of_name(const std::string& file, unsigned content) {
  const std::string ending = io::ending(file);
  if (ending.empty()) return nullptr;
  for (const FormatInfo* const f : formats())
    if (has_ending(*f, ending) && (content == 0 || (f->reads & content) != 0)) return f;
  if ((content == 0 || (content & kVolume) != 0) && io::is_nek_field_name(ending))
    return own_format(FormatId::nek_field);
  return nullptr;
}

const FormatInfo* format_of_content(std::string_view bytes) {
  if (const auto own = own_format_of_content(bytes)) return own_format(*own);
  for (const FormatInfo* const f : formats())
    if (f->recognizes && f->recognizes(bytes)) return f;
  return nullptr;
}

std::vector<std::string> endings_read(unsigned content) {
  std::vector<std::string> list;
  for (const FormatInfo* const f : formats())
    if ((f->reads & content) != 0)
      for (const std::string_view ending : words_of(f->endings)) add_ending(ending, list);
  return list;
}

std::vector<std::string> endings_written(unsigned content) {
  std::vector<std::string> list;
  for (const FormatInfo* const f : formats())
    for (const WrittenAs& as : f->written)
      if ((as.content & content) != 0) add_ending(as.ending, list);
  return list;
}

std::string listed_endings(const std::vector<std::string>& endings) {
  std::string text;
  for (const std::string& ending : endings) text += (text.empty() ? "" : " ") + ending;
  return text;
}

}  // namespace sansmesh::inline v1
