// Chooses the reader of a file: by its first bytes if these are unique, else by its ending.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/points/cloud_files.h"
#include "sansmesh/io/points/merge_points.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/reference_text.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1 {
namespace {

using io::Input;

/// Relative difference of horizontal and vertical units that distorts shapes. The two feet differ by 2e-6.
constexpr double kDistortion = 1e-4;

std::string known_endings() {
  std::string known;
  for (const std::string& ending : endings_read(kPoints)) known += ending.substr(1) + " ";
  return known + "(and each with .gz)";
}

/// VTK's polydata hold points and meshes; for its other XML files the reader reports the error.
const FormatInfo* format_of_points(std::string_view bytes) {
  const FormatInfo* const found = format_of_content(bytes);
  return found && found->id == FormatId::vtk_xml ? format_of_name("a.vtp") : found;
}

[[noreturn]] void fail_reading(const Input& in, const FormatInfo& format) {
  if (!format.remedy.empty()) in.fail(std::string(format.remedy));
  in.fail(fmt::format("holds a volume ({}), not points or a mesh", format.name));
}

/// Coordinates are used as they are: units that differ distort shapes.
void warn_of_units(const Input& in, const ReferenceSystem& system) {
  if (system.unit == "degree")
    in.warn("its coordinates are angles in degrees: distances and shapes are wrong until they are projected");
  else if (system.metres > 0 && system.vertical_metres > 0 &&
           std::abs(system.metres / system.vertical_metres - 1) > kDistortion)
    in.warn(
        fmt::format("its heights are in another unit ({}) than its horizontal coordinates ({}): shapes are distorted",
                    system.vertical_unit, system.unit));
}

/// Removes the points that are not in the box.
void keep_box(PointSet& points, const Box3& box) {
  std::vector<std::uint8_t> outside(points.size());
  parallel_for(0, points.size(), 1 << 15,
               [&](std::size_t i) { outside[i] = !box.contains(points.origin + Vec3(points.positions[i])); });
  remove_samples(points, outside);
}

/// Empty if the options select no point.
PointSet read_any(const std::string& file, ReadReport& report, const std::optional<Vec3>& origin,
                  double smallest_extent, const ReadOptions& options = {}) {
  const io::FileContent content(file);
  const Input in{file, content.bytes(), report, origin, smallest_extent, options};
  const std::string name = io::ending(file);
  const FormatInfo* by_name = format_of_name(file, kPoints);
  if (!by_name) by_name = format_of_name(file);
  const FormatInfo* const by_content = format_of_points(in.bytes);
  const FormatInfo* const format = by_content ? by_content : by_name;
  if (!format) {
    in.fail(name.empty() ? "has no ending and is none of PLY, PCD, LAS, OFF, VTP; known endings: " + known_endings()
                         : "unknown ending '." + name.substr(0, 20) + "'; known: " + known_endings());
  }
  if (!format->read_points) fail_reading(in, *format);
  if (format->id == FormatId::table && in.bytes.substr(0, 4096).find('\0') != std::string_view::npos &&
      io::is_plot3d(in))
    fail_reading(in, *format_of_name("grid.p3d", kVolume));
  if (by_content && by_name && by_content != by_name) {
    in.warn(fmt::format("its ending is '.{}', but its content is of another format and was read as that", name));
  }
  PointSet points = format->read_points(in);
  if (!format->selects) in.warn_without_levels();
  if (points.reference && io::states_unknown(*points.reference))
    points.reference = nullptr;
  else if (!points.reference && points.size() > 0)
    points.reference = io::system_beside(in);
  report.reference = points.reference;
  if (points.reference) warn_of_units(in, *points.reference);
  if (options.box && !format->selects) keep_box(points, *options.box);
  return points;
}

void check_options(const ReadOptions& options) {
  if (options.box && options.box->empty()) throw ArgumentError("the box of points to read is empty");
  if (options.resolution && !(*options.resolution > 0))
    throw ArgumentError("the resolution of points to read must be greater than 0");
}

bool is_selective(const ReadOptions& options) { return options.box || options.resolution; }

[[noreturn]] void fail_unselected(const std::string& file, const ReadOptions& options) {
  std::string cause = "holds no points";
  if (options.box)
    cause += " in the box from " + point_words(options.box->lower, 9) + " to " + point_words(options.box->upper, 9);
  if (options.resolution) cause += " at the requested resolution";
  throw FileError(file, cause);
}

}  // namespace

