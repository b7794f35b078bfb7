// Chooses the reader for a file: by its first bytes where they say what it is, else by its ending.
#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/merge_points.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh {
namespace {

using io::Input;

struct Format {
  const char* endings;             ///< separated and surrounded by spaces
  PointSet (*read)(const Input&);  ///< null: known, but not supported
  const char* remedy = "";
};

constexpr Format formats[] = {
    {" ply ", io::read_ply},
    {" obj ", io::read_obj},
    {" off coff noff cnoff ", io::read_off},
    {" stl ", io::read_stl},
    {" xyz txt csv asc pts pwn xyzn npts xyzrgb tsv dat ", io::read_table},
    {" pcd ", io::read_pcd},
    {" las ", io::read_las},
    {" vtp ", io::read_vtp},
    {" conf ", io::read_conf},
    {" laz ", nullptr, "LAZ (compressed LAS) is not supported; decompress it to LAS first"},
    {" e57 ", nullptr, "E57 is not supported; convert it to PLY, LAS or XYZ first"},
    {" smf ", nullptr, "is a function, not points or a mesh; `sansmesh mesh` makes a mesh of it"},
    {" glb gltf fbx dae 3ds 3mf usd usdz ", nullptr,
     "reading this format is not supported; convert it to PLY or OBJ first"},
    {" vtk vtu vti vts vtr ", nullptr, "this kind of VTK file is not supported; convert it to VTP or PLY first"},
    {" pcap rcp rcs ptx zip 7z xz bz2 zst rar ", nullptr,
     "this kind of file is not supported; convert or unpack it first (gzip is unpacked on the fly)"},
};

/// What the first bytes say, where they are unmistakable; null otherwise.
const Format* format_of_content(std::string_view bytes) {
  const auto named = [](const char* ending) {
    for (const Format& f : formats) {
      if (std::string_view(f.endings).find(ending) != std::string_view::npos) return &f;
    }
    return static_cast<const Format*>(nullptr);
  };
  const auto begins = [&](std::string_view s) { return bytes.starts_with(s); };
  if (begins("ply\n") || begins("ply\r")) return named(" ply ");
  if (begins("LASF")) return named(" las ");
  if (begins("ASTM-E57")) return named(" e57 ");
  if (begins("glTF")) return named(" glb ");
  if (begins("# .PCD") || begins("VERSION 0.7\n") || begins("VERSION .7\n")) return named(" pcd ");
  if (begins("OFF\n") || begins("OFF\r") || begins("OFF ") || begins("COFF") || begins("NOFF")) return named(" off ");
  if (bytes.substr(0, 4096).find("<VTKFile") != std::string_view::npos) return named(" vtp ");
  if (begins("# vtk DataFile")) return named(" vtk ");
  return nullptr;
}

std::string known_endings() {
  std::string known;
  for (const Format& f : formats) {
    if (f.read) known += std::string(f.endings).substr(0, std::strlen(f.endings) - 1);
  }
  return known.substr(1) + " (and each with .gz)";
}

const Format* format_of_name(const std::string& file) {
  const std::string name = io::ending(file);
  const Format* by_name = nullptr;
  for (const Format& f : formats) {
    if (!name.empty() && std::string_view(f.endings).find(" " + name + " ") != std::string_view::npos) by_name = &f;
  }
  return by_name;
}

PointSet read_any(const std::string& file, ReadReport& report, const std::optional<Vec3>& origin,
                  double smallest_extent) {
  const io::FileContent content(file);
  const Input in{file, content.bytes(), report, origin, smallest_extent};
  const std::string name = io::ending(file);
  const Format* const by_name = format_of_name(file);
  const Format* const by_content = format_of_content(in.bytes);
  const Format* const format = by_content ? by_content : by_name;
  if (!format) {
    in.fail(name.empty() ? "has no ending and is none of PLY, PCD, LAS, OFF, VTP; known endings: " + known_endings()
                         : "unknown ending '." + name.substr(0, 20) + "'; known: " + known_endings());
  }
  if (!format->read) in.fail(format->remedy);
  if (by_content && by_name && by_content != by_name) {
    in.warn(fmt::format("its ending is '.{}', but its content is of another format and was read as that", name));
  }
  return format->read(in);
}

}  // namespace

bool is_read(const std::string& file) {
  const Format* const format = format_of_name(file);
  return format && format->read;
}

PointSet read_points(const std::string& file, ReadReport* report) {
  ReadReport own;
  ReadReport& r = report ? *report : own;
  r = {};
  return read_any(file, r, {}, kSmallestExtent);
}

PointSet io::read_points_of_volume(const std::string& file, ReadReport& report) {
  report = {};
  return read_any(file, report, {}, kSmallestOfVolume);
}

PolylineSet read_lines(const std::string& file) {
  ReadReport report;
  const io::FileContent content(file);
  const Input in{file, content.bytes(), report, {}};
  const bool vtk = in.bytes.substr(0, 4096).find("<VTKFile") != std::string_view::npos;
  return vtk ? io::read_vtp_lines(in) : PolylineSet{};
}

PointSet read_merged(const std::vector<std::string>& files, ReadReport* report) {
  if (files.empty()) throw ArgumentError("read_merged: no files");
  if (files.size() == 1) return read_points(files[0], report);
  ReadReport own;
  ReadReport& all = report ? *report : own;
  all = {};
  std::vector<PointSet> parts;
  std::string formats;
  for (const std::string& file : files) {
    ReadReport of_file;
    std::optional<Vec3> origin;
    if (!parts.empty()) origin = parts[0].origin;
    parts.push_back(read_any(file, of_file, origin, kSmallestExtent));
    if (parts.back().triangles.empty() != parts[0].triangles.empty()) {
      const bool mesh = parts[0].triangles.empty();
      throw FileError(file, (mesh ? "holds faces and " : "holds no faces, but ") + printable(files[0], 200) +
                                (mesh ? " none" : " does") + ": points and meshes cannot be read as one");
    }
    for (const std::string& w : of_file.warnings) all.warnings.push_back(printable(file, 200) + ": " + w);
    for (const std::string& what : of_file.unread)
      if (std::find(all.unread.begin(), all.unread.end(), what) == all.unread.end()) all.unread.push_back(what);
    if (formats.find(of_file.format) == std::string::npos) formats += (formats.empty() ? "" : ", ") + of_file.format;
  }
  all.format = fmt::format("{} files, {}", files.size(), formats);
  return io::merge_points(files, std::move(parts), all);
}

TriangleMesh read_mesh(const std::string& file, ReadReport* report) {
  PointSet points = read_points(file, report);
  if (points.triangles.empty()) throw FileError(file, "holds points but no faces; a mesh is needed");
  return to_mesh(std::move(points));
}

}  // namespace sansmesh
