// Chooses the writer of a file by its ending.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <span>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/output_destination.h"
#include "sansmesh/io/reference_text.h"

namespace sansmesh::inline v1 {
namespace {

/// Data that a format with that room cannot hold.
std::vector<std::string> lost_data(FormatCapacity room, const io::OutputContent& content) {
  std::vector<std::string> names;
  if (room == FormatCapacity::all) return names;
  if ((room == FormatCapacity::positions || room == FormatCapacity::all_but_normals) && !content.normals.empty())
    names.emplace_back("normals");
  if (room == FormatCapacity::positions && !content.colors.empty()) names.emplace_back("colours");
  if (room == FormatCapacity::all_but_normals) return names;
  for (const Attribute& a : content.attributes)
    if (room != FormatCapacity::colors_and_few_floats || a.type() != NumberType::f32 || a.components > 4)
      names.push_back(printable(a.name, 80));
  for (const Attribute& a : content.triangle_attributes) names.push_back(printable(a.name, 80) + " of triangles");
  return names;
}

/// Whether a file .prj of other data would count, unless the file states that its system is unknown.
bool must_state_unknown(const FormatInfo& format, const std::string& file, const ReferenceSystem* system) {
  return format.system_capacity == SystemCapacity::text && io::system_line(system).empty() &&
         io::has_system_beside(file);
}

/// Throws FileError: the ending is not a known one.
[[noreturn]] void fail_ending(const std::string& file, const std::string& kind, const std::string& known) {
  const std::string e = io::ending(file);
  throw FileError(file, e.empty() ? fmt::format("has no ending that names a format for {}; known: {}", kind, known)
                                  : fmt::format("no writer for {} with the ending '.{}'; known: {}", kind, e, known));
}

/// The format with a writer of that kind for a file name. Throws FileError.
const FormatInfo& find_writer(FormatContent content, const std::string& file, const std::string& kind) {
  std::string name = "." + lower_case(std::filesystem::path(file).filename().string());
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  // Endings may have several parts: .copc.laz is another format than .laz.
  const FormatInfo* found = nullptr;
  std::size_t longest = 0;
  for (const FormatInfo* const f : formats())
    for (const WrittenAs& as : f->written)
      if ((as.content & content) != 0 && as.ending.size() > longest && name.ends_with("." + std::string(as.ending)))
        found = f, longest = as.ending.size();
  if (found) return *found;
  fail_ending(file, kind, listed_endings(endings_written(content)));
}

/// Throws ArgumentError unless an optional per-vertex array is empty or complete.
void check_length(const char* what, std::size_t length, std::size_t n) {
  if (length != 0 && length != n) {
    throw ArgumentError(fmt::format("{} {} for {} points: either none or one per point is required", length, what, n));
  }
}

/// Throws FileError for coordinates beyond the limit of readers.
void check_reach(const std::string& file, std::span<const Vec3f> positions, const Vec3& origin) {
  const double far = parallel_reduce(
      positions.size(), 1 << 16, 0.0,
      [&](std::size_t first, std::size_t last) {
        double most = 0;
        for (std::size_t i = first; i < last; ++i)
          for (std::size_t k = 0; k < 3; ++k)
            if (const double x = std::abs(origin[k] + static_cast<double>(positions[i][k])); std::isfinite(x))
              most = std::max(most, x);
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
  if (far > kLargestCoordinate)
    throw FileError(
        file, fmt::format("would have coordinates up to {:.3g}; at most {:g} is supported", far, kLargestCoordinate));
}

void write_beside(const FormatInfo& format, const std::string& file, const ReferenceSystem* system) {
  if (format.system_capacity == SystemCapacity::beside) io::write_system_beside(file, system);
}

template <class Triangles>
void check_triangles(const Triangles& triangles, std::size_t n) {
  for (const auto& t : triangles) {
    for (const std::uint32_t v : t) {
      if (v >= n) throw ArgumentError(fmt::format("a triangle refers to vertex {} of {}", v, n));
    }
  }
}

}  // namespace

void write_mesh(const std::string& file, const TriangleMesh& mesh, const WriteOptions& options) {
  const auto& writer = find_writer(kMesh, file, "meshes");
  check_length("normals", mesh.normals.size(), mesh.vertices.size());
  check_length("colors", mesh.colors.size(), mesh.vertices.size());
  mesh.attributes.check_rows(mesh.vertices.size(), "vertices");
  mesh.triangle_attributes.check_rows(mesh.triangles.size(), "triangles");
  check_triangles(mesh.triangles, mesh.vertices.size());
  check_reach(file, mesh.vertices, mesh.origin);
  if (must_state_unknown(writer, file, mesh.reference.get())) {
    TriangleMesh stated = mesh;
    stated.reference = std::make_shared<const ReferenceSystem>();
    return io::write_whole(file, writer.write_mesh(stated, options));
  }
  io::write_whole(file, writer.write_mesh(mesh, options));
  write_beside(writer, file, mesh.reference.get());
}

void write_points(const std::string& file, const PointSet& points, const WriteOptions& options) {
  const auto& writer = find_writer(kPoints, file, "points");
  check_length("normals", points.normals.size(), points.size());
  check_length("colors", points.colors.size(), points.size());
  points.attributes.check_rows(points.size(), "points");
  check_triangles(points.triangles, points.size());
  check_reach(file, points.positions, points.origin);
  if (must_state_unknown(writer, file, points.reference.get())) {
    PointSet stated = points;
    stated.reference = std::make_shared<const ReferenceSystem>();
    return io::write_whole(file, writer.write_points(stated, options));
  }
  io::write_whole(file, writer.write_points(points, options));
  write_beside(writer, file, points.reference.get());
}

bool is_written(const std::string& file, const std::string& kind) {
  const std::string ending = "." + io::ending(file);
  const auto known = [&](FormatContent content) {
    const std::vector<std::string> endings = endings_written(content);
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
  };
  return (kind == "mesh" && known(kMesh)) || (kind == "points" && known(kPoints)) || (kind == "lines" && known(kLines));
}

std::vector<std::string> left_out(const std::string& file, const TriangleMesh& mesh) {
  return lost_data(find_writer(kMesh, file, "meshes").mesh_capacity, io::OutputContent(mesh));
}

std::vector<std::string> left_out(const std::string& file, const PointSet& points) {
  return lost_data(find_writer(kPoints, file, "points").points_capacity, io::OutputContent(points));
}

void write_lines(const std::string& file, const PolylineSet& lines, const WriteOptions& options) {
  const auto& writer = find_writer(kLines, file, "lines");
  if (lines.offsets.empty() || lines.offsets.front() != 0 || lines.offsets.back() != lines.positions.size() ||
      !std::is_sorted(lines.offsets.begin(), lines.offsets.end()))
    throw ArgumentError("each line must begin at the end of the previous one");
  lines.attributes.check_rows(lines.positions.size(), "points");
  lines.line_attributes.check_rows(lines.size(), "lines");
  io::write_whole(file, writer.write_lines(lines, options));
  write_beside(writer, file, lines.reference.get());
}

void write_text(const std::string& file, const std::string& text) { io::write_whole(file, {text}); }

void check_writable(const std::string& file, const std::string& kind) {
  if (file.empty()) throw FileError("(no name)", "the name of the file to write is empty");
  if (kind == "mesh") {
    find_writer(kMesh, file, "meshes");
  } else if (kind == "points") {
    find_writer(kPoints, file, "points");
  } else if (kind == "lines") {
    find_writer(kLines, file, "lines");
  } else if (kind == "image") {
    if (io::ending(file) != "png") fail_ending(file, "images", ".png");
  } else if (kind != "text") {
    throw ArgumentError(fmt::format("check_writable: unknown kind '{}'; known: mesh points lines image text", kind));
  }
  io::find_output_destination(file);
}

}  // namespace sansmesh::inline v1