bool is_read(const std::string& file) { return format_of_name(file, kPoints) != nullptr; }

PointSet read_points(const std::string& file, ReadReport* report, const ReadOptions& options) {
  check_options(options);
  ReadReport own;
  ReadReport& r = report ? *report : own;
  r = {};
  PointSet points = read_any(file, r, {}, kSmallestExtent, options);
  if (points.size() == 0 && is_selective(options)) fail_unselected(file, options);
  return points;
}

PointSet io::read_points_of_volume(const std::string& file, ReadReport& report) {
  report = {};
  return read_any(file, report, {}, kSmallestOfVolume);
}

PolylineSet read_lines(const std::string& file, ReadReport* report) {
  ReadReport own;
  ReadReport& r = report ? *report : own;
  r = {};
  const io::FileContent content(file);
  const Input in{file, content.bytes(), r, {}};
  const std::string ending = io::ending(file);
  if (ending == "dxf") return io::read_dxf_lines(in);
  const FormatInfo* const format = format_of_content(in.bytes);
  if (format && format->id == FormatId::vtk_xml) return io::read_vtp_lines(in);
  return ending == "obj" ? io::read_obj_lines(in) : PolylineSet{};
}

namespace {

/// Clouds of several files about one origin, without those of which the options select no point.
struct PartsOfFiles {
  std::vector<PointSet> parts;
  std::vector<std::string> files;
  ReadReport report;
};

PartsOfFiles read_parts(const std::vector<std::string>& files, std::optional<Vec3> origin, const ReadOptions& options) {
  PartsOfFiles read;
  std::string formats;
  for (const std::string& file : files) {
    ReadReport of_file;
    PointSet part = read_any(file, of_file, origin, kSmallestExtent, options);
    if (part.size() == 0 && is_selective(options)) continue;
    if (!origin) origin = part.origin;
    read.parts.push_back(std::move(part)), read.files.push_back(file);
    const PointSet &first = read.parts[0], &last = read.parts.back();
    if (last.triangles.empty() != first.triangles.empty()) {
      const bool mesh = first.triangles.empty();
      throw FileError(file, (mesh ? "holds faces and " : "holds no faces, but ") + printable(read.files[0], 200) +
                                (mesh ? " none" : " does") + ": points and meshes cannot be read as one");
    }
    ReadReport& all = read.report;
    for (const std::string& w : of_file.warnings) all.warnings.push_back(printable(file, 200) + ": " + w);
    for (const std::string& what : of_file.unread)
      if (std::find(all.unread.begin(), all.unread.end(), what) == all.unread.end()) all.unread.push_back(what);
    if (formats.find(of_file.format) == std::string::npos) formats += (formats.empty() ? "" : ", ") + of_file.format;
  }
  if (read.parts.empty()) fail_unselected(files[0] + " and the other files", options);
  read.report.format = fmt::format("{} files, {}", read.files.size(), formats);
  return read;
}

}  // namespace

PointSet read_merged(const std::vector<std::string>& names, ReadReport* report, const ReadOptions& options) {
  if (names.empty()) throw ArgumentError("read_merged: no files");
  const std::vector<std::string> files = io::list_cloud_files(names);
  if (files.size() == 1) return read_points(files[0], report, options);
  check_options(options);
  PartsOfFiles read = read_parts(files, io::stated_origin(files, options.box), options);
  // The origin of the whole cloud is known only now, unless the files' headers state their boxes.
  if (const Vec3 origin = io::common_origin(read.parts); origin != read.parts[0].origin) {
    read = {};
    read = read_parts(files, origin, options);
  }
  ReadReport own;
  ReadReport& all = report ? *report : own;
  all = std::move(read.report);
  PointSet merged = io::merge_points(read.files, std::move(read.parts), all);
  all.reference = merged.reference;
  return merged;
}

TriangleMesh read_mesh(const std::string& file, ReadReport* report) {
  PointSet points = read_points(file, report);
  if (points.triangles.empty()) throw FileError(file, "holds points but no faces; a mesh is needed");
  return to_mesh(std::move(points));
}

}  // namespace sansmesh::inline v1
